"""Hypotheses: what may be missing, each as a few directions in the parameter space."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from ..symbolic.terms import CATALOGUE
from .columns import (
    BASELINE,
    DELAYS,
    GAPS,
    GENTLE,
    GRIDS,
    LATE,
    LATE_FRICTION,
    NO_PHYSICS,
    ORDERS,
    REPEAT,
    SLACK,
    SOFT,
    STIFFNESSES,
    TERMS,
    WIDTH,
    WINDUP,
    Column,
    Space,
)
from .flexible import names as curve_names
from .lacking import DROPPED, FROZEN
from .physics import Physics
from .selection import Directions

Array = NDArray[np.float64]
#: A hypothesis' effect and joint (0-based; None: all).
Key = tuple[str, int | None]


#: No more of the Coulomb level can change its sign late than there is, given how well it is known.
LATE_LEVEL = 1.5
#: Coefficients of what is there as a whole add up to one, or to this (damping and the arm's other joints take
#: some of a swing); one of two may be below zero by this share of both.
WHOLE, BEYOND = (0.6, 1.3), 0.2
#: Of the wide prior of base parameters: how much a body may change them, by little or by much. A width that
#: fits much would cost one that is a few percent off 30 nats. Without a reference little is what masses that
#: are all off do, and what friction's bends leave. A load may be many times what the wrist weighs.
BY_LITTLE, BY_MUCH, LOADED = 0.1, 3.0, 50.0


@dataclass(frozen=True)
class Candidate:
    """An effect on a joint (0-based; None: on all), as columns (D,) of the candidates' directions.

    values: nonlinear ones; positive: coefficients that physics wants above zero; whole: its columns are two
    neighbouring forms of one effect as it is, so that it is mixed of them. most: of the first coefficient.
    """

    effect: str
    joint: int | None
    columns: tuple[int, ...]
    values: tuple[tuple[str, float], ...] = ()
    terms: tuple[str, ...] = ()
    positive: bool = False
    whole: bool = False
    most: float = np.inf

    def conceivable(self, size: Array) -> bool:
        """Return whether coefficients (k,) are those of physics: of its sign and size, or of the whole."""
        if self.whole:
            total = float(size.sum())
            return WHOLE[0] < total < WHOLE[1] and bool(size.min() > -BEYOND * total)
        return bool(size[0] <= self.most) and not (self.positive and size[0] < 0)

    @property
    def key(self) -> Key:
        """What it is called, whatever its nonlinear value."""
        return self.effect, self.joint


def own_columns(gear: float) -> tuple[Column, ...]:
    """Return the terms' columns that every joint has; gear: motor turns a joint turn."""
    found = [Column("gain", "e")]
    for term in TERMS:
        entry = CATALOGUE[term]
        tried = GRIDS.get(term, ((),))
        width = (("width", WIDTH),) if "width" in entry.parameters else ()
        found += [Column(term, p, values + width) for values in tried for p in entry.linear_in]
    found += [Column("tanh", "Ft", (("vt", v),)) for v in GENTLE]
    found += [Column("coulomb", "Fc", (("width", w),)) for w in SOFT]
    found += [Column(SLACK, "gap", (("gap", x),)) for x in GAPS]
    found += [Column(WINDUP, "torque", (("stiffness", x),)) for x in STIFFNESSES]
    found += [Column(LATE, "d", (("around", x),)) for x in DELAYS]
    found.append(Column(LATE_FRICTION, "d", (("around", DELAYS[-1]),)))
    found += [Column("ripple", p, (("n", k * gear),)) for k in ORDERS for p in ("A", "B")]
    found.append(Column(REPEAT, "rho"))
    return tuple(found)


def curve_columns() -> tuple[Column, ...]:
    """Return the flexible curve's columns."""
    return tuple(Column("curve", name, (("piece", float(k)),)) for name, k in curve_names())


