"""The motion that would tell what the recordings at hand cannot, chosen by how far the rivals part on it.

Every experiment of the library is rehearsed: its trajectory gives the columns that it would have. What the
recordings know already is kept, so that a motion counts for what it adds. If one rival is true at the size
at which it was found, the other still explains part of it, together with everything that is fitted anyway;
the weighted square of what remains, halved, is the expected log likelihood ratio in nats.
"""

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits  # type: ignore[import-untyped]

from ..symbolic.effects import EFFECTS
from .candidates import Candidate, Key, of_key
from .evidence import Evidence
from .experiment_script import script_of
from .experiments import Experiment, library
from .naming import APART
from .rehearsal import Lean, information, lean, minutes_of
from .result import NextMotion
from .room import Room, room_of
from .selection import Directions, Eliminated, eliminate

Array = NDArray[np.float64]

#: Joints that are exercised at most.
_JOINTS = 2


@dataclass(frozen=True, eq=False)
class Promise:
    """What an experiment promises: nats a minute by pair of names, over its minutes."""

    experiment: Experiment
    minutes: float
    pairs: dict[tuple[Key, Key], float]

    @property
    def rate(self) -> float:
        """Nats a minute of the pair that it parts least."""
        return min(self.pairs.values())

    @property
    def total(self) -> float:
        """Nats of the pair that it parts least, over all its minutes."""
        return self.rate * self.minutes


@dataclass(frozen=True)
class _Rivals:
    """A name's columns among the rivals' directions: at its best value, and at every value there is."""

    key: Key
    columns: tuple[int, ...]
    family: tuple[tuple[int, ...], ...]


class Judgement:
    """How far names part: on the recordings, and with an experiment added."""

    def __init__(self, evidence: Evidence, model: Directions, candidates: Sequence[Candidate]) -> None:
        """Eliminate the model from the rivals' columns on the recordings; the sizes found are from there."""
        self.model = model
        self.directions, self.rivals = _of_rivals(evidence, candidates)
        self._sums = evidence.sums
        self._known = eliminate(self._sums, model, self.directions, None)
        self._sizes = {r.key: _size(self._known, r.columns) for r in self.rivals}
        self._before = self.parted(self._known)

    def added(self, gram: Array) -> dict[tuple[Key, Key], float]:
        """Return the nats by which each pair parts further once rows of this Gram matrix are there."""
        more = copy(self._sums)
        more.total = self._sums.total + gram
        after = self.parted(eliminate(more, self.model, self.directions, None))
        return {pair: max(after[pair] - self._before[pair], 0.0) for pair in after}

    def parted(self, known: Eliminated) -> dict[tuple[Key, Key], float]:
        """Return nats by pair of names: the mean of both cases, that one is true and that the other is."""
        return {
            (a.key, b.key): 0.5 * (self._remains(known, a, b) + self._remains(known, b, a))
            for a, b in combinations(self.rivals, 2)
        }

    def _remains(self, known: Eliminated, true: _Rivals, other: _Rivals) -> float:
        """Return half the weighted square of a true effect that the other name at no value explains."""
        size, at = self._sizes[true.key], list(true.columns)
        whole = float(size @ known.schur[np.ix_(at, at)] @ size)
        left = whole
        for columns in other.family:
            ix = list(columns)
            cross = known.schur[np.ix_(ix, at)] @ size
            system = known.schur[np.ix_(ix, ix)] + np.diag(1 / known.std[ix] ** 2)
            left = min(left, whole - float(cross @ np.linalg.solve(system, cross)))
        return 0.5 * max(left, 0.0)


def next_motion(
    evidence: Evidence, model: Directions, candidates: Sequence[Candidate], max_speed: Array | None = None
) -> NextMotion | None:
    """Return the motion of the library that parts the rivals most, as text, waypoints (rad) and URScript.

    model: what is fitted whatever is true, without the rivals. candidates: the names that do about equally
    well. max_speed (N,): rad/s of the joints (None: the slowest of UR's e-series). None when there is but one
    name. Where nothing in the library tells, the text says so and there are no waypoints and no script.
    """
    distinct = list({c.key: c for c in candidates}.values())
    if len(distinct) < 2:
        return None
    room = room_of(evidence, max_speed)
    found = promises(evidence, model, distinct, room)
    telling = [p for p in found if p.total >= APART]
    if not telling:
        return _nothing(distinct, found, room)
    best = max(telling, key=lambda p: p.rate)
    return NextMotion(
        _advice(distinct, best, len(found)),
        best.experiment.waypoints,
        best.experiment.speed,
        script_of(best.experiment, room, [_spoken(c.key) for c in distinct]),
        _named(best),
    )


