"""Sums over rows, a fold at a time: everything that naming needs, whatever the recordings' length.

Rows count by what they can tell: errors around reversals are many times those of free motion, and at rest
friction is anything within its Coulomb level, so each regime has its own scale, and each joint's residual
its own memory.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.ndimage import binary_dilation

from .columns import Space
from .fast import gram, noise
from .pool import each
from .rows import Rows
from .segments import stretches
from .whitening import FREE, REST, ZERO, correlation_of, root

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Root = sparse.csr_array

#: s; what is left out together. Residuals of real arms remember 0.6-1 s.
BLOCK = 10.0
#: Folds at most: blocks that follow each other are joined.
FOLDS = 16
#: Short recordings are cut into this many, but no shorter than a few times the residual's memory (s).
FEWEST, SHORTEST = 5, 3.0
#: Rows whose kernel holds more of a rest than this, or of zero speed, are mixed with it: at rest friction is
#: anything within its Coulomb level, and where a joint passes through zero it is still building up.
_MIXED = 0.05
#: So many rows beside them the filter's skirts still hold what is a few deviations of free motion's noise.
_BESIDE = 2
#: Rows of a joint in a regime, below which their scale is unknown.
_FEW = 20


@dataclass(frozen=True)
class Fold:
    """One fold: weighted Gram matrices of [columns, torque], one a joint. observed: not of the reference."""

    grams: tuple[Array, ...]
    observed: bool
    run: int
    span: tuple[float, float]  # s


@dataclass(frozen=True)
class Scales:
    """Noise of each joint by regime, Nm (N, 3: free, through zero, rest), and rows per independent one (N,).

    fast (N,): variance of the fast band's torque times its samples per independent one, Nm^2.
    correlation: each joint's autocorrelation over rows (whitening.py); with none, memory is spread evenly.
    """

    sigma: Array
    inflation: Array
    fast: Array
    correlation: tuple[Array, ...] = ()


def regime(rows: Rows) -> Indices:
    """Return 0 free, 1 passing through zero speed, 2 at rest, a row and joint (n, N)."""
    near = np.ones((2 * _BESIDE + 1, 1), np.bool_)
    rest, zero = (binary_dilation(x < 1 - _MIXED, near) for x in (rows.moving, rows.sliding))
    return np.where(rest, REST, np.where(zero, ZERO, FREE)).astype(np.int64)


def roots(rows: Rows, scales: Scales) -> list[Root]:
    """Return each joint's matrix (n, n), 1/Nm, that makes its rows independent and of unit variance."""
    if not scales.correlation:
        return [sparse.csr_array(sparse.diags(np.sqrt(w))) for w in weights(rows, scales).T]
    which = regime(rows)
    return [
        root(rows.time, scales.sigma[j][which[:, j]], which[:, j], scales.correlation[j], rows.step)
        for j in range(which.shape[1])
    ]


def weights(rows: Rows, scales: Scales) -> Array:
    """Return the weight of each row and joint (n, N), 1/Nm^2, as if all of a regime told alike."""
    which = regime(rows)
    found = np.empty(which.shape)
    for j in range(which.shape[1]):
        alike = _alike(which[:, j], scales.inflation[j])
        found[:, j] = 1 / (scales.sigma[j][which[:, j]] ** 2 * alike)
    return found


def _alike(which: Indices, inflation: float) -> Array:
    """Rows that tell the same as a row: in motion the memory, but no more than a passage through zero has.

    At rest the whole rest (static friction).
    """
    found = np.full(len(which), inflation)
    for part in stretches(which == 1):
        found[part] = min(inflation, part.stop - part.start)
    for part in stretches(which == 2):
        found[part] = part.stop - part.start
    return found


def even_weights(rows: Rows, scales: Scales) -> Array:
    """Return the weight (n, N) of rows in motion, 1 in free motion: near zero speed by its noise, at rest 0.

    Errors at reversals are many times those of free motion, and few: squares alike are ruled by them.
    """
    which = regime(rows)
    free = scales.sigma[:, FREE]
    joints = np.arange(which.shape[1])
    return np.where(which == REST, 0.0, (free / scales.sigma[joints, which]) ** 2)


def folds_of(
    runs: Sequence[Rows], observed: Sequence[bool], scales: Scales, space: Space,
    observed_scales: Scales | None = None, sides: Sequence[bool] = (True, False),
) -> list[Fold]:  # fmt: skip
    """Cut runs into blocks of equal length, at most about FOLDS a side, and sum each.

    observed_scales: of the observed runs, when they are not those of all. sides: which are wanted.
    """
    return [
        fold
        for side in sides
        for fold in _side(
            runs, blocks(runs, observed, side), (observed_scales or scales) if side else scales, space, side
        )
    ]