#: effect -> term; each value of the term's grid is a hypothesis of its own.
_PLAIN = {
    "coulomb": "coulomb_friction", "viscous": "viscous_friction", "spring": "cable_spring",
    "quadratic": "nonlinear_viscous", "cubic": "nonlinear_viscous", "power": "nonlinear_viscous",
    "tanh": "nonlinear_viscous", "stribeck": "stribeck", "load_dependent": "load_dependent_friction",
    "temperature_dependent": "temperature_dependent_friction",
    "position_dependent": "position_dependent_friction",
    "presliding": "presliding_hysteresis", "lag": "velocity_lag", "ripple": "torque_ripple",
    "gain": "drive_gain", "asymmetric": "friction_asymmetry", "offset": "current_offset",
    LATE: "time_delay",
}  # fmt: skip
#: What a term cannot be told without: where a spring rests, friction where its temperature changes nothing.
_BESIDE = {"spring": ("offset",), "temperature_dependent": ("coulomb", "viscous")}
#: Whose coefficient cannot be negative when nothing was known of it before.
_POSITIVE = ("presliding", "lag", "load_dependent", "stribeck", "spring", LATE)


#: A joint's columns by term and nonlinear values.
Groups = dict[tuple[str, tuple[tuple[str, float], ...]], list[int]]


@dataclass(frozen=True)
class Candidates:
    """All hypotheses and the directions that their columns number; by joint the curve and late friction.

    unshown: those that the recordings cannot tell from others, so that they are in a class at best.
    """

    directions: Directions
    each: tuple[Candidate, ...]
    unshown: tuple[Candidate, ...]
    curve: tuple[tuple[int, ...], ...]
    late_friction: tuple[tuple[int, ...], ...]


def candidates(
    space: Space, physics: Physics, own_std: Array, common_std: dict[str, float], base_std: Array,
    load: Array, swings: Array, levels: Array, changed: bool,
) -> Candidates:  # fmt: skip
    """Return every hypothesis of the catalogue that is a column or an inertial direction.

    own_std (N, K): prior width of each own column; base_std (B,): of a base parameter. load (N, 2): range of
    what each gear carries, Nm; a load that does not reverse shows no slack. swings (N,): Nm/rad up to which a
    gear's swing is slow enough to be seen; stiffer ones just lag. levels (N,): Coulomb friction, Nm.
    changed: sought is what changed since a reference: friction that came to depend on temperature is the old
    one at a temperature unknown.
    """
    vectors, std = list[Array](), list[float]()
    each, unshown = list[Candidate](), list[Candidate]()

    def add(vector: Array, width: float) -> int:
        vectors.append(vector)
        std.append(width)
        return len(vectors) - 1

    unit = np.eye(space.size)
    fitted = set() if changed else set(BASELINE)  # what is free anyway
    short = [k for k, c in enumerate(space.own) if c.short]
    for j in range(space.dof):
        groups: Groups = {}
        for k, c in enumerate(space.own):
            if c.term not in NO_PHYSICS and not c.soft and not c.short:
                # a changed level builds up over the same short travel
                parts = [k, *short] if c.term == "coulomb" else [k]
                at = add(unit[[space.own_index(j, i) for i in parts]].sum(axis=0), own_std[j, k])
                groups.setdefault((c.term, c.values), []).append(at)
        gaps = _neighbours(groups, SLACK, ("gap", "wider"), GAPS)
        if load[j, 0] < 0 < load[j, 1]:
            each += [Candidate("backlash", j, both, ends) for both, ends in gaps]
        soft = _neighbours(groups, WINDUP, ("stiffness", "stiffer"), STIFFNESSES)
        each += [
            Candidate("joint_elasticity", j, both, ends, whole=True)
            for both, ends in soft
            if ends[1][1] <= swings[j]
        ]
        for (term, values), columns in groups.items():
            with_it = set(_BESIDE.get(term, ())) - fitted
            beside = [x for (t, _), some in groups.items() if t in with_it for x in some]
            most = LATE_LEVEL * levels[j] if term == "lag" else np.inf
            positive = term in _POSITIVE
            each.append(Candidate(_PLAIN[term], j, (*columns, *beside), values, (term,), positive, most=most))
    _of_all_joints(space, common_std, add, each)
    for j, (least, most) in enumerate(load.tolist()):
        if not least < 0 < most:  # the gear stays on one flank, and its link is behind by the gap
            turned = unit[space.common_index(f"encoder{j + 1}")] * (-1.0 if least > 0 else 1.0)
            at = add(turned, common_std["encoder"])
            unshown.append(Candidate("backlash", j, (at,), positive=True, most=GAPS[-1]))
    _inertial(space, physics, base_std, add, each, (BY_LITTLE, BY_MUCH) if changed else (BY_MUCH,))

    def described(term: str) -> tuple[tuple[int, ...], ...]:
        mine = [k for k, c in enumerate(space.own) if c.term == term]
        return tuple(
            tuple(add(unit[space.own_index(j, k)], own_std[j, k]) for k in mine) for j in range(space.dof)
        )

    curve, late_friction = described("curve"), described(LATE_FRICTION)
    directions = Directions(
        sparse.csc_matrix(np.stack(vectors, axis=1)), np.array(std), np.zeros(len(std), bool)
    )
    return Candidates(directions, tuple(each), tuple(unshown), curve, late_friction)


