"""A load that is picked up and put down: when it is at the flange, and what it weighs.

Every row is in one of two states, with the load or without. The load's ten parameters, the arm with every
hypothesis at once, and the states are fitted in turn: what is wrong all the time is the arm's, so that only
what comes and goes in the pattern of one body is a load.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, minimum_filter1d, uniform_filter1d

from .evidence import Evidence, evenly_weighed, renewed, weighed
from .grams import Scales, evenly, regime, scales_of
from .held import TEN, WIDTHS, Held, LoadedRun, fitted
from .load_checks import AGREE, LEAST, objection, same_load
from .naming import nuisance
from .quantities import payload_columns
from .refit import observed_runs
from .rows import Rows
from .segments import WINDOWS, Mask, first_guesses, joined, segmented, stretches, sums_of, two_levels
from .selection import Directions

Array = NDArray[np.float64]

#: Fits and states in turn at most, with each arm.
_ROUNDS = 5
#: s; windows of the first guess at least.
_WINDOW = 2.0
#: s; residuals remember about so long. What lasts longer is the load as long as it is not in the model.
_MEMORY = 1.0
#: s; so close to a change of state the filter mixes both.
_BLUR = 0.2
#: s; so close to one whoever hands it over may touch it.
_TOUCHES = 0.5
#: Share of rows whose state changes in the last round.
_CHANGE = 1e-3
#: s; a stretch or a pause counts from here.
_SHORTEST = 1.0
#: Nats of a first guess, and how many are followed up.
GUESS, _GUESSES = 10.0, 3
#: Its mass with the plain arm over that with the arm of every hypothesis.
SAME = (0.5, 2.0)


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


def carried(evidence: Evidence) -> Carried | None:
    """Return the load that the observed recordings show in some stretches of time only, or None.

    First guesses are those of the plain arm, and then those of the arm with every hypothesis: what is wrong
    all the time may hide the load from the one, and the other may take the load for its own.
    """
    evidence = evenly_weighed(evidence)
    runs = tuple(
        LoadedRun(rows, payload_columns(evidence, rows))
        for rows in (evidence.runs[r] for r in observed_runs(evidence))
    )
    plain = nuisance(evidence)
    rich = plain + evidence.found.directions
    for k, start in enumerate((plain, rich)):
        guesses = _guesses(evidence, start, runs)
        if not guesses and k == 0:
            return None
        for first in guesses:
            found = _settled(first, start)
            if not LEAST / 2 < found.share < 1 - LEAST / 2 or found.fit.evidence(TEN) < GUESS:
                continue
            found = _of_one_load(_settled(found, rich), rich)
            if not objection(found) and _same(found, plain):
                return _answer(found)
    return None


def _of_one_load(found: Held, arm: Directions) -> Held:
    """Return it without the events that are not the same load, where those are a small part of the time."""
    good, lengths = same_load(found), np.array([part.stop - part.start for _, part, _ in found.events])
    if len(good) != len(lengths) or good.all() or lengths[good].sum() < AGREE * lengths.sum():
        return found
    held = tuple(h.copy() for h in found.held)
    for run, states in zip(found.runs, held, strict=True):
        for (x, part, _), same in zip(found.events, good, strict=True):
            if x is run and not same:
                states[part] = ~states[part]
    return replace(found, held=held, fit=fitted(found.evidence, arm, found.runs, held))


def _same(found: Held, arm: Directions) -> bool:
    """Return whether the load is about as heavy with another arm: a free enough one can feign any load."""
    other = replace(found, fit=fitted(found.evidence, arm, found.runs, found.held))
    return bool(SAME[0] < other.value[0] / found.value[0] < SAME[1])


def unloaded(evidence: Evidence, load: Carried) -> Evidence:
    """Return the evidence of the recordings as they were without the load."""
    runs = list(evidence.runs)
    for r, torque in zip(observed_runs(evidence), load.torque, strict=True):
        runs[r] = replace(runs[r], torque=runs[r].torque - torque)
    return renewed(evidence, runs)


def handled(evidence: Evidence, load: Carried) -> dict[int, Mask]:
    """Return by observed run which rows (n,) are close to a change: who picks up or puts down touches.

    And the change itself is known to its rows at best.
    """
    close = {}
    for r, torque in zip(observed_runs(evidence), load.torque, strict=True):
        held = np.any(torque != 0.0, axis=1)
        change = np.diff(held, prepend=held[:1])
        close[r] = maximum_filter1d(change, 2 * round(_TOUCHES / evidence.runs[r].step) + 1)
    return close


def _answer(found: Held) -> Carried:
    spans = [
        (float(x.rows.time[s.start]), float(x.rows.time[s.stop - 1]))
        for x, h in zip(found.runs, found.held, strict=True)
        for s in stretches(h)
    ]
    value, covariance = found.fit.solve(TEN)
    return Carried(value, covariance, tuple(spans), found.fit.evidence(TEN), tuple(_blurred(found)))


def _blurred(found: Held) -> list[Array]:
    """Return the load's torque of each run (n, N): near a change of state the part of it that fits best."""
    taken = []
    for x, e, h in zip(found.runs, found.left, found.held, strict=True):
        load, weight = x.columns @ found.value, _alike(x.rows, found.evidence.noise)
        part = np.sum(weight * load * e, axis=1) / np.maximum(np.sum(weight * load**2, axis=1), 1e-300)
        width = 2 * round(_BLUR / x.rows.step) + 1
        near = maximum_filter1d(h, width) & ~minimum_filter1d(h, width)
        taken.append(load * np.where(near, np.clip(part, 0, 1), h)[:, None])
    return taken


