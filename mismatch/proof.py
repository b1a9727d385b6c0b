"""Proof on data that the fit did not see: error before and after, the flexible ceiling, thresholds."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .evidence import Evidence
from .grams import blocks, even_weights, regime
from .refit import LeftOut, left_out, observed_runs
from .result import Proof
from .selection import Directions

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

#: Draws of the block bootstrap, and its seed.
_DRAWS, _SEED = 1000, 7
#: Alarms an hour and joint at which thresholds are compared.
FALSE_ALARMS = 1.0


def prove(
    evidence: Evidence, before: Directions, after: Directions, recorded: Evidence
) -> tuple[Proof, LeftOut, LeftOut]:
    """Compare two models on rows that neither has seen; also return what both leave there.

    With a reference the first one is what the second makes of the healthy robot.
    evidence: weighed by what the second model leaves. recorded: the rows for the first model, with what was
    found and taken off `evidence`.
    """
    curves = [c for joint in evidence.found.curve for c in joint]
    flexible = after + evidence.found.directions.take(curves)
    first = left_out(recorded, before, evidence.has_reference)
    last, best = (left_out(evidence, m) for m in (after, flexible))
    moving = motion(evidence)
    rms_first, rms_last, rms_best = (rms_where(x.residual, moving) for x in (first, last, best))
    ceiling = np.minimum(rms_best, rms_last)
    explained, possible = rms_first**2 - rms_last**2, rms_first**2 - ceiling**2
    worth = possible > 0.01 * rms_first**2
    reached = np.where(worth, np.clip(explained / np.where(worth, possible, 1.0), 0, 1), np.nan)
    found = Proof(
        _scheme(evidence), rms_first, rms_last, _interval(last, moving), ceiling, reached,
        _threshold(evidence, first), _threshold(evidence, last), FALSE_ALARMS,
    )  # fmt: skip
    return found, first, last


def _scheme(evidence: Evidence) -> str:
    count = len(blocks(evidence.runs, evidence.observed, True))
    side = "of the observed recordings, reference kept" if evidence.has_reference else "of the recordings"
    what = "rms of each joint's low-passed torque error in motion, around zero speed by its noise there"
    return f"{count} blocks {side} left out one at a time; {what}"


def joint_moves(evidence: Evidence) -> Flags:
    """Return the observed rows (n, N) in which a joint moves: at rest no model tells friction from load.

    Of a joint that never does, those in which the arm moves.
    """
    runs = [evidence.runs[r] for r in observed_runs(evidence)]
    found = np.concatenate([regime(r) < 2 for r in runs])
    arm = np.concatenate([r.arm_moves for r in runs])
    return np.where(found.any(axis=0), found, arm[:, None])


def motion(evidence: Evidence) -> Array:
    """Return the weights (n, N) of the observed rows in which joints move: 1, around zero speed by noise.

    Of a joint that never moves freely, those in which the arm moves.
    """
    runs = [evidence.runs[r] for r in observed_runs(evidence)]
    found = np.concatenate([even_weights(r, evidence.noise) for r in runs])
    return np.where((found == 1).any(axis=0), found, joint_moves(evidence))


def rms_where(errors: Sequence[Array], weights: Array | Flags) -> Array:
    """Return the rms (N,) of errors (n, N) of some runs, each joint's rows as they weigh."""
    squares = weights * np.concatenate(errors) ** 2
    return np.asarray(np.sqrt(squares.sum(axis=0) / np.maximum(weights.sum(axis=0), 1e-12)), np.float64)


def _interval(left: LeftOut, moving: Array) -> Array:
    """95 % interval (N, 2) of the rms by drawing whole folds with replacement (Kuensch 1989)."""
    squares, folds = moving * np.concatenate(left.residual) ** 2, np.concatenate(left.fold)
    numbers = np.unique(folds)
    by_fold = np.array([squares[folds == k].sum(axis=0) for k in numbers])
    counts = np.array([moving[folds == k].sum(axis=0) for k in numbers])
    drawn = np.random.default_rng(_SEED).integers(0, len(numbers), (_DRAWS, len(numbers)))
    rms = np.sqrt(by_fold[drawn].sum(axis=1) / np.maximum(counts[drawn].sum(axis=1), 1e-12))
    return np.asarray(np.percentile(rms, [2.5, 97.5], axis=0).T, np.float64)


def _threshold(evidence: Evidence, left: LeftOut) -> Array:
    """Limit (N,) that |residual| passes FALSE_ALARMS times an hour.

    Of independent maxima over the residual's memory; beyond the recorded time an exponential tail above
    the 95th percentile carries on.
    """
    errors = np.abs(np.concatenate(left.residual))
    step = evidence.runs[observed_runs(evidence)[0]].step
    found = np.empty(errors.shape[1])
    for j in range(errors.shape[1]):
        memory = max(1, round(float(evidence.scales.inflation[j])))
        peaks = np.array([x.max() for x in np.array_split(errors[:, j], max(1, len(errors) // memory))])
        start = float(np.percentile(peaks, 90))
        above = peaks[peaks > start] - start
        rate = len(above) / (len(errors) * step / 3600)  # an hour
        found[j] = start + (float(above.mean()) if len(above) else 0.0) * np.log(
            max(rate / FALSE_ALARMS, 1.0)
        )
    return found
