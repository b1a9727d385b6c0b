"""A load that is picked up and put down: when it is at the flange, and what it weighs.

Every row is in one of two states, with the load or without. The load's ten parameters, the arm with every
hypothesis at once, and the states are fitted in turn: what is wrong all the time is the arm's, so that only
what comes and goes in the pattern of one body is a load.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve
from scipy.ndimage import maximum_filter1d, minimum_filter1d, uniform_filter1d

from .evidence import Evidence, renewed, residual, weighed
from .grams import Scales, regime, scales_of, weights
from .naming import nuisance
from .physics import forces
from .quantities import payload_columns
from .refit import observed_runs
from .rows import Rows
from .segments import WINDOWS, Mask, first_guess, joined, segmented, stretches, sums_of, two_levels
from .selection import Directions, Eliminated, normal_equations

Array = NDArray[np.float64]

#: Fits and states in turn at most, with each arm.
_ROUNDS = 5
#: s; windows of the first guess at least.
_WINDOW = 2.0
#: s; residuals remember about so long. What lasts longer is the load as long as it is not in the model.
_MEMORY = 1.0
#: s; so close to a change of state the filter mixes both.
_BLUR = 0.2
#: Share of rows whose state changes in the last round.
_CHANGE = 1e-3
#: s; a stretch or a pause counts from here; a push is over before the second.
_SHORTEST, LONG = 1.0, 3.0
#: So many stretches of the same mass need not be long.
MANY = 4
#: Share of the time that a load is held which comes and goes.
LEAST, MOST = 0.05, 0.9
#: kg, and mass over its standard deviation.
LIGHTEST, SURE = 0.05, 5.0
#: m from the last joint's centre to the load's: further no gripper holds it.
REACH = 0.5
#: Nats by which it beats a load that is never or always there; nats of a stretch alone.
EVIDENCE, STRETCH = 30.0, 3.0
#: Nats of the first guess.
GUESS = 10.0
#: Of the squared residuals in its stretches, and of what a free force at the flange explains of them.
WHOLE, FORCE = 0.9, 0.9
#: A stretch's own mass over that of all, and the share of stretches that lie between.
ALIKE, AGREE = (0.7, 1.3), 0.7

#: Its mass with the plain arm over that with the arm of every hypothesis.
SAME = (0.5, 2.0)
#: Prior width of what a gripper holds: mass (kg), first moments (kg m), inertias (kg m^2) at the last frame.
WIDTHS = np.array([5.0, 0.5, 0.5, 0.5, 0.05, 0.05, 0.05, 0.05, 0.05, 0.05])
_TEN = range(len(WIDTHS))


@dataclass(frozen=True)
class Carried:
    """A load that is held in some stretches only.

    value (10,), covariance (10, 10): as of `quantities.payload_numbers`; intervals: (from, to) in s of the
    recordings' clocks; evidence: nats over a load that is never or always there. torque[i] (n, N): Nm that
    it takes in the rows of observed run i.
    """

    value: Array
    covariance: Array
    intervals: tuple[tuple[float, float], ...]
    evidence: float
    torque: tuple[Array, ...]


@dataclass(frozen=True)
class _Run:
    """Rows of an observed run; columns (n, N, 10) of a load that is always there."""

    rows: Rows
    columns: Array


@dataclass(frozen=True)
class _Try:
    """States held[i] (n,) of observed run i, and the arm and the load that were fitted to them."""

    evidence: Evidence
    runs: tuple[_Run, ...]
    held: tuple[Mask, ...]
    fit: Eliminated

    @cached_property
    def value(self) -> Array:
        """The load's parameters (10,)."""
        return self.fit.solve(_TEN)[0]

    @cached_property
    def left(self) -> list[Array]:
        """What the arm alone leaves of each run (n, N), Nm: the load where it is held."""
        theta = self.evidence.mean + self.fit.parameters(_TEN)
        return [residual(x.rows, self.evidence.setup.space, theta) for x in self.runs]

    @cached_property
    def load(self) -> list[Array]:
        """What the load takes where it is held (n, N), Nm, zero elsewhere."""
        return [x.columns @ self.value * h[:, None] for x, h in zip(self.runs, self.held, strict=True)]

    @cached_property
    def events(self) -> list[tuple[_Run, slice, Array]]:
        """Stretches, or pauses if those are more: run, rows, and torque (n, N) that tells the load's size."""
        away = self.share > 0.5
        return [
            (x, part, (x.columns @ self.value - e if away else e)[part])
            for x, e, h in zip(self.runs, self.left, self.held, strict=True)
            for part in stretches(h != away)
        ]

    @property
    def share(self) -> float:
        """Share of the time in which it is held."""
        return float(np.mean(np.concatenate(self.held)))


