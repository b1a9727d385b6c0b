"""A serial arm as symbols: standard (distal) Denavit-Hartenberg frames, gravity, joint variables.

Lengths that are zero are zero and right angles are exact, so that what a geometry makes vanish
vanishes while deriving; everything else is a symbol whose number stands in `Arm.values`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import sympy as sp


@dataclass(frozen=True)
class Link:
    """DH geometry of one link: a, d (m), cosine and sine of alpha, joint offset (rad)."""

    a: sp.Expr
    d: sp.Expr
    cos_alpha: sp.Expr
    sin_alpha: sp.Expr
    offset: sp.Expr

    @property
    def twist(self) -> sp.Matrix:
        """Rotation about x by alpha: the next joint's frame seen from the turned one."""
        c, s = self.cos_alpha, self.sin_alpha
        return sp.Matrix([[1, 0, 0], [0, c, -s], [0, s, c]])

    @property
    def translation(self) -> sp.Matrix:
        """Origin of the next joint's frame in the turned frame, m."""
        return sp.Matrix([self.a, 0, self.d])

    @property
    def is_parallel(self) -> bool:
        """Whether the next joint's axis has the direction of this one's."""
        return bool(self.cos_alpha == 1)


@dataclass(frozen=True)
class Arm:
    """Geometry of the moving joints, gravity in the base frame (m/s^2), numbers of all constants."""

    links: tuple[Link, ...]
    gravity: sp.Matrix
    values: Mapping[sp.Symbol, sp.Expr]

    @property
    def dof(self) -> int:
        """Number of joints."""
        return len(self.links)

    @property
    def q(self) -> tuple[sp.Symbol, ...]:
        """Joint positions q1.., rad."""
        return tuple(sp.Symbol(f"q{i + 1}") for i in range(self.dof))

    @property
    def qd(self) -> tuple[sp.Symbol, ...]:
        """Joint speeds qd1.., rad/s."""
        return tuple(sp.Symbol(f"qd{i + 1}") for i in range(self.dof))

    def parallel_groups(self) -> list[list[int]]:
        """Return runs of joints (0-based) whose axes are parallel, in order."""
        groups = [[0]]
        for i in range(1, self.dof):
            if self.links[i - 1].is_parallel:
                groups[-1].append(i)
            else:
                groups.append([i])
        return groups


def exact(number: float) -> sp.Expr:
    """Return the decimal number that was written, as a rational: arithmetic on it has no round-off."""
    return sp.Rational(repr(float(number)))


def _quarter_turns(angle: float) -> int | None:
    turns = angle / float(sp.pi / 2)
    return round(turns) if abs(turns - round(turns)) < 1e-12 else None


def exact_cos_sin(angle: float) -> tuple[sp.Expr, sp.Expr]:
    """Return cosine and sine of an angle in rad: exact for right angles, else rationals of 50 digits."""
    turns = _quarter_turns(angle)
    if turns is not None:
        return sp.Integer((1, 0, -1, 0)[turns % 4]), sp.Integer((0, 1, 0, -1)[turns % 4])
    pair = (sp.N(f(exact(angle)), 50) for f in (sp.cos, sp.sin))
    cosine, sine = (sp.Rational(str(x)) for x in pair)
    return cosine, sine


def symbolic_arm(dh: Sequence[tuple[float, float, float, float]], gravity: Sequence[float]) -> Arm:
    """Build an arm from DH rows (a m, d m, alpha rad, offset rad), base to tip, and gravity (m/s^2)."""
    values: dict[sp.Symbol, sp.Expr] = {}

    def constant(name: str, value: sp.Expr) -> sp.Expr:
        if value in (-1, 0, 1):
            return value
        symbol = sp.Symbol(name)
        values[symbol] = value
        return symbol

    links = []
    for i, (a, d, alpha, offset) in enumerate(dh, start=1):
        c, s = exact_cos_sin(alpha)
        links.append(
            Link(
                constant(f"a{i}", exact(a)),
                constant(f"d{i}", exact(d)),
                constant(f"ca{i}", c),
                constant(f"sa{i}", s),
                constant(f"o{i}", exact(offset)),
            )
        )
    return Arm(tuple(links), _gravity(gravity, values), values)


def _gravity(gravity: Sequence[float], values: dict[sp.Symbol, sp.Expr]) -> sp.Matrix:
    """Free fall along -z is called g; in any other direction its components are gx, gy, gz."""
    if gravity[0] == gravity[1] == 0 and gravity[2] < 0:
        values[sp.Symbol("g")] = exact(-gravity[2])
        return sp.Matrix([0, 0, -sp.Symbol("g")])
    components = []
    for name, value in zip(("gx", "gy", "gz"), gravity, strict=True):
        if value:
            values[sp.Symbol(name)] = exact(value)
        components.append(sp.Symbol(name) if value else sp.Integer(0))
    return sp.Matrix(components)