def _guesses(evidence: Evidence, arm: Directions, runs: tuple[LoadedRun, ...]) -> list[Held]:
    """Return the load in the stretches that it explains best, each alone; none where that is nothing.

    Noise is what the residual does within a window: all else may be the load, and so may what is slow.
    """
    none = tuple(np.zeros(len(x.rows), bool) for x in runs)
    left = Held(evidence, runs, none, fitted(evidence, arm, runs, none)).left
    quick = [
        e - uniform_filter1d(e, round(_WINDOW / x.rows.step), axis=0) for x, e in zip(runs, left, strict=True)
    ]
    scales = evenly(scales_of([x.rows for x in runs], quick))
    window = max(_WINDOW, sum(len(x.rows) * x.rows.step for x in runs) / WINDOWS)
    sums = [
        sums_of(x.columns, _alike(x.rows, scales), e, round(window / x.rows.step))
        for x, e in zip(runs, left, strict=True)
    ]
    if sum(len(s.rows) for s in sums) < 2:
        return []
    anew, found = weighed(evidence, scales), []
    for run, part, nats in first_guesses(sums, WIDTHS, _GUESSES):
        if nats > GUESS:
            held = tuple(h.copy() for h in none)
            held[run][part] = True
            found.append(Held(anew, runs, held, fitted(anew, arm, runs, held)))
    return found


def _settled(found: Held, arm: Directions) -> Held:
    """Find states, noise and fit in turn until nothing changes."""
    for _ in range(_ROUNDS):
        if found.value[0] < 0:  # the load is there when it seemed to be away
            evidence, held = found.evidence, tuple(~h for h in found.held)
        else:
            rest = [e - y for e, y in zip(found.left, found.load, strict=True)]
            scales = evenly(scales_of([x.rows for x in found.runs], rest))
            evidence, held = weighed(found.evidence, scales), _states(found, scales)
        changed = float(np.mean(np.concatenate(held) != np.concatenate(found.held)))
        found = Held(evidence, found.runs, held, fitted(evidence, arm, found.runs, held))
        if changed < _CHANGE or not 0 < found.share < 1:
            break
    return found


def _alike(rows: Rows, scales: Scales) -> Array:
    """Weights (n, N) in which a rest counts like motion: it is at rest that a load comes and goes."""
    sigma = np.take_along_axis(scales.sigma[None], regime(rows)[:, :, None], axis=2)[:, :, 0]
    return 1 / (sigma**2 * np.minimum(scales.inflation, _MEMORY / rows.step))


def _states(found: Held, scales: Scales) -> tuple[Mask, ...]:
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
