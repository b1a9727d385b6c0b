"""Between the points of a grid on which a nonlinear value stands."""

from collections.abc import Sequence

import numpy as np


def peak(values: Sequence[float], heights: Sequence[float]) -> tuple[float, float | None]:
    """Return where evidence (nats) over a grid of a nonlinear value peaks, and its standard deviation.

    A parabola through the best point and its neighbours, over the logarithm of the value.
    """
    k = int(np.argmax(heights))
    if len(values) < 3 or k in (0, len(values) - 1):
        return values[k], None
    x = np.log(np.asarray(values[k - 1 : k + 2]))
    bend, slope, _ = np.polyfit(x - x[1], np.asarray(heights[k - 1 : k + 2]) - heights[k], 2)
    if bend >= 0:
        return values[k], None
    at = float(np.clip(-slope / (2 * bend), x[0] - x[1], x[2] - x[1]))
    value = float(np.exp(x[1] + at))
    return value, value * float(np.sqrt(-1 / (2 * bend)))


def size_at_peak(values: Sequence[float], heights: Sequence[float], sizes: Sequence[float]) -> float:
    """Return the size, without its sign, at the value where evidence peaks (log-log between two points)."""
    at, _ = peak(values, heights)
    known = np.log(np.maximum(np.abs(sizes), 1e-12))
    return float(np.exp(np.interp(np.log(at), np.log(values), known)))