def carried(evidence: Evidence) -> Carried | None:
    """Return the load that the observed recordings show in some stretches of time only, or None.

    The first guess is that of the plain arm, and then that of the arm with every hypothesis: what is wrong
    all the time may hide the load from the one, and the other may take the load for its own.
    """
    runs = tuple(
        _Run(rows, payload_columns(evidence, rows))
        for rows in (evidence.runs[r] for r in observed_runs(evidence))
    )
    plain = nuisance(evidence)
    rich = plain + evidence.found.directions
    for k, start in enumerate((plain, rich)):
        first = _first(evidence, start, runs)
        if first is not None:
            found = _settled(first, start)
            if LEAST / 2 < found.share < 1 - LEAST / 2:
                found = _settled(found, rich)
            if not objection(found) and _same(found, plain):
                return _answer(found)
        elif k == 0:
            return None
    return None


def _same(found: _Try, arm: Directions) -> bool:
    """Return whether the load is about as heavy with another arm: a free enough one can feign any load."""
    other = replace(found, fit=_fitted(found.evidence, arm, found.runs, found.held))
    return bool(SAME[0] < other.value[0] / found.value[0] < SAME[1])


def unloaded(evidence: Evidence, load: Carried) -> Evidence:
    """Return the evidence of the recordings as they were without the load."""
    runs = list(evidence.runs)
    for r, torque in zip(observed_runs(evidence), load.torque, strict=True):
        runs[r] = replace(runs[r], torque=runs[r].torque - torque)
    return renewed(evidence, runs)


def _answer(found: _Try) -> Carried:
    spans = [
        (float(x.rows.time[s.start]), float(x.rows.time[s.stop - 1]))
        for x, h in zip(found.runs, found.held, strict=True)
        for s in stretches(h)
    ]
    value, covariance = found.fit.solve(_TEN)
    return Carried(value, covariance, tuple(spans), found.fit.evidence(_TEN), tuple(_blurred(found)))


def _blurred(found: _Try) -> list[Array]:
    """Return the load's torque of each run (n, N): near a change of state the part of it that fits best."""
    taken = []
    for x, e, h in zip(found.runs, found.left, found.held, strict=True):
        load, weight = x.columns @ found.value, _alike(x.rows, found.evidence.noise)
        part = np.sum(weight * load * e, axis=1) / np.maximum(np.sum(weight * load**2, axis=1), 1e-300)
        width = 2 * round(_BLUR / x.rows.step) + 1
        near = maximum_filter1d(h, width) & ~minimum_filter1d(h, width)
        taken.append(load * np.where(near, np.clip(part, 0, 1), h)[:, None])
    return taken


def _first(evidence: Evidence, arm: Directions, runs: tuple[_Run, ...]) -> _Try | None:
    """Return the load in the one stretch that it explains best, or None where that is nothing.

    Noise is what the residual does within a window: all else may be the load.
    """
    none = tuple(np.zeros(len(x.rows), bool) for x in runs)
    left = _Try(evidence, runs, none, _fitted(evidence, arm, runs, none)).left
    quick = [
        e - uniform_filter1d(e, round(_WINDOW / x.rows.step), axis=0) for x, e in zip(runs, left, strict=True)
    ]
    scales = scales_of([x.rows for x in runs], quick)
    window = max(_WINDOW, sum(len(x.rows) * x.rows.step for x in runs) / WINDOWS)
    sums = [
        sums_of(x.columns, _alike(x.rows, scales), e, round(window / x.rows.step))
        for x, e in zip(runs, left, strict=True)
    ]
    run, part, nats = first_guess(sums, WIDTHS)
    if nats < GUESS or sum(len(s.rows) for s in sums) < 2:
        return None
    none[run][part] = True
    anew = weighed(evidence, scales)
    return _Try(anew, runs, none, _fitted(anew, arm, runs, none))