def _neighbours(
    groups: Groups, term: str, names: tuple[str, str], values: Sequence[float]
) -> list[tuple[tuple[int, ...], tuple[tuple[str, float], ...]]]:
    """Take a term out of the groups; return each two neighbours' columns, and their values by name."""
    columns = [groups.pop((term, ((names[0], x),)), []) for x in values]
    ends = [tuple(zip(names, both, strict=True)) for both in pairwise(values)]
    return [((*a, *b), named) for (a, b), named in zip(pairwise(columns), ends, strict=True)]


def _of_all_joints(
    space: Space, common_std: dict[str, float], add: Callable[[Array, float], int], each: list[Candidate]
) -> None:
    """Directions of what acts on all joints and is no body: encoders, soft gears, base, clock, couplings."""
    unit = np.eye(space.size)
    for kind, effect in (("encoder", "encoder_offset"), ("elasticity", "joint_elasticity")):
        for j in range(space.dof):
            at = add(unit[space.common_index(f"{kind}{j + 1}")], common_std[kind])
            each.append(Candidate(effect, j, (at,), positive=kind != "encoder"))
    tilt = [add(unit[space.common_index(x)], common_std["tilt"]) for x in ("roll", "pitch")]
    each.append(Candidate("base_tilt", None, tuple(tilt)))
    for k, delay in enumerate(DELAYS):
        steady, late, swift = (
            add(unit[space.common_index(f"{x}{k + 1}")], common_std["delay"])
            for x in ("delay", "reversal", "jerk")
        )
        for jerk, torque in ((0.0, steady), (1.0, swift)):
            values = ("around", delay), ("jerk", jerk)
            each.append(Candidate("time_delay", None, (torque, late), values))
    for name, effect in ((FROZEN, "frozen_joint_coupling"), (DROPPED, "dropped_coupling")):
        if name in space.common:
            at = add(unit[space.common_index(name)], common_std["lacking"])
            each.append(Candidate(effect, None, (at,), positive=True))


def _inertial(
    space: Space, physics: Physics, base_std: Array, add: Callable[[Array, float], int],
    each: list[Candidate], widths: Sequence[float],
) -> None:  # fmt: skip
    """Directions of a link's ten parameters, of a payload (the last link's) and of each rotor.

    widths: of the priors of a link's and a payload's, each a hypothesis of its own; a payload has one more.
    """

    def lifted(direction: Array) -> Array:
        vector = np.zeros(space.size)
        vector[: len(space.base)] = direction
        return vector

    n = space.dof
    for link in range(n):
        own = physics.map.links[:, 10 * link : 10 * link + 10]
        basis, sizes, _ = np.linalg.svd(own / base_std[:, None], full_matrices=False)
        # combinations in units of the priors of the base parameters that they change
        some = [lifted(base_std * x) for x in basis.T[sizes > 1e-6 * max(sizes[0], 1e-12)]]
        effect, more = ("payload", (LOADED,)) if link == n - 1 else ("link_inertial", ())
        for width in (*widths, *more) if some else ():
            columns = tuple(add(x, width) for x in some)
            each.append(Candidate(effect, None if effect == "payload" else link, columns))
    for j in range(n):
        each.append(Candidate("rotor_inertia", j, (add(lifted(physics.map.rotors[:, j]), 5.0),)))
    every = [add(lifted(np.eye(len(space.base))[:, i] * base_std[i]), 1.0) for i in range(len(space.base))]
    each.append(Candidate("base_free", None, tuple(every)))


def of_key(all_of: Sequence[Candidate], key: Key) -> list[Candidate]:
    """Return the hypotheses of one name on one joint."""
    return [c for c in all_of if c.key == key]
