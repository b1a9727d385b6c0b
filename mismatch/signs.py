"""The terms' smooth sign along samples, in NumPy."""

from collections.abc import Callable
from functools import cache

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from ..symbolic.terms import smooth_sign

Array = NDArray[np.float64]


def sign(x: Array, width: float) -> Array:
    """Return the smooth sign of samples (any shape), one half at `width`, which has their unit."""
    return np.asarray(_compiled()(x, width), np.float64)


@cache
def _compiled() -> Callable[[Array, float], Array]:
    """Return the smooth sign in NumPy."""
    x, width = sp.Symbol("x", real=True), sp.Symbol("width", positive=True)
    found: Callable[[Array, float], Array] = sp.lambdify((x, width), smooth_sign(x, width), "numpy")
    return found
