"""Speeds without their noise: near zero speed, noise would turn the sign of friction."""

import numpy as np
from numpy.typing import NDArray

from ..identify.kernel import Filter, Kernel, batches, segments
from ..identify.rows import GAP
from ..recordings import Recording

Array = NDArray[np.float64]


def smooth_speeds(recording: Recording, cutoff: float) -> Array:
    """Return speeds (T, M), rad/s, below a cutoff (Hz), without delay: `qd`, else the slope of `q`."""
    time, kernel = recording.timestamp, Kernel(cutoff)
    slope = 1 if recording.qd is None else 0
    source = recording.q if recording.qd is None else recording.qd
    filtering, found = Filter(kernel), np.zeros_like(source)
    for stretch in segments(time, GAP / recording.rate):
        own, values, out = time[stretch], source[stretch], found[stretch]
        if len(own) < 4:
            continue
        for some, samples in batches(own, own, kernel):
            (weights,) = filtering.weights(own[samples], own[some], (slope,))
            out[some] = weights @ values[samples]
    return found
