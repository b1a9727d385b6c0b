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
    time: Array, sigma: Array, rest: NDArray[np.bool_], correlation: Array, step: float
) -> sparse.csr_array:
    """Return the matrix (n, n) that makes rows of a joint independent and of unit variance.

    time (n,) s; sigma (n,): each row's scale, Nm; rest (n,): at rest, where friction is anything and a
    whole rest counts as one row; step: s between rows, over more than which nothing is predicted.
    """
    n = len(time)
    table, rms = predictors(correlation)
    order = len(rms) - 1
    known = np.zeros(n, np.int64)  # rows before that predict this one
    weight = 1 / sigma
    for part in stretches(~rest):
        cuts = np.flatnonzero(np.diff(time[part]) > 1.5 * step) + 1 + part.start
        for a, b in pairwise([part.start, *cuts.tolist(), part.stop]):
            known[a:b] = np.minimum(np.arange(b - a), order)
    weight[~rest] /= rms[known[~rest]]
    for part in stretches(rest):
        weight[part] /= np.sqrt(part.stop - part.start)
    bands: list[Any] = [weight]
    offsets = [0]
    for k in range(1, min(order, n - 1) + 1):
        before = np.where(known[k:] >= k, -table[known[k:], k - 1], 0.0)
        bands.append(before * weight[k:] * sigma[k:] / sigma[:-k])
        offsets.append(-k)
    return sparse.csr_array(sparse.diags(bands, offsets, shape=(n, n)))
