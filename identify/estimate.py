"""The iterated fit over placed rows: robust weights, noise of each joint, memory, covariance, folds."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .moments import JointMoments, moments, score_scatter, total
from .pieces import Piece
from .rows import Recipe, Rows, make_rows
from .schedule import Scheduler
from .solve import Estimate, Noise, Problem, covariance, noise_of, solve

Array = NDArray[np.float64]

#: Passes over the rows at most; the weights have settled after four to eight.
_PASSES = 20
#: Settled: no parameter moves by more than this share of its standard deviation.
_SETTLED = 1e-3


@dataclass(frozen=True)
class FoldRows:
    """Rows of one piece, cut into folds (what is left out together): fold number -> rows."""

    folds: tuple[tuple[int, Rows], ...]
    step: float


@dataclass(frozen=True)
class HeldOut:
    """Errors on folds that the parameters have not seen; arrays (folds, N): sums of squares, Nm^2.

    scored: over rows where any joint moves; all: over all rows; own: over rows where the joint itself moves
    (those that are fitted, outliers weighed down). torque_*: of the measured torque there. count*: rows.
    fitted (N,): the same as own, of the parameters that have seen all rows.
    """

    scored: Array
    torque: Array
    count: Array
    all: Array
    torque_all: Array
    count_all: Array
    own: Array
    torque_own: Array
    count_own: Array
    fitted: Array

    def percent(self, which: str = "scored") -> Array:
        """Return error norm over torque norm (N,), percent: which is scored, all or own."""
        error, torque, _ = self._sums(which)
        return 100 * np.sqrt(error / np.maximum(torque, 1e-300))

    def rms(self, which: str = "scored") -> Array:
        """Return the rms error (N,), Nm."""
        error, _, count = self._sums(which)
        return np.sqrt(error / np.maximum(count, 1.0))

    def _sums(self, which: str) -> tuple[Array, Array, Array]:
        ending = "" if which == "scored" else f"_{which}"
        fields = (which, f"torque{ending}", f"count{ending}")
        error, torque, count = (np.sum(getattr(self, f), axis=0) for f in fields)
        return error, torque, count


@dataclass(frozen=True)
class Fitted:
    """A settled fit: estimate, covariance (P, P), noise, sums of all rows and of each fold."""

    estimate: Estimate
    covariance: Array
    noise: Noise
    sums: tuple[JointMoments, ...]
    folds: dict[int, tuple[JointMoments, ...]]
    passes: int


def fold_rows(piece: Piece, recipe: Recipe, edges: Sequence[float]) -> FoldRows:
    """Make the rows of a piece; fold: its run, or the block between `edges` (s) when there are any."""
    rows = make_rows(piece.recording, recipe)
    if not edges:
        return FoldRows(((piece.run, rows),), rows.step)
    block = np.searchsorted(np.asarray(edges), rows.time)
    return FoldRows(tuple((int(b), _cut(rows, block == b)) for b in np.unique(block)), rows.step)


def _cut(rows: Rows, keep: NDArray[np.bool_]) -> Rows:
    index = np.flatnonzero(keep)
    first, last = int(index[0]), int(index[-1]) + 1
    starts = (0, *(s - first for s in rows.starts if first < s < last))
    part = slice(first, last)
    columns = tuple(c[part] for c in rows.columns)
    return Rows(rows.time[part], rows.torque[part], rows.moving[part], columns, starts, rows.step)


def fit(handles: Sequence[Any], problem: Problem, scheduler: Scheduler) -> Fitted:
    """Iterate weighted, robust least squares over placed `FoldRows` until it settles.

    The Gram matrices of a pass give the next parameters; the next pass weighs errors anew. Rows of all
    joints are weighed by their effective number: 1 / (sigma^2 inflation).
    """
    n = len(problem.indices)
    theta, sigma, used = problem.prior.mean, np.full(n, np.inf), np.zeros(n)
    for done in range(1, _PASSES + 1):
        folds = _pass(handles, problem, theta, sigma, scheduler)
        sums = total([folds[k] for k in sorted(folds)])
        noise = noise_of(sums, used)
        estimate = solve(sums, noise, problem, constrained=False)
        deviation = np.sqrt(np.diag(np.linalg.inv(estimate.information)))
        change = float(np.max(np.abs(estimate.theta - theta) / deviation))
        theta, sigma = estimate.theta, noise.sigma
        used = _determined_by(sums, estimate, noise, problem)
        if done > 2 and change < _SETTLED:
            break
    estimate = solve(sums, noise, problem)
    parts = scheduler.map(_scatter, handles, noise.memory)
    scatter = [np.sum([p[i] for p in parts], axis=0) for i in range(n)]
    return Fitted(estimate, covariance(estimate, scatter, noise, problem), noise, sums, folds, done)


def sums_at(
    handles: Sequence[Any], problem: Problem, theta: Array, sigma: Array, scheduler: Scheduler
) -> tuple[JointMoments, ...]:
    """Sum all rows once, with errors weighed at theta (P,) and sigma (N,)."""
    folds = _pass(handles, problem, theta, sigma, scheduler)
    return total([folds[k] for k in sorted(folds)])


def _pass(
    handles: Sequence[Any], problem: Problem, theta: Array, sigma: Array, scheduler: Scheduler
) -> dict[int, tuple[JointMoments, ...]]:
    found = scheduler.map(_moments, handles, problem.parameters_of(theta), tuple(sigma))
    folds: dict[int, tuple[JointMoments, ...]] = {}
    for piece in found:
        for number, sums in piece:
            folds[number] = total([folds[number], sums]) if number in folds else sums
    if not folds:
        raise InputError(
            "fit: no recording is long enough for the filter; record 5 s or more, or raise --cutoff"
        )
    return folds


def _moments(
    rows: FoldRows, parameters: Sequence[Array], sigma: Sequence[float]
) -> list[tuple[int, tuple[JointMoments, ...]]]:
    return [(number, moments(part, parameters, sigma)) for number, part in rows.folds]


def _scatter(rows: FoldRows, memory: Sequence[Array]) -> tuple[Array, ...]:
    parts = [score_scatter(part, memory) for _, part in rows.folds]
    return tuple(np.sum([p[i] for p in parts], axis=0) for i in range(len(memory)))


def _determined_by(sums: Sequence[JointMoments], estimate: Estimate, noise: Noise, problem: Problem) -> Array:
    """Degrees of freedom that each joint's rows have used up: trace of their share of the information."""
    inverse = np.linalg.inv(estimate.information)
    used = []
    for i, ix in enumerate(problem.indices):
        share = sums[i].fitted[:-1, :-1] / (noise.sigma[i] ** 2 * noise.inflation[i])
        used.append(float(np.sum(inverse[np.ix_(ix, ix)] * share)))
    return np.array(used)


