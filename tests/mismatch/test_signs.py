"""The smooth sign along samples is the terms' own, and its slope the slope of it."""

import numpy as np
import pytest
import sympy as sp

from residuum.mismatch.signs import sign, slope
from residuum.symbolic.terms import smooth_sign

X = np.array([-200.0, -0.3, -1e-6, 0.0, 1e-6, 0.5, 3.0, 200.0])


@pytest.mark.parametrize("width", [1e-4, 0.5])
def test_it_is_the_terms_smooth_sign(width) -> None:
    exact = [float(smooth_sign(sp.Rational(x), sp.Rational(width))) for x in X]
    np.testing.assert_allclose(sign(X, width), exact, rtol=1e-14)


@pytest.mark.parametrize("width", [1e-4, 0.5])
def test_its_slope_is_that_of_finite_differences(width) -> None:
    away = X[np.abs(X) > 1e-3]
    step = 1e-6 * np.abs(away)
    found = (sign(away + step, width) - sign(away - step, width)) / (2 * step)
    np.testing.assert_allclose(slope(away, width), found, rtol=1e-3, atol=1e-9)
    assert slope(np.zeros(1), width) == pytest.approx(1 / width)
    np.testing.assert_array_equal(slope(X, width), slope(-X, width))
