"""Joint speeds of a recording: recorded ones, or those its positions imply."""

from typing import Literal

import numpy as np

from .recording import FloatArray, Recording


def speeds(recording: Recording) -> FloatArray:
    """Joint speeds (T, N), rad/s: the recorded `qd`, else the derivative of `q`.

    The derivative is the central difference for non-uniform time (second order; one-sided at the ends), so it
    has no phase lag; it is not smoothed, and its noise is that of `q` over the time step. Timestamps must
    increase (`audit.clean` sees to that). One sample has speed 0.

    Raises ValueError when a timestamp does not increase.
    """
    if recording.qd is not None:
        return recording.qd
    return derivative(recording.timestamp, recording.q)


def derivative(timestamp: FloatArray, value: FloatArray) -> FloatArray:
    """Zero-phase derivative of `value` (T, ...) by `timestamp` (T,); see `speeds`."""
    if np.any(np.diff(timestamp) <= 0):
        raise ValueError("timestamps must increase; clean the recording first")
    if len(timestamp) < 2:
        return np.zeros_like(value)
    order: Literal[1, 2] = 2 if len(timestamp) > 2 else 1
    return np.asarray(np.gradient(value, timestamp, axis=0, edge_order=order), np.float64)