def _settled(found: _Try, arm: Directions) -> _Try:
    """Find states, noise and fit in turn until nothing changes."""
    for _ in range(_ROUNDS):
        if found.value[0] < 0:  # the load is there when it seemed to be away
            evidence, held = found.evidence, tuple(~h for h in found.held)
        else:
            rest = [e - y for e, y in zip(found.left, found.load, strict=True)]
            scales = scales_of([x.rows for x in found.runs], rest)
            evidence, held = weighed(found.evidence, scales), _states(found, scales)
        changed = float(np.mean(np.concatenate(held) != np.concatenate(found.held)))
        found = _Try(evidence, found.runs, held, _fitted(evidence, arm, found.runs, held))
        if changed < _CHANGE or not 0 < found.share < 1:
            break
    return found


def _alike(rows: Rows, scales: Scales) -> Array:
    """Weights (n, N) in which a rest counts like motion: it is at rest that a load comes and goes."""
    sigma = np.take_along_axis(scales.sigma[None], regime(rows)[:, :, None], axis=2)[:, :, 0]
    return 1 / (sigma**2 * np.minimum(scales.inflation, _MEMORY / rows.step))


def _states(found: _Try, scales: Scales) -> tuple[Mask, ...]:
    """Return the likeliest states of each run's rows.

    As long as states are wrong the arm has taken a part of the load: rows then stand below no load at all
    without it, and below one load with it, so the two levels are found first.
    """
    loads = [x.columns @ found.value for x in found.runs]
    sums = [
        sums_of(load[:, :, None], _alike(x.rows, scales), e, round(_WINDOW / x.rows.step))
        for x, load, e in zip(found.runs, loads, found.left, strict=True)
    ]
    size = np.concatenate([s.matrix[:, 0, 0] for s in sums])
    low, high = two_levels(np.concatenate([s.right[:, 0] for s in sums]) / np.maximum(size, 1e-300), size)
    held = []
    for x, load, e in zip(found.runs, loads, found.left, strict=True):
        each = _alike(x.rows, scales) * load * (e - 0.5 * (high + low) * load)
        gain = (high - low) * each.sum(axis=1)
        held.append(joined(segmented(gain), round(_SHORTEST / x.rows.step)))
    return tuple(held)


def _fitted(evidence: Evidence, arm: Directions, runs: Sequence[_Run], held: Sequence[Mask]) -> Eliminated:
    """Fit the arm and the load, held in some rows, at once: the arm is eliminated from the load."""
    space, sums = evidence.setup.space, evidence.sums
    a, r = normal_equations(sums, arm, sums.total)
    cross, own, right = np.zeros((space.size, len(_TEN))), np.zeros((len(_TEN),) * 2), np.zeros(len(_TEN))
    for x, h in zip(runs, held, strict=True):
        weight = weights(x.rows, evidence.noise) * h[:, None]
        target = residual(x.rows, space, evidence.mean)
        for j in range(space.dof):
            weighted = x.columns[:, j] * weight[:, j, None]
            cross[space.indices[j]] += x.rows.columns[j].T @ weighted
            own += weighted.T @ x.columns[:, j]
            right += weighted.T @ target[:, j]
    b = arm.vectors.T @ cross
    solved = cho_solve(cho_factor(a + np.diag(1 / arm.std**2)), np.column_stack([b, r]))
    answer = arm.vectors @ solved
    return Eliminated(
        own - b.T @ solved[:, :-1], right - b.T @ solved[:, -1], WIDTHS, -answer[:, :-1], answer[:, -1]
    )