def promises(
    evidence: Evidence, model: Directions, candidates: Sequence[Candidate], room: Room
) -> list[Promise]:
    """Rehearse every experiment on the joints of the candidates."""
    found = []
    with threadpool_limits(1):  # the matrices are small: threads would only wait for each other
        judgement = Judgement(evidence, model, candidates)
        small = _lean(evidence, model, judgement.directions)
        for experiment in library(room, _joints(candidates, room)):
            gram = information(experiment, room, evidence, small)
            minutes = minutes_of(experiment)
            pairs = {pair: nats / minutes for pair, nats in judgement.added(gram).items()}
            found.append(Promise(experiment, minutes, pairs))
    return found


def _of_rivals(evidence: Evidence, candidates: Sequence[Candidate]) -> tuple[Directions, list[_Rivals]]:
    families = [of_key(evidence.found.each, c.key) or [c] for c in candidates]
    used = sorted({x for family in families for c in family for x in c.columns})
    place = {x: i for i, x in enumerate(used)}

    def at(candidate: Candidate) -> tuple[int, ...]:
        return tuple(place[x] for x in candidate.columns)

    rivals = [
        _Rivals(c.key, at(c), tuple(at(x) for x in family))
        for c, family in zip(candidates, families, strict=True)
    ]
    return evidence.found.directions.take(used), rivals


def _size(known: Eliminated, columns: tuple[int, ...]) -> Array:
    """Return the coefficients found (k,), at least as large as a standard deviation in their direction."""
    found, covariance = known.solve(columns)
    sigmas = float(np.sqrt(found @ np.linalg.solve(covariance, found) / len(found)))
    return found / max(min(sigmas, 1.0), 1e-6)


def _lean(evidence: Evidence, model: Directions, rivals: Directions) -> Lean:
    used = np.concatenate([model.vectors.nonzero()[0], rivals.vectors.nonzero()[0]])
    return lean(evidence.setup, np.unique(used))


def _joints(candidates: Sequence[Candidate], room: Room) -> list[int]:
    """Return whom to exercise: the joints that are named, else one that carries the arm and the last two."""
    named = sorted({c.joint for c in candidates if c.joint is not None})
    return (named or sorted({min(1, room.dof - 1), max(room.dof - 2, 0), room.dof - 1}))[:_JOINTS]


def _spoken(key: Key) -> str:
    effect, joint = key
    return effect if joint is None else f"{effect} on joint {joint + 1}"


def _named(promise: Promise) -> dict[str, float]:
    return {f"{_spoken(a)} | {_spoken(b)}": rate for (a, b), rate in promise.pairs.items()}


def _advice(candidates: Sequence[Candidate], best: Promise, count: int) -> str:
    names = _both([_spoken(c.key) for c in candidates])
    load = " The script does not pick the load up: mount it, and set it on the robot, before it begins." * (
        best.experiment.load > 0
    )
    return (
        f"To tell {names} apart: {best.experiment.text}, {best.minutes:.0f} minutes. Of {count} motions it "
        f"parts their predictions most: {_rounded(best.rate)} nats a minute for the closest pair, and "
        f"{APART:g} settle it. "
        f"Angles are around a recorded pose; check the path in the cell before it runs.{load}"
    )


def _nothing(candidates: Sequence[Candidate], found: Sequence[Promise], room: Room) -> NextMotion:
    names = _both([_spoken(c.key) for c in candidates])
    best = max(found, key=lambda p: p.total, default=None)
    nearest = (
        ""
        if best is None
        else f" (the best, {best.experiment.text}, promises {best.total:.1f} nats of {APART:g})"
    )
    known = dict.fromkeys(EFFECTS[c.effect].motion for c in candidates if c.effect in EFFECTS)
    would = "; ".join(known) or "a load whose mass is known, or a recording of the healthy robot"
    text = f"None of {len(found)} motions tells {names} apart{nearest}. What would: {would}."
    return NextMotion(text, np.empty((0, room.dof)), 0.0, "", {} if best is None else _named(best))


def _rounded(rate: float) -> str:
    return f"{rate:.2g}" if rate < 10 else "over 1000" if rate > 1000 else f"{rate:.0f}"


def _both(names: Sequence[str]) -> str:
    return f"{', '.join(names[:-1])} and {names[-1]}"
