"""Sums over rows: everything that a fit needs, additive over pieces, so that memory does not grow.

For each joint the Gram matrix of [columns, torque]; a sum of squared errors is then the quadratic form
v' gram v with v = [-parameters, 1].
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from .rows import Rows

Array = NDArray[np.float64]

#: s; the residual's memory is sought up to this lag (real UR residuals: 0.6-1 s integrated).
LONGEST_LAG = 5.0
#: Errors beyond this many standard deviations count linearly, not squared (Huber 1964).
HUBER = 3.0
#: E[psi^2] of a normal error with that threshold, by which the scale is made consistent (Huber's proposal 2).
HUBER_CONSISTENCY = 0.99501


@dataclass(frozen=True)
class JointMoments:
    """Sums for one joint with P parameters.

    fitted: weighted Gram (P+1, P+1) over rows where the joint moves, the only ones that are fitted (at
    rest its friction is anything within its Coulomb level). scored, all: plain Gram over rows where any
    joint moves, over all. count, scored_count, all_count: their rows. squares: sum of psi^2. products,
    pairs: sums of psi(t) psi(t + lag) and how many, by lag (L,). outliers: rows that Huber's weight lowers.
    """

    fitted: Array
    scored: Array
    all: Array
    count: float
    scored_count: float
    all_count: float
    squares: float
    products: Array
    pairs: Array
    outliers: float

    def __add__(self, other: "JointMoments") -> "JointMoments":
        return JointMoments(*(getattr(self, k) + getattr(other, k) for k in self.__dataclass_fields__))


def moments(rows: Rows, parameters: Sequence[Array], sigma: Sequence[float]) -> tuple[JointMoments, ...]:
    """Sum over some rows.

    parameters: each joint's (P_i,), at which errors are weighed; sigma (N,): Nm, infinite for no weighing.
    """
    return tuple(_joint(rows, i, parameters[i], sigma[i]) for i in range(len(rows.columns)))


def total(parts: Sequence[tuple[JointMoments, ...]]) -> tuple[JointMoments, ...]:
    """Add pieces, joint by joint, in their order."""
    result = parts[0]
    for part in parts[1:]:
        result = tuple(a + b for a, b in zip(result, part, strict=True))
    return result


def _joint(rows: Rows, i: int, parameters: Array, sigma: float) -> JointMoments:
    data = np.column_stack([rows.columns[i], rows.torque[:, i]])
    own, some = rows.moving[:, i], rows.moving.any(axis=1)
    error = data[:, -1] - data[:, :-1] @ parameters
    weight = own * np.minimum(1.0, HUBER * sigma / np.maximum(np.abs(error), 1e-300))
    psi = weight * error
    products, pairs = _autocovariance(rows, psi, own)
    return JointMoments(
        fitted=data.T @ (weight[:, None] * data),
        scored=data[some].T @ data[some],
        all=data.T @ data,
        count=float(own.sum()),
        scored_count=float(some.sum()),
        all_count=float(len(rows)),
        squares=float(psi @ psi),
        products=products,
        pairs=pairs,
        outliers=float((own & (weight < 1)).sum()),
    )


def _autocovariance(rows: Rows, psi: Array, own: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Sum products at lags 0.., within gap-free stretches; rows at rest count as absent."""
    lags = round(LONGEST_LAG / rows.step) + 1
    products, pairs = np.zeros(lags), np.zeros(lags)
    for stretch in rows.stretches():
        for values, target in ((psi[stretch], products), (own[stretch].astype(float), pairs)):
            size = fft.next_fast_len(2 * len(values), real=True)
            spectrum = np.abs(fft.rfft(values, size)) ** 2
            both = fft.irfft(spectrum, size)[: min(lags, len(values))]
            target[: len(both)] += both
    return products, np.round(pairs)


def score_scatter(rows: Rows, memory: Sequence[Array]) -> tuple[Array, ...]:
    """Return, a joint, the sum over t, t' of x(t) c(t - t') x(t')', (P_i, P_i).

    memory: each joint's autocovariance c by lag (L_i,), Nm^2. This is the covariance of the sum of
    columns times errors when the errors remember: Newey and West 1987, with the lagged products of the
    columns kept exact and only the error's autocovariance estimated.
    """
    found = []
    for i, covariance in enumerate(memory):
        matrix = np.zeros((rows.columns[i].shape[1],) * 2)
        for stretch in rows.stretches():
            x = rows.columns[i][stretch] * rows.moving[stretch, i : i + 1]
            matrix += x.T @ _spread(x, covariance)
        found.append((matrix + matrix.T) / 2)
    return tuple(found)


def _spread(x: Array, covariance: Array) -> Array:
    """Convolve columns (T, P) with a symmetric sequence given by its lags 0.. (L,)."""
    size = fft.next_fast_len(len(x) + len(covariance), real=True)
    around = np.zeros(size)
    around[: len(covariance)] = covariance
    around[size - len(covariance) + 1 :] = covariance[:0:-1]
    spectrum = fft.rfft(x, size, axis=0) * fft.rfft(around)[:, None]
    return np.asarray(fft.irfft(spectrum, size, axis=0)[: len(x)], np.float64)