def _side(
    runs: Sequence[Rows], parts: Sequence[tuple[int, slice]], scales: Scales, space: Space, side: bool
) -> list[Fold]:
    fast = _fast_columns(space)
    which = list(dict.fromkeys(r for r, _ in parts))
    whiten = dict(zip(which, each(lambda r: roots(runs[r], scales), which), strict=True))

    def fold(of: tuple[int, slice]) -> Fold:
        r, part = of
        rows = runs[r]
        span = float(rows.time[part.start]), float(rows.time[part.stop - 1])
        grams = tuple(_gram(rows, j, whiten[r][j][part]) for j in range(space.dof))
        if rows.fast is not None:
            for j in range(space.dof):
                ix = np.append(fast + len(space.seen[j]), len(space.indices[j]))
                grams[j][np.ix_(ix, ix)] += gram(rows.fast, j, span, scales.fast[j])
        return Fold(grams, side, r, span)

    return each(fold, parts)


def blocks(runs: Sequence[Rows], observed: Sequence[bool], side: bool) -> list[tuple[int, slice]]:
    """Return (run, rows) of each fold of the observed side, or of the reference's."""
    mine = [r for r, o in enumerate(observed) if o == side and len(runs[r])]
    total = sum(len(runs[r]) * runs[r].step for r in mine)
    length = max(min(BLOCK, total / FEWEST), total / FOLDS, SHORTEST)
    found = []
    for r in mine:
        parts = max(1, round(len(runs[r]) * runs[r].step / length))
        for index in np.array_split(np.arange(len(runs[r])), parts):
            found.append((r, slice(int(index[0]), int(index[-1]) + 1)))
    return found


def _fast_columns(space: Space) -> Indices:
    """Where ripple's columns stand among a joint's own."""
    return np.array([k for k, c in enumerate(space.own) if c.term == "ripple"], np.int64)


def _gram(rows: Rows, j: int, whiten: Root) -> Array:
    data = whiten @ np.column_stack([rows.columns[j], rows.torque[:, j]])
    return np.asarray(data.T @ data, np.float64)


def whole(grams: Sequence[Array], space: Space) -> Array:
    """Return the Gram matrix (P + 1, P + 1) of all joints from those of each."""
    size = space.size
    total = np.zeros((size + 1, size + 1))
    for j, own in enumerate(grams):
        ix = np.append(space.indices[j], size)
        total[np.ix_(ix, ix)] += own
    return total


def scales_of(runs: Sequence[Rows], residuals: Sequence[Array]) -> Scales:
    """Estimate scales and memory from residuals (n, N) of a model rich enough to leave noise."""
    n = residuals[0].shape[1]
    sigma, inflation, correlation = np.ones((n, 3)), np.ones(n), list[Array]()
    which = [regime(r) for r in runs]
    for j in range(n):
        by = [
            np.concatenate([e[w[:, j] == k, j] for e, w in zip(residuals, which, strict=True)])
            for k in range(3)
        ]
        known = [_scale(by[0]), _rms(by[1]), _rms(by[2])]
        best = min((s for s in known if s is not None), default=1.0)
        sigma[j] = [max(s, 0.3 * best) if s is not None else 3 * best for s in known]
        sigma[j, 1] = max(sigma[j, 1], sigma[j, 0])
        sigma[j, 2] = max(sigma[j, 2], 3 * sigma[j, 0])
        series = [
            np.clip(e[:, j] / sigma[j][w[:, j]], -5, 5) * (w[:, j] < 2)
            for e, w in zip(residuals, which, strict=True)
        ]
        inflation[j] = _memory(series)
        correlation.append(correlation_of(series))
    quick = [r.fast for r in runs if r.fast is not None]
    fast = [noise(quick, j) if quick else np.inf for j in range(n)]
    return Scales(sigma, inflation, np.array(fast), tuple(correlation))


def evenly(scales: Scales) -> Scales:
    """Return scales of which slow and fast residuals count alike."""
    return replace(scales, correlation=())


def equal_scales(n: int) -> Scales:
    """Return scales that weigh all rows of n joints alike."""
    return Scales(np.ones((n, 3)), np.ones(n), np.full(n, np.inf))


def _rms(errors: Array) -> float | None:
    """Rms, of all of them: errors at zero speed have long tails; None from too few rows."""
    return max(float(np.sqrt(np.mean(errors**2))), 1e-6) if len(errors) >= _FEW else None


def _scale(errors: Array) -> float | None:
    """Rms of what lies within four robust deviations; None from too few rows."""
    if len(errors) < _FEW:
        return None
    middle = 1.4826 * float(np.median(np.abs(errors)))
    inside = np.abs(errors) <= 4 * max(middle, 1e-9)
    return _rms(errors[inside])


def _memory(series: Sequence[Array]) -> float:
    """Rows per independent row: 1 + 2 sum of autocorrelations up to a self-consistent window (Sokal 1989)."""
    lags = 200
    products = np.zeros(lags)
    for x in series:
        size = 1 << int(np.ceil(np.log2(2 * len(x) + 1)))
        spectrum = np.abs(np.fft.rfft(x, size)) ** 2
        both = np.fft.irfft(spectrum, size)[: min(lags, len(x))]
        products[: len(both)] += both
    if products[0] <= 0:
        return 1.0
    sums = 1 + 2 * np.cumsum(products[1:] / products[0])
    inside = np.arange(1, lags) >= 2.5 * sums
    window = int(np.argmax(inside)) if inside.any() else lags - 2
    return max(1.0, float(sums[window]))
