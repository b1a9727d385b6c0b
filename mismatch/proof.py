"""Proof on data that the fit did not see: error before and after, the flexible ceiling, thresholds."""

import numpy as np
from numpy.typing import NDArray

from .evidence import Evidence
from .grams import blocks
from .refit import LeftOut, left_out, observed_runs
from .result import Proof
from .selection import Directions

Array = NDArray[np.float64]

#: Draws of the block bootstrap, and its seed.
_DRAWS, _SEED = 1000, 7
#: Alarms an hour and joint at which thresholds are compared.
FALSE_ALARMS = 1.0


def prove(
    evidence: Evidence, before: Directions, after: Directions, recorded: Evidence | None = None
) -> tuple[Proof, LeftOut, LeftOut]:
    """Compare two models on rows that neither has seen; also return what both leave there.

    recorded: the rows as they were, for the first model, when something found was taken off `evidence`.
    """
    curves = [c for joint in evidence.found.curve for c in joint]
    flexible = after + evidence.found.directions.take(curves)
    first = left_out(recorded or evidence, before)
    last, best = (left_out(evidence, m) for m in (after, flexible))
    moving = [evidence.runs[r].arm_moves for r in observed_runs(evidence)]
    rms_first, rms_last, rms_best = (_rms(x, moving) for x in (first, last, best))
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
    what = "rms of the low-passed torque error where the arm moves"
    return f"{count} blocks {side} left out one at a time; {what}"


def _rms(left: LeftOut, moving: list[NDArray[np.bool_]]) -> Array:
    everything = np.concatenate([e[m] for e, m in zip(left.residual, moving, strict=True)])
    return np.sqrt(np.mean(everything**2, axis=0)) if len(everything) else np.zeros(left.residual[0].shape[1])


def _interval(left: LeftOut, moving: list[NDArray[np.bool_]]) -> Array:
    """95 % interval (N, 2) of the rms by drawing whole folds with replacement (Kuensch 1989)."""
    errors = np.concatenate([e[m] for e, m in zip(left.residual, moving, strict=True)])
    folds = np.concatenate([f[m] for f, m in zip(left.fold, moving, strict=True)])
    numbers = np.unique(folds)
    if not len(numbers):
        return np.zeros((errors.shape[1], 2))
    squares = np.array([np.sum(errors[folds == k] ** 2, axis=0) for k in numbers])
    counts = np.array([np.sum(folds == k) for k in numbers])
    drawn = np.random.default_rng(_SEED).integers(0, len(numbers), (_DRAWS, len(numbers)))
    rms = np.sqrt(squares[drawn].sum(axis=1) / counts[drawn].sum(axis=1)[:, None])
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
