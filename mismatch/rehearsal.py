"""An experiment before it is done: its trajectory, and what it would tell about every parameter."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..recordings import Recording
from .columns import NO_PHYSICS, Indices, Space
from .evidence import Evidence
from .experiments import Experiment, Step
from .grams import Scales, folds_of, whole
from .room import Room
from .rows import make_rows
from .track import Setup

Array = NDArray[np.float64]

#: Hz; the filter's cutoff is the same as at 500 Hz, and the work a quarter.
RATE = 125.0
#: m from the last joint's centre, along its axis, at which a known load's mass sits.
_AHEAD = 0.1


@dataclass(frozen=True)
class Lean:
    """A setup with only the columns that matter; places (P',): where its parameters stand among all P."""

    setup: Setup
    places: Indices
    size: int


def lean(setup: Setup, used: Indices) -> Lean:
    """Leave out own columns that no joint uses, and what is no physics; used: places that matter (of P)."""
    space, wanted = setup.space, set(used.tolist())
    kept = [
        k
        for k, c in enumerate(space.own)
        if c.term not in NO_PHYSICS and any(space.own_index(j, k) in wanted for j in range(space.dof))
    ]
    small = Space(space.dof, space.base, tuple(space.own[k] for k in kept), space.common, space.seen)
    own = [space.own_index(j, k) for j in range(space.dof) for k in kept]
    common = [space.common_index(name) for name in space.common]
    places = np.array([*range(len(space.base)), *own, *common], np.int64)
    return Lean(replace(setup, space=small, limits=None), places, space.size)


def trajectory(steps: Sequence[Step]) -> tuple[Array, Array, Array]:
    """Return time (T,), q and qd (T, N) of one round: movej from rest to rest (trapezoids), and rests."""
    pieces, first = list[tuple[Array, Array]](), steps[0]
    before = first.pose
    for step in (*steps, first):
        way = step.pose - before
        longest = float(np.max(np.abs(way)))
        if longest > 0:
            s, v = _trapezoid(longest, step.speed, step.acceleration)
            pieces.append((before + np.outer(s, way / longest), np.outer(v, way / longest)))
        rest = np.tile(step.pose, (round(step.dwell * RATE), 1))
        pieces.append((rest, np.zeros_like(rest)))
        before = step.pose
    q, qd = (np.concatenate(x) for x in zip(*pieces, strict=True))
    return np.arange(len(q)) / RATE, q, qd


def _trapezoid(length: float, speed: float, acceleration: float) -> tuple[Array, Array]:
    """Return way and speed (T,) from rest to rest, without the first sample."""
    top = min(speed, float(np.sqrt(length * acceleration)))
    ramp, total = top / acceleration, length / top + top / acceleration
    t = np.arange(1, max(1, round(total * RATE)) + 1) / RATE
    early, late = np.clip(t, 0, ramp), np.clip(total - t, 0, ramp)
    way = length - 0.5 * acceleration * late**2 - top * np.clip(total - ramp - t, 0, None)
    rising = t < ramp
    way[rising] = 0.5 * acceleration * early[rising] ** 2
    return way, acceleration * np.minimum(early, late)


def recording_of(steps: Sequence[Step], temperature: Array) -> Recording:
    """Return one round as a recording without current; temperature (N,) deg C all the while."""
    time, q, qd = trajectory(steps)
    hot = np.tile(temperature, (len(time), 1))
    return Recording("experiment", time, q, np.zeros_like(q), qd=qd, joint_temperatures=hot)


def rounds_of(experiment: Experiment) -> int:
    """Return how often the steps are gone through in the experiment's minutes; at least once."""
    return max(1, round(60 * experiment.minutes * RATE / len(trajectory(experiment.steps)[0])))


def minutes_of(experiment: Experiment) -> float:
    """Return how long all rounds take, minutes."""
    return rounds_of(experiment) * len(trajectory(experiment.steps)[0]) / RATE / 60


def information(experiment: Experiment, room: Room, evidence: Evidence, small: Lean) -> Array:
    """Return the Gram matrix (P + 1, P + 1) that all rounds of an experiment would add; torque is zero.

    Rows weigh as in `grams`: by the noise of the joint in each regime and by its memory, a rest once, and
    then as anything within the Coulomb level.
    """
    setup = small.setup
    if experiment.load > 0:
        setup = replace(setup, base=setup.base + experiment.load * _known(setup))
    temperatures = (
        [room.temperature, room.temperature + experiment.warmer] if experiment.warmer else [room.temperature]
    )
    scales = _careful(evidence)
    total = np.zeros((small.size + 1,) * 2)
    for hot in temperatures:
        rows = make_rows(recording_of(experiment.steps, hot), setup)
        if len(rows):
            grams = [whole(f.grams, setup.space) for f in folds_of([rows], [True], scales, setup.space)]
            total[np.ix_(small.places, small.places)] += np.sum(grams, axis=0)[:-1, :-1]
    return np.asarray(total * rounds_of(experiment) / len(temperatures), np.float64)


def _careful(evidence: Evidence) -> Scales:
    """Return the noise, at rest no less than a uniform one between -Fc and +Fc has (Fc / sqrt 3)."""
    sigma = evidence.noise.sigma.copy()
    sigma[:, 2] = np.maximum(sigma[:, 2], np.abs(evidence.setup.friction[:, 0]) / np.sqrt(3))
    return replace(evidence.noise, sigma=sigma)


def _known(setup: Setup) -> Array:
    """Return base parameters (B,) of 1 kg ahead of the last joint's centre."""
    last = 10 * (setup.physics.dof - 1)  # there stand m, mx, my, mz of the last link
    links = setup.physics.map.links
    return np.asarray(links[:, last] + _AHEAD * links[:, last + 3], np.float64)
