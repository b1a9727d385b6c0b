"""Forms of a term's expressions that what runs them needs."""

import sympy as sp

from .term import DT, LOAD, QD, STARTED, TEMPERATURE, Term, smooth_sign


def without_extremes(expression: sp.Expr) -> sp.Expr:
    """Write maxima and minima of two by a size, which every language has: (a + b +- |a - b|) / 2."""

    def larger(a: sp.Expr, b: sp.Expr) -> sp.Expr:
        return (a + b + sp.Abs(a - b)) / 2

    def smaller(a: sp.Expr, b: sp.Expr) -> sp.Expr:
        return (a + b - sp.Abs(a - b)) / 2

    return expression.replace(sp.Max, larger).replace(sp.Min, smaller)


def line(term: Term, state: str) -> tuple[sp.Expr, sp.Expr] | None:
    """Return (a, b) where a state's update is a * state + b with neither depending on it, else None."""
    symbol, update = sp.Symbol(state), term.state[state]
    if bounds(term, state):
        return None
    slope = without_extremes(update).diff(symbol)
    return None if slope.has(symbol) else (slope, update.subs(symbol, 0))


def bounds(term: Term, state: str) -> tuple[sp.Expr, sp.Expr] | None:
    """Return (lowest, highest) where a state keeps its value between them, else None."""
    symbol, update = sp.Symbol(state), term.state[state]
    if not isinstance(update, sp.Max) or len(update.args) != 2:
        return None
    inner = [x for x in update.args if isinstance(x, sp.Min) and symbol in x.args and len(x.args) == 2]
    outer = [x for x in update.args if not x.has(symbol)]
    if not inner or not outer:
        return None
    (highest,) = (x for x in inner[0].args if x != symbol)
    return outer[0], highest


_LATEX = {
    QD: r"\dot q",
    LOAD: r"\tau_\mathrm{load}",
    TEMPERATURE: r"\vartheta",
    DT: r"\Delta t",
}


def equation(term: Term) -> str:
    """Return a term as LaTeX: its torque and, with an arrow, what becomes of each state in a sample.

    The smooth sign is written sgn; states are those of a sample that is not the first, and each is written
    in the ones before it as they are after the sample, with a plus.
    """
    texts, after = [_printed(term.expression)], dict[sp.Expr, sp.Symbol]()
    for name, update in term.state.items():
        texts.append(rf"{_split(name)} \leftarrow {_printed(update.subs(after))}")
        after[update] = sp.Symbol(f"{_split(name)}^+")
    return r",\ ".join(texts)


def _printed(expression: sp.Expr) -> str:
    names = {x: text for x, text in _LATEX.items() if expression.has(x)}
    for speed in expression.free_symbols:
        sign = sp.Symbol(f"sgn_{speed.name}")
        expression = expression.subs(smooth_sign(speed, sp.Symbol("width")), sign)
        names[sign] = rf"\operatorname{{sgn}}({names.get(speed, speed.name)})"
    names |= {x: _split(x.name) for x in expression.free_symbols if x not in names}
    return str(sp.latex(expression.subs(STARTED, 1), symbol_names=names))


def _split(name: str) -> str:
    """Write Fc as F_c, tau0 as tau_0, band as a word."""
    if name.endswith("^+"):
        return name
    if name.startswith(("tau", "mu")):
        return f"\\{name}".replace("0", "_{0}")
    if len(name) > 2:
        return rf"\mathrm{{{name}}}"
    return name if len(name) == 1 else f"{name[0]}_{{{name[1]}}}"
