"""The columns among which missing physics is sought: which terms, at which nonlinear values, on which joint.

Every joint has the same list of own columns (terms of the catalogue, then a flexible curve that is no
physics); some columns act on all joints at once (a turned base, an encoder's offset, a soft gear).
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..codegen.regressors import Regressor

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
#: Nonlinear values of a term by name.
Setting = tuple[tuple[str, float], ...]


@dataclass(frozen=True)
class Column:
    """One column of a joint (or of all): a term's linear parameter at nonlinear values, or a curve's part."""

    term: str
    parameter: str
    values: tuple[tuple[str, float], ...] = ()

    @property
    def value(self) -> Mapping[str, float]:
        """The nonlinear values by name."""
        return dict(self.values)

    @property
    def soft(self) -> bool:
        """Whether its sign turns gently: how a gear's friction passes through zero speed is no finding."""
        return self.value.get("width") in SOFT or self.value.get("vt") in GENTLE

    @property
    def short(self) -> bool:
        """Whether it is what every gear's friction lacks just after a reversal, and no finding."""
        return self.value.get("zs", SHORT) < SHORT

    @property
    def builds_up(self) -> bool:
        """Whether it is part of the level that friction has while it slides, and so builds up over a travel.

        A narrow fall is not: it also stands for gears that start gently by their speed.
        """
        narrow = self.term == "stribeck" and self.value["vs"] <= NARROW
        return self.term in RAISED and self.parameter != "kv" and not narrow

    @property
    def usual(self) -> bool:
        """Whether it is of the friction that every baseline has: Coulomb with a sharp sign, and viscous."""
        return self.term in BASELINE and not self.soft


def _along(name: str, *values: float) -> tuple[Setting, ...]:
    return tuple(((name, v),) for v in values)


#: Nonlinear values that are tried: half a decade apart or less, over the catalogue's plausible range.
#: A fall by the first power of speed (delta 1) reaches thrice as far as a bell: over 0.3 rad/s it is drag.
GRIDS: Mapping[str, tuple[Setting, ...]] = {
    "stribeck": (
        *((("vs", v), ("delta", 2.0)) for v in (0.02, 0.04, 0.08, 0.16, 0.3)),
        *((("vs", v), ("delta", 1.0)) for v in (0.02, 0.04, 0.08, 0.16)),
    ),
    "power": _along("n", 0.5),
    "tanh": _along("vt", 0.3, 1.0),
    "presliding": _along("zs", 0.0003, 0.001, 0.003, 0.006, 0.012, 0.03),
    "lag": _along("lag", 0.005, 0.01, 0.018, 0.027, 0.04),
    "position_dependent": _along("n", 1.0, 2.0, 3.0),
}
#: The column of slack, which is no term of a joint alone; half its width (rad), neighbours mix.
SLACK = "slack"
GAPS = (0.00025, 0.0005, 0.001, 0.002, 0.004, 0.008, 0.016)
#: The column of a soft gear's own motion, no term either; its stiffness (Nm/rad), neighbours mix.
WINDUP = "windup"
STIFFNESSES = tuple(float(f"{x:.3g}") for x in np.geomspace(3e3, 4e4, 12))
#: The column of a current that comes late on its joint alone, no term either; s, near which its coefficient
#: is the delay.
LATE = "late"
DELAYS = (0.005, 0.015)
#: The column of friction alone that comes late, no term either: a late current brings all of the torque late.
LATE_FRICTION = "late friction"
#: The column of what the reference's model left where the reference did the same; no term either.
REPEAT = "repeat"
#: Columns that only a finding frees: what every model holds anyway does not include them.
BY_NAME = (WINDUP, LATE, LATE_FRICTION)
#: Columns that describe and are no physics, or tell names apart.
NO_PHYSICS = ("curve", REPEAT, LATE_FRICTION)

#: Terms with one entry for each value of their grid; order is that of the columns.
TERMS = (
    "coulomb", "viscous", "offset", "asymmetric", "spring", "quadratic", "cubic", "power", "tanh", "stribeck",
    "load_dependent", "temperature_dependent", "position_dependent", "presliding", "lag",
)  # fmt: skip

#: rad/s; every gear differs by much from Coulomb's law where it is slower than this.
NARROW = 0.02
#: Terms that raise the level that friction has while it slides.
RAISED = ("stribeck", "load_dependent", "temperature_dependent", "position_dependent")
#: Terms that are fitted whatever is found.
BASELINE = ("coulomb", "viscous")
#: rad/s; width of the smooth sign: far below the terms' default, whose tail reaches far into slow motion.
WIDTH = 1e-4
#: rad/s; widths at which Coulomb friction may change its sign instead, real or simulated: as the smooth sign
#: does, v / (|v| + width), and as a hyperbolic tangent, which ends sooner.
SOFT, GENTLE = (0.002, 0.01, 0.03), (0.005, 0.01, 0.02, 0.04)
#: rad; presliding shorter than this is every gear's, and no finding.
SHORT = 0.0008
#: Ripple: orders per motor turn.
ORDERS = (1.0, 2.0, 4.0)


@dataclass(frozen=True)
class Space:
    """Where each parameter stands in the long vector: base, then each joint's own, then common ones.

    dof: N; base: names of B base parameters; own: K columns that every joint has; common: S names of columns
    that act on all joints. seen[j]: which of the B parameters joint j's rows hold.
    """

    dof: int
    base: tuple[str, ...]
    own: tuple[Column, ...]
    common: tuple[str, ...]
    seen: tuple[tuple[int, ...], ...]

    @property
    def size(self) -> int:
        """B + N K + S."""
        return len(self.base) + self.dof * len(self.own) + len(self.common)

    def own_index(self, joint: int, k: int) -> int:
        """Return where own column k of a joint (0-based) stands."""
        return len(self.base) + joint * len(self.own) + k

    def common_index(self, name: str) -> int:
        """Return where a common column stands."""
        return len(self.base) + self.dof * len(self.own) + self.common.index(name)

    @cached_property
    def indices(self) -> tuple[Indices, ...]:
        """Each joint's places in the long vector, in the order of its row matrix."""
        k, start = len(self.own), len(self.base) + self.dof * len(self.own)
        shared = np.arange(start, start + len(self.common))
        return tuple(
            np.concatenate(
                [
                    np.array(self.seen[j], np.int64),
                    len(self.base) + j * k + np.arange(k),
                    shared,
                ]
            )
            for j in range(self.dof)
        )


def space_of(regressor: Regressor, own: tuple[Column, ...], common: tuple[str, ...]) -> Space:
    """Return the space of a regressor's base parameters with these columns."""
    seen = tuple(
        tuple(sorted({c for part in ("momentum", "beta") for r, c in regressor.parts[part].places if r == j}))
        for j in range(regressor.dof)
    )
    return Space(regressor.dof, regressor.base, own, common, seen)
