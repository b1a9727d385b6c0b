"""What a row tells beside those before it: residuals remember, so rows are scaled and predicted, not counted.

A slow residual says much about what is fast, and little about what is as slow. Generalised least squares
(Aitken 1936) weighs each by the noise at its own pace: rows of a joint are divided by their scale, and from
each the best prediction from those before is taken off, of columns and torque alike.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from .segments import stretches

Array = NDArray[np.float64]

#: Kinds of rows: free motion, passing through zero speed, at rest.
FREE, ZERO, REST = 0, 1, 2
#: Rows that a row is predicted from at most: 0.7 s where rows are made at 15 Hz.
ORDER = 40
#: Independent rows that an order needs at least, so that the prediction is no fit to these rows.
_ENOUGH = 25
#: Of a row's variance, taken as white: what the filter cuts off would otherwise be known without noise.
FLOOR = 0.02


def correlation_of(series: Sequence[Array]) -> Array:
    """Return the autocorrelation (O + 1,) of scaled residuals (n,) of some runs, zero where left out.

    With its floor; O is ORDER, or as many rows as so few can tell.
    """
    order = min(ORDER, sum(int(np.count_nonzero(x)) for x in series) // _ENOUGH)
    sums = np.zeros(order + 1)
    for x in series:
        for k in range(min(order + 1, len(x))):
            sums[k] += x[k:] @ x[: len(x) - k]
    found = sums / sums[0] if sums[0] > 0 else np.eye(1, order + 1)[0]
    found[0] += FLOOR
    return np.asarray(found, np.float64)


def predictors(correlation: Array) -> tuple[Array, Array]:
    """Return coefficients (O + 1, O) of the best prediction from m rows before, and its error's rms (O + 1,).

    By Durbin's recursion (1960). correlation (O + 1,): as of `correlation_of`.
    """
    r, order = correlation, len(correlation) - 1
    table, rms = np.zeros((order + 1, max(order, 1))), np.empty(order + 1)
    error = float(r[0])
    rms[0] = np.sqrt(error)
    for m in range(1, order + 1):
        before = table[m - 1, : m - 1]
        reflection = (r[m] - before @ r[m - 1 : 0 : -1]) / error
        table[m, : m - 1] = before - reflection * before[::-1]
        table[m, m - 1] = reflection
        error *= 1 - reflection**2
        rms[m] = np.sqrt(error)
    return table, rms


def root(
    time: Array, sigma: Array, kind: NDArray[np.int64], correlation: Array, step: float
) -> sparse.csr_array:
    """Return the matrix (n, n) that makes rows of a joint independent and of unit variance.

    time (n,) s; sigma (n,): each row's scale, Nm; kind (n,): as of `grams.regime`; step: s between rows, over
    more than which nothing is predicted. A whole rest counts as one row: there friction is anything. What a
    passage through zero speed leaves says nothing about the motion after it, which goes on from before it.
    """
    n = len(time)
    table, rms = predictors(correlation)
    order = min(len(rms) - 1, n - 1)
    known, away = (
        np.zeros(n, np.int64),
        np.zeros(n, np.int64),
    )  # rows that predict this one; or one, so far away
    weight = 1 / sigma
    for part in stretches(kind == REST):
        weight[part] /= np.sqrt(part.stop - part.start)
    cuts = np.flatnonzero((np.diff(kind) != 0) | (np.diff(time) > 1.5 * step)) + 1
    last = -n  # of free motion
    for a, b in pairwise([0, *cuts.tolist(), n]):
        if kind[a] == REST or (a > 0 and time[a] - time[a - 1] > 1.5 * step):
            last = -n
        if kind[a] != REST:
            known[a:b] = np.minimum(np.arange(b - a), order)
        if kind[a] == FREE:
            away[a] = a - last if a - last <= order else 0
            last = b - 1
    part = np.where(away > 0, correlation[away], 0.0) / correlation[0]
    moves = kind != REST
    weight[moves] /= (rms[known] * np.sqrt(1 - part**2))[moves]
    bands: list[Any] = [weight]
    for k in range(1, order + 1):
        before = -np.where(known[k:] >= k, table[known[k:], k - 1], np.where(away[k:] == k, part[k:], 0.0))
        bands.append(before * weight[k:] * sigma[k:] / sigma[:-k])
    return sparse.csr_array(sparse.diags(bands, [-k for k in range(order + 1)], shape=(n, n)))
