"""Matched filters: what columns that act in one stretch of time explain there, of every stretch at once.

Rows remember, so a whitened column lasts longer than its stretch. Windows of equal width are summed once,
each with those after it that it reaches, and stretches are sums of windows.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from .grams import Root

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Windows:
    """Normal equations of k columns in W windows: right (W, k), and band (D, W, k, k).

    band[d, w]: products of the columns of window w with those of window w + d.
    """

    band: Array
    right: Array

    def over(self, length: int) -> tuple[Array, Array]:
        """Return matrix (W - length + 1, k, k) and right side (.., k) of all stretches of so many windows."""
        right = _moving(self.right, length)
        matrix = np.zeros((*right.shape, right.shape[1]))
        for d in range(min(length, len(self.band))):
            some = _moving(self.band[d], length - d)[: len(right)]
            matrix += some + np.swapaxes(some, 1, 2) if d else some
        return matrix, right


def windows(whiten: Root, columns: Array, target: Array, width: int) -> Windows:
    """Sum windows of `width` rows; the rest of the rows, fewer than that, are left out.

    whiten (n, n): makes rows independent, a row from some before it; columns (n, k); target (n,): whitened.
    """
    n, k = columns.shape
    count = n // width
    rows = np.arange(count * width)
    place = (rows // width)[:, None] * k + np.arange(k)
    within = sparse.csr_array(
        (columns[: len(rows)].ravel(), (np.repeat(rows, k), place.ravel())), shape=(n, count * k)
    )
    shown = sparse.csr_array(whiten @ within)
    product = sparse.coo_array(shown.T @ shown)
    (w, a), (v, b) = divmod(product.row, k), divmod(product.col, k)
    later = v >= w
    band = np.zeros((1 + int(np.max(v - w, initial=0)), count, k, k))
    band[(v - w)[later], w[later], a[later], b[later]] = product.data[later]
    return Windows(band, np.asarray(shown.T @ target).reshape(count, k))


def _moving(x: Array, length: int) -> Array:
    """Return the sums of so many neighbours along the first axis."""
    total = np.concatenate([np.zeros((1, *x.shape[1:])), np.cumsum(x, axis=0)])
    return np.asarray(total[length:] - total[:-length], np.float64)