def held_out(fitted: Fitted, problem: Problem) -> HeldOut:
    """Leave one fold out at a time, solve from the sums of the others, score on it.

    Robust weights and noise are those of the fit to all folds (weights, not parameters, have seen the fold).
    """
    table: list[list[tuple[float, ...]]] = []
    for left_out in sorted(fitted.folds):
        others = total([fitted.folds[k] for k in sorted(fitted.folds) if k != left_out])
        theta = solve(others, fitted.noise, problem, constrained=fitted.estimate.moved > 0).theta
        row = []
        for i, joint in enumerate(fitted.folds[left_out]):
            v = np.append(-theta[problem.indices[i]], 1.0)
            grams = (
                (joint.scored, joint.scored_count),
                (joint.all, joint.all_count),
                (joint.fitted, joint.count),
            )
            row.append(
                tuple(
                    x
                    for gram, count in grams
                    for x in (max(float(v @ gram @ v), 0.0), float(gram[-1, -1]), count)
                )
            )
        table.append(row)
    everything = zip(problem.parameters_of(fitted.estimate.theta), fitted.sums, strict=True)
    seen = [max(float(np.append(-t, 1.0) @ s.fitted @ np.append(-t, 1.0)), 0.0) for t, s in everything]
    scored, torque, count, every, torque_all, count_all, own, torque_own, count_own = np.moveaxis(
        np.array(table), 2, 0
    )
    return HeldOut(
        scored, torque, count, every, torque_all, count_all, own, torque_own, count_own, np.array(seen)
    )
