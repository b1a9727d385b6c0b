"""Base inertial parameters, derived from the energies (no table of regrouping rules).

Two facts are enough for a chain of revolute joints. A part of a link's inertia whose energy its own
joint can neither see in its angle nor in its speed belongs to the link before (Gautier and Khalil
1990; here that part is *solved for*). And parameters whose energies are proportional count once.
"""

from collections.abc import Collection, Mapping, Sequence
from functools import cache

import sympy as sp

from .arm import Arm
from .energy import Energies, Motion, energies, kinetic_energy, potential_energy
from .inertia import PARAMETER_NAMES, Inertia

#: Eliminated first when a combination has to go; the rest keep their usual names.
_ELIMINATION_ORDER = ("M", "MZ", "YY", "ZZ", "XX", "MX", "MY", "XY", "XZ", "YZ")


@cache
def inherited_part() -> tuple[tuple[sp.Expr, ...], ...]:
    """Return a basis (k vectors of 10) of the inertia that a revolute joint about z passes on.

    Solves dL/dq = dL/dqd = 0 for all motions of the frame before the joint, with the body's
    Lagrangian as energy.py writes it.
    """
    parameters = sp.symbols(" ".join(PARAMETER_NAMES))
    body = Inertia.from_parameters(parameters)
    c, s, rate = sp.symbols("c s rate")
    before = [sp.Matrix(sp.symbols(f"{x}x {x}y {x}z")) for x in "wvgr"]
    spin, velocity, gravity, position = before
    motion = Motion(spin + sp.Matrix([0, 0, rate]), velocity, gravity, position)
    turn = sp.Matrix([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    moment = turn * body.first_moment
    lagrangian = kinetic_energy(body, moment, turn.T * motion.spin, motion) - potential_energy(
        body, moment, motion
    )
    by_angle = lagrangian.diff(s) * c - lagrangian.diff(c) * s
    unknowns = [c, s, rate, *(x for vector in before for x in vector)]
    equations = []
    for slope in (by_angle, lagrangian.diff(rate)):
        polynomial = sp.Poly(sp.rem(sp.expand(slope), s**2 + c**2 - 1, s), *unknowns)
        equations += polynomial.coeffs()
    system = sp.linear_eq_to_matrix(equations, parameters)[0]
    order = [PARAMETER_NAMES.index(x) for x in reversed(_ELIMINATION_ORDER)]
    basis = system[:, order].nullspace()
    return tuple(tuple(v[order.index(i)] for i in range(10)) for v in basis)


def lump(arm: Arm, bodies: Sequence[Inertia]) -> list[Inertia]:
    """Pass on, from tip to base, what each joint cannot see; N bodies in, N leaner bodies out."""
    lumped = list(bodies)
    for i in reversed(range(arm.dof)):
        parameters = sp.Matrix(lumped[i].parameters)
        passed = sp.zeros(10, 1)
        for vector in inherited_part():
            pivot = next(
                PARAMETER_NAMES.index(x) for x in _ELIMINATION_ORDER if vector[PARAMETER_NAMES.index(x)]
            )
            passed += sp.Matrix(vector) * (parameters[pivot] / vector[pivot])
        lumped[i] = Inertia.from_parameters(parameters - passed)
        if i:
            link = arm.links[i - 1]
            lumped[i - 1] += Inertia.from_parameters(passed).moved(link.twist, link.translation)
    return lumped


def link_symbols(arm: Arm) -> list[Inertia]:
    """Return the links' own parameters as symbols (m2, mx2, .., jxx2, ..), in their turned frames."""
    names = ("m", "mx", "my", "mz", "jxx", "jyy", "jzz", "jxy", "jxz", "jyz")
    return [Inertia.from_parameters([sp.Symbol(f"{name}{i + 1}") for name in names]) for i in range(arm.dof)]


def rotor_symbols(arm: Arm) -> list[sp.Symbol]:
    """Return the reflected rotor inertias as symbols (ia1, ..), kg m^2."""
    return [sp.Symbol(f"ia{i + 1}") for i in range(arm.dof)]


def base_parameters(arm: Arm) -> dict[sp.Symbol, sp.Expr]:
    """Return each base parameter with its meaning in the symbols of links and rotors.

    Names are Khalil and Dombre's with the joint's number: XX2, MX3, ..; IA4 is a rotor that no link
    parameter can stand for. See also: `Inertia`, `PARAMETER_UNITS`.
    """
    meaning: dict[sp.Symbol, sp.Expr] = {}
    for i, body in enumerate(lump(arm, link_symbols(arm)), start=1):
        meaning |= {
            sp.Symbol(f"{n}{i}"): p for n, p in zip(PARAMETER_NAMES, body.parameters, strict=True) if p != 0
        }
    meaning |= {sp.Symbol(f"IA{i}"): r for i, r in enumerate(rotor_symbols(arm), start=1)}
    model = base_energies(arm, meaning)
    seen = _reachable(model)
    by_energy: dict[sp.Expr, sp.Symbol] = {}
    kept: dict[sp.Symbol, sp.Expr] = {}
    total = sp.Add(*model.lagrangian)
    for symbol, value in meaning.items():
        if symbol not in seen:
            continue
        slope = sp.expand(total.diff(symbol))
        if slope in by_energy:
            kept[by_energy[slope]] += value
            continue
        kept[symbol] = value
        if slope != 0:
            by_energy[slope] = symbol
    return kept


def base_energies(arm: Arm, symbols: Collection[sp.Symbol]) -> Energies:
    """Write the arm's energies with these base parameters; every other one is zero."""

    def parameter(name: str) -> sp.Expr:
        symbol = sp.Symbol(name)
        return symbol if symbol in symbols else sp.Integer(0)

    numbers = range(1, arm.dof + 1)
    bodies = [Inertia.from_parameters([parameter(f"{n}{i}") for n in PARAMETER_NAMES]) for i in numbers]
    return energies(arm, bodies, [parameter(f"IA{i}") for i in numbers])


def evaluate(
    meaning: Mapping[sp.Symbol, sp.Expr], arm: Arm, bodies: Sequence[Inertia], rotors: Sequence[sp.Expr]
) -> dict[sp.Symbol, sp.Expr]:
    """Return the base parameters' numbers from the links' own (turned frames) and the rotors'."""
    values = dict(arm.values) | dict(zip(rotor_symbols(arm), rotors, strict=True))
    for symbols, body in zip(link_symbols(arm), bodies, strict=True):
        values |= dict(zip(symbols.parameters, body.parameters, strict=True))
    return {symbol: sp.sympify(value).xreplace(values) for symbol, value in meaning.items()}


def _reachable(model: Energies) -> set[sp.Symbol]:
    """Symbols on which the energies depend, through all definitions."""
    seen: set[sp.Symbol] = set()
    waiting = [x for term in model.lagrangian for x in term.free_symbols]
    while waiting:
        symbol = waiting.pop()
        if symbol not in seen:
            seen.add(symbol)
            if symbol in model.chain:
                waiting += model.chain[symbol].free_symbols
    return seen
