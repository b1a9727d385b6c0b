"""Fits of a given model: on all rows, and with one fold left out; residuals row by row."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_solve

from .evidence import Evidence, residual
from .grams import blocks
from .selection import Directions, fit

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LeftOut:
    """Residuals (n, N) of each observed run under a model that has not seen the row's fold; fold (n,)."""

    residual: tuple[Array, ...]
    fold: tuple[NDArray[np.int64], ...]


def parameters(
    evidence: Evidence, model: Directions, left_out: int | None = None, healthy: bool = False
) -> Array:
    """Return the parameters (P,) on the observed side of a model fitted to all folds, or without one.

    healthy: those that reference and observed recordings share, as if nothing had changed.
    """
    fitted = fit(evidence.sums, model, evidence.sums.without(left_out))
    size = cho_solve(fitted.factor, fitted.right) * (model.shared if healthy else 1.0)
    return np.asarray(evidence.mean + model.vectors @ size, np.float64)


def residuals(evidence: Evidence, model: Directions) -> dict[int, Array]:
    """Return what a model leaves of each run with rows (n, N), Nm: of the reference, with what both share."""
    sides, space = evidence.observed, evidence.setup.space
    own = {side: parameters(evidence, model, healthy=not side) for side in set(sides)}
    return {r: residual(x, space, own[sides[r]]) for r, x in enumerate(evidence.runs) if len(x)}


def left_out(evidence: Evidence, model: Directions, healthy: bool = False) -> LeftOut:
    """Return what a model leaves of every observed row that it has not seen; healthy: as in `parameters`."""
    parts, number = blocks(evidence.runs, evidence.observed, True), 0
    residuals, folds = [], []
    for run in observed_runs(evidence):
        rows = evidence.runs[run]
        found, which = np.zeros(rows.torque.shape), np.zeros(len(rows), np.int64)
        theirs = [p for r, p in parts if r == run]
        for part in theirs:
            own = parameters(evidence, model, number, healthy)
            found[part] = residual(rows, evidence.setup.space, own, part)
            which[part] = number
            number += 1
        residuals.append(found)
        folds.append(which)
    return LeftOut(tuple(residuals), tuple(folds))


def observed_runs(evidence: Evidence) -> list[int]:
    """Return which runs are observed ones and hold rows."""
    return [r for r, o in enumerate(evidence.observed) if o and len(evidence.runs[r])]
