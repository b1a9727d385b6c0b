"""The smooth sign along samples is the terms' own."""

import numpy as np
import pytest
import sympy as sp

from residuum.mismatch.signs import sign
from residuum.symbolic.terms import smooth_sign

X = np.array([-200.0, -0.3, -1e-6, 0.0, 1e-6, 0.5, 3.0, 200.0])


@pytest.mark.parametrize("width", [1e-4, 0.5])
def test_it_is_the_terms_smooth_sign(width) -> None:
    exact = [float(smooth_sign(sp.Rational(x), sp.Rational(width))) for x in X]
    np.testing.assert_allclose(sign(X, width), exact, rtol=1e-14)
