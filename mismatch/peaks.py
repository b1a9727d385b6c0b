"""Whether dry friction has a peak at slow speeds in a model's fit, or only starts gently.

Smooth signs of several widths, some of them negative, bend like a peak of Stribeck's; and a peak beside a
wide sign bends like a start that is sharper than a smooth sign's. The curve as a whole tells which it is.
"""

from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

from ..codegen.columns import columns
from .columns import Column, Space

Array = NDArray[np.float64]

#: rad/s; speeds at which the curve is looked at: from creeping to where it has ended.
_SLOWEST, _FASTEST, _POINTS = 1e-4, 2.0, 120
#: Terms of friction that change its level with speed and no more, beside those of a gentle sign.
DRY = ("coulomb", "stribeck")


def peak(
    space: Space, theta: Array, joint: int, terms: Sequence[str] = DRY, slowest: float = _SLOWEST
) -> float:
    """Return how far (Nm) some terms of a joint and its gentle signs rise, together, above their end.

    theta (P,): a fit. Only speeds above `slowest`, rad/s, count.
    """
    own = [(k, c) for k, c in enumerate(space.own) if c.term in terms or c.soft]
    curve = np.sum([theta[space.own_index(joint, k)] * _shape(c) for k, c in own], axis=0)
    return float(max(curve[_speeds() >= slowest].max() - curve[-1], 0.0))


@cache
def _speeds() -> Array:
    return np.geomspace(_SLOWEST, _FASTEST, _POINTS)


@cache
def _shape(column: Column) -> Array:
    """Return a column's torque (S,) at the speeds."""
    qd, none = _speeds()[:, None], np.zeros((_POINTS, 1))
    found = columns(column.term, column.value, none, qd, none, none, np.ones(_POINTS))
    return np.asarray(found[column.parameter][:, 0])
