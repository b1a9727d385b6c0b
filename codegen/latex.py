"""Equations for people: what model.md shows."""

import re
from collections.abc import Mapping
from dataclasses import dataclass

import sympy as sp

from ..symbolic.equations import Dynamics, gravity_vector, mass_matrix
from ..symbolic.terms import STARTED

#: Beyond this many joints expanded equations stop being readable.
READABLE_JOINTS = 3


@dataclass(frozen=True)
class Equations:
    """LaTeX texts: expanded (mass, gravity, momentum, beta, potential) or the recursion (steps)."""

    potential: str = ""
    mass: tuple[tuple[int, int, str], ...] = ()
    gravity: tuple[tuple[int, str], ...] = ()
    momentum: tuple[tuple[int, str], ...] = ()
    beta: tuple[tuple[int, str], ...] = ()
    steps: tuple[tuple[str, str], ...] = ()


def equations(model: Dynamics) -> Equations:
    """Return the equations of a model, expanded where that can be read."""
    if len(model.q) > READABLE_JOINTS:
        return Equations(steps=_steps(model))
    mass, gravity = mass_matrix(model), gravity_vector(model)
    n = len(model.q)

    def write(expression: sp.Expr) -> str:
        return latex(_compact(model.chain.inline(expression), model))

    return Equations(
        potential=write(model.potential),
        mass=tuple((i + 1, j + 1, write(mass[i, j])) for i in range(n) for j in range(i, n)),
        gravity=tuple((i + 1, write(g)) for i, g in enumerate(gravity)),
        momentum=tuple((i + 1, write(p)) for i, p in enumerate(model.momentum)),
        beta=tuple((i + 1, write(b)) for i, b in enumerate(model.beta)),
    )


def _steps(model: Dynamics) -> tuple[tuple[str, str], ...]:
    steps = [(latex(symbol), latex(definition)) for symbol, definition in model.chain]
    steps += [(f"p_{{{i}}}", latex(p)) for i, p in enumerate(model.momentum, start=1)]
    steps += [(rf"\beta_{{{i}}}", latex(b)) for i, b in enumerate(model.beta, start=1)]
    return tuple(steps)


def _compact(expression: sp.Expr, model: Dynamics) -> sp.Expr:
    """Write cos(q2 + q3) as c23, and collect what multiplies each pair of speeds."""
    short = {}
    for function in expression.atoms(sp.cos, sp.sin):
        angles = sorted(function.args[0].free_symbols, key=lambda x: x.name)
        if function.args[0] == sp.Add(*angles) and set(angles) <= set(model.q):
            letter = "c" if function.func is sp.cos else "s"
            short[function] = sp.Symbol(letter + "".join(x.name[1:] for x in angles))
    compact = expression.xreplace(short)
    if sp.fraction(sp.together(compact))[1].free_symbols:
        return sp.factor_terms(compact)
    return sp.collect(
        sp.expand(compact), [a * b for i, a in enumerate(model.qd) for b in model.qd[i:]] + list(model.qd)
    )


_NAMES = (
    (re.compile(r"^qd(\d+)$"), r"\\dot q_{\1}"),
    (re.compile(r"^qdd(\d+)$"), r"\\ddot q_{\1}"),
    (re.compile(r"^th(\d+)$"), r"\\theta_{\1}"),
    (re.compile(r"^rho$"), r"\\rho"),
    (re.compile(r"^load(\d+)$"), r"\\tau_{\\mathrm{load},\1}"),
    (re.compile(r"^temperature(\d+)$"), r"\\vartheta_{\1}"),
    (re.compile(r"^dt$"), r"\\Delta t"),
    (re.compile(r"^tau0$"), r"\\tau_0"),
    (re.compile(r"^[a-z_]+\d+_(?:\d+_)?([A-Za-z]+)(\d*)$"), r"\\mathrm{\1}_{\2}"),
    (re.compile(r"^([a-zA-Z]+?)([xyz]?)(\d+)_bar$"), r"\\bar{\1}_{\2\3}"),
    (re.compile(r"^([A-Z]{2})(\d+)$"), r"\\mathit{\1}_{\2}"),
    (re.compile(r"^([wvgrSP]b?t?)([xyz])(\d+)$"), r"\1_{\2,\3}"),
    (re.compile(r"^([a-zA-Z]+?)(\d+)$"), r"\1_{\2}"),
)


def symbol_latex(name: str) -> str:
    """Return the LaTeX of a symbol by its name: qd2, th23, XX2, wbx23, q3_bar, coulomb2_Fc."""
    for pattern, replacement in _NAMES:
        if pattern.match(name):
            return pattern.sub(replacement, name).replace("_{}", "")
    return name


def latex(expression: sp.Expr) -> str:
    """Return the LaTeX of an expression with the project's symbols."""
    expression = sp.sympify(expression)
    names: Mapping[sp.Symbol, str] = {x: symbol_latex(x.name) for x in expression.free_symbols}
    return str(sp.latex(expression, symbol_names=dict(names)))


def term_latex(expression: sp.Expr) -> str:
    """Return a term on a joint with the smooth sign written as sgn."""
    names = {}
    width = [x for x in expression.free_symbols if x.name.endswith("_width")]
    for speed in expression.free_symbols if width else ():
        sign = sp.Symbol(f"SGN_{speed.name}")
        expression = expression.subs(speed / (sp.Abs(speed) + width[0]), sign)
        names[sign] = rf"\operatorname{{sgn}}({symbol_latex(speed.name)})"
    names |= {x: symbol_latex(x.name) for x in expression.free_symbols if x not in names}
    return str(sp.latex(expression, symbol_names=names))


def update_latex(updates: Mapping[sp.Symbol, sp.Expr]) -> list[str]:
    """Return what becomes of each state in a sample that is not the first, with an arrow.

    A state before it in the list is written with a plus: as it is after the sample.
    """
    texts, after = list[str](), dict[sp.Expr, sp.Symbol]()
    for state, update in updates.items():
        settled = update.subs(after).subs(STARTED, 1)
        texts.append(rf"{symbol_latex(state.name)} \leftarrow {term_latex(settled)}")
        after[update] = sp.Symbol(f"{symbol_latex(state.name)}^+")
    return texts
