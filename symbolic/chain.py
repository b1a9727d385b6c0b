"""Straight-line definitions in SymPy and their gradient.

A `Chain` is a list ``symbol = expression``, each expression small and written in the symbols above
it. Energies written so never expand, and their gradient (reverse accumulation; Griewank and Walther,
*Evaluating Derivatives*, ch. 3) costs about as much as the energies themselves.

One rule makes that gradient as short as a hand-written backward recursion: before a new symbol is
made, the chain looks whether an equal or opposite expression stands in it already. The derivative of
``c*x + s*y`` by its angle is ``c*y - s*x``, which a rotated vector has beside it.
"""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence

import sympy as sp


class Chain:
    """Definitions in order, with look-up by value; `define` and `rotation` are the ways in."""

    def __init__(self) -> None:
        self._definitions: dict[sp.Symbol, sp.Expr] = {}
        self._by_value: dict[sp.Expr, sp.Expr] = {}
        self._rotation: dict[sp.Expr, tuple[sp.Symbol, sp.Symbol]] = {}

    def __iter__(self) -> Iterator[tuple[sp.Symbol, sp.Expr]]:
        return iter(self._definitions.items())

    def __contains__(self, symbol: sp.Symbol) -> bool:
        return symbol in self._definitions

    def __getitem__(self, symbol: sp.Symbol) -> sp.Expr:
        return self._definitions[symbol]

    @property
    def rotations(self) -> Mapping[sp.Expr, tuple[sp.Symbol, sp.Symbol]]:
        """Angle (rad) -> symbols of its cosine and sine."""
        return self._rotation

    def copy(self) -> "Chain":
        """Return a chain with the same definitions that can grow on its own."""
        other = Chain()
        other._definitions = dict(self._definitions)
        other._by_value = dict(self._by_value)
        other._rotation = dict(self._rotation)
        return other

    def define(self, name: str, expression: sp.Expr) -> sp.Expr:
        """Return what stands for the expression.

        An atom or its negative is returned as it is; an expression that the chain holds already,
        perhaps with the other sign, as the symbol that it has there.
        """
        expression = sp.sympify(expression)
        if expression.is_Atom or (-expression).is_Atom:
            return expression
        found = self.find(expression)
        if found is not None:
            return found
        symbol = sp.Symbol(name)
        if symbol in self._definitions:
            raise ValueError(f"{name} is defined twice")
        self._definitions[symbol] = expression
        value = sp.expand(expression)
        self._by_value[value] = symbol
        self._by_value.setdefault(-value, -symbol)
        return symbol

    def find(self, expression: sp.Expr) -> sp.Expr | None:
        """Return the symbol (or its negative) that holds an equal expression, if there is one."""
        return self._by_value.get(sp.expand(expression))

    def rotation(self, suffix: str, angle: sp.Expr) -> tuple[sp.Symbol, sp.Symbol]:
        """Return the symbols of cosine and sine of an angle (rad)."""
        pair = self.define(f"c{suffix}", sp.cos(angle)), self.define(f"s{suffix}", sp.sin(angle))
        self._rotation[angle] = pair
        return pair

    def inline(self, expression: sp.Expr) -> sp.Expr:
        """Return the expression in the inputs alone, every definition put in (it may be large)."""
        values: dict[sp.Symbol, sp.Expr] = {}
        for symbol, definition in self:
            values[symbol] = definition.xreplace(values)
        return sp.sympify(expression).xreplace(values)

    def substitute(self, values: Mapping[sp.Symbol, sp.Expr]) -> tuple["Chain", dict[sp.Symbol, sp.Expr]]:
        """Return the chain with inputs or constants replaced, and what became of each symbol.

        Zeros and ones fold away on the way.
        """
        other, became = Chain(), dict(values)
        for symbol, definition in self:
            became[symbol] = other.define(symbol.name, definition.xreplace(became))
        other._rotation = {
            angle.xreplace(became): pair
            for angle, pair in self._rotation.items()
            if all(became[x] == x for x in pair)
        }
        return other, became


def gradient(
    chain: Chain, terms: Sequence[sp.Expr], variables: Sequence[sp.Symbol]
) -> tuple[Chain, list[sp.Expr]]:
    """Differentiate the sum of the terms by the variables, in reverse.

    terms: expressions in the chain's symbols, the variables and constants.
    Returns a longer chain and the derivatives, one a variable, in its symbols.
    """
    grown = chain.copy()
    parts: dict[sp.Symbol, list[sp.Expr]] = defaultdict(list)
    differentiable = set(variables) | {symbol for symbol, _ in chain}
    for term in terms:
        _pull_back(grown, term, sp.Integer(1), differentiable, parts)
    for symbol, definition in reversed(list(chain)):
        if symbol not in parts or definition.func in (sp.cos, sp.sin):
            continue
        bar = grown.define(f"{symbol.name}_bar", sp.Add(*parts.pop(symbol)))
        _pull_back(grown, definition, bar, differentiable, parts)
    return grown, [sp.Add(*parts.get(x, ())) for x in variables]


def _pull_back(
    chain: Chain,
    expression: sp.Expr,
    bar: sp.Expr,
    differentiable: set[sp.Symbol],
    parts: dict[sp.Symbol, list[sp.Expr]],
) -> None:
    """Add bar * d(expression)/d(symbol) to the parts of every symbol in the expression."""
    free = expression.free_symbols
    for angle, (c, s) in chain.rotations.items():
        if c in free or s in free:
            slope = expression.diff(s) * c - expression.diff(c) * s
            found = chain.find(slope)
            parts[angle].append(bar * (slope if found is None else found))
            free = free - {c, s}
    for symbol in sorted(free & differentiable, key=lambda x: x.name):
        part = bar * expression.diff(symbol)
        if part != 0:
            parts[symbol].append(part)