def objection(found: _Try) -> str:
    """Return in words why it is no load that is picked up and put down, or nothing."""
    mass, std = float(found.value[0]), float(np.sqrt(found.fit.solve(_TEN)[1][0, 0]))
    if not LEAST <= found.share <= MOST:
        return f"is held in {100 * found.share:.0f} % of the time"
    if all(h.all() or not h.any() for h in found.held):
        return "is never picked up or put down within a recording"
    if found.fit.evidence(_TEN) < EVIDENCE:
        return f"evidence {found.fit.evidence(_TEN):.1f} nats, {EVIDENCE:g} asked"
    if mass < max(LIGHTEST, SURE * std):
        return f"has a mass of {mass:.2g} kg with a standard deviation of {std:.2g} kg"
    if (away := float(np.linalg.norm(found.value[1:4])) / mass) > REACH:
        return f"has its centre {away:.2g} m from the last joint"
    lengths = [(part.stop - part.start) * x.rows.step for x, part, _ in found.events]
    if max(lengths) < LONG and len(lengths) < MANY:
        return "is held no longer than a push lasts"
    good = [ALIKE[0] < part < ALIKE[1] and nats > STRETCH for part, nats in _each(found)]
    if np.mean(good) < AGREE:
        return "is not the same load in each stretch"
    force, whole = _explained(found)
    if force < FORCE or whole < WHOLE:
        return f"explains {100 * force:.0f} % of what a free force does, and {100 * whole:.0f} % of all"
    return ""


def _each(found: _Try) -> list[tuple[float, float]]:
    """Return how much of the load each event shows, and the nats of it there.

    The load is that of the other events; one event alone is halved.
    """
    events = found.events
    if len(events) == 1:
        ((x, part, target),) = events
        middle = len(target) // 2
        first, second = slice(part.start, part.start + middle), slice(part.start + middle, part.stop)
        events = [(x, first, target[:middle]), (x, second, target[middle:])]
    weight = [weights(x.rows, found.evidence.noise)[part] for x, part, _ in events]
    sums = [
        sums_of(x.columns[part], w, target, len(target))
        for (x, part, target), w in zip(events, weight, strict=True)
    ]
    matrix, right = (np.sum([getattr(y, k)[0] for y in sums], axis=0) for k in ("matrix", "right"))
    values = []
    for (x, part, target), w, own in zip(events, weight, sums, strict=True):
        system = matrix - own.matrix[0] + np.diag(1 / WIDTHS**2)
        load = x.columns[part] @ np.linalg.solve(system, right - own.right[0])
        onto, size = float(np.sum(w * load * target)), float(np.sum(w * load**2))
        values.append((onto / max(size, 1e-300), onto - 0.5 * size))
    return values


def _explained(found: _Try) -> tuple[float, float]:
    """Return what the load explains over what a free force at the flange does, and over all that is there.

    Weighted squares in the stretches; what the pauses show, a row, is noise and is taken off.
    """
    load, rows, others = 0.0, np.zeros(2), np.zeros((2, 2))  # (pause or stretch, force or all)
    for x, e, y, h in zip(found.runs, found.left, found.load, found.held, strict=True):
        root = np.sqrt(weights(x.rows, found.evidence.noise))
        target = e * root
        columns = forces(found.evidence.setup.physics, x.rows.q, e.shape[1]) * root[:, :, None]
        gram = np.einsum("tji,tjk->tik", columns, columns) + 1e-6 * np.eye(3)
        right = np.einsum("tji,tj->ti", columns, target)
        force = np.einsum("ti,ti->t", right, np.linalg.solve(gram, right[:, :, None])[:, :, 0])
        each = np.stack([force, np.sum(target**2, axis=1)], axis=1)
        load += float(np.sum((target**2 - (target - y * root) ** 2)[h]))
        for k, part in enumerate((~h, h)):
            rows[k] += part.sum()
            others[k] += each[part].sum(axis=0)
    beyond = others[1] - others[0] * rows[1] / max(rows[0], 1.0)
    force_part, whole = load / np.maximum(beyond, 1e-9)
    return float(force_part), float(whole)
