"""Stretches as sums of windows are what each stretch's own columns would give."""

import numpy as np
import pytest
from scipy import sparse

from residuum.mismatch.matched import windows


@pytest.mark.parametrize("length", [1, 2, 3, 5])
@pytest.mark.parametrize("reach", [0, 3, 11])
def test_stretches_are_summed_from_windows(length, reach) -> None:
    """Whitening that reaches over none, one or three windows."""
    rng, n, width = np.random.default_rng(1), 47, 4
    bands = [rng.standard_normal(n - k) for k in range(reach + 1)]
    whiten = sparse.csr_array(sparse.diags(bands, [-k for k in range(reach + 1)], shape=(n, n)))
    columns, target = rng.standard_normal((n, 3)), rng.standard_normal(n)
    matrix, right = windows(whiten, columns, target, width).over(length)
    assert len(matrix) == len(right) == n // width - length + 1
    for k in range(len(matrix)):
        inside = np.zeros(n)
        inside[k * width : (k + length) * width] = 1.0
        shown = whiten @ (columns * inside[:, None])
        np.testing.assert_allclose(matrix[k], shown.T @ shown, atol=1e-9)
        np.testing.assert_allclose(right[k], shown.T @ target, atol=1e-9)
