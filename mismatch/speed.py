"""Speeds without their noise: near zero speed, noise would turn the sign of friction.

Noise of a speed is noise of the acceleration, too, and so of the columns that explain a torque: it makes
inertias too small and lends what is left to others (errors in variables). Recorded speeds and the slope of
recorded angles know it together better than either alone.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.signal import filtfilt

from ..identify.kernel import Filter, Kernel, batches, segments
from ..identify.rows import GAP, SAMPLES_PER_PERIOD
from ..recordings import Recording

Array = NDArray[np.float64]

#: Hz; speeds are smoothed this much, as far as the rate allows: the rows' filter does not notice.
FASTEST = 30.0
#: Samples a period that a value needs; a slope alone needs SAMPLES_PER_PERIOD.
_SAMPLES = 4
#: rad/s; slower, speeds are often reported as none. So many samples faster than that tell the noise.
_MOVES, _ENOUGH = 0.01, 50


def calm_speeds(recording: Recording) -> Array:
    """Return speeds (T, M), rad/s, without delay and what is faster than FASTEST: of `qd` and of `q`."""
    if recording.qd is None:
        kernel = Kernel(min(FASTEST, recording.rate / SAMPLES_PER_PERIOD))
        (slope,) = _smooth(recording, kernel, {1: recording.q})
        return slope
    kernel = Kernel(min(FASTEST, recording.rate / _SAMPLES))
    found, slope = _smooth(recording, kernel, {0: recording.qd, 1: recording.q})
    moves = np.abs(found) > _MOVES
    return found + _better(recording, slope - found, recording.qd - found, moves, kernel)


def _smooth(recording: Recording, kernel: Kernel, sources: Mapping[int, Array]) -> list[Array]:
    """Smooth samples (T, M), by the slope that is taken of them."""
    time, slopes = recording.timestamp, tuple(sources)
    filtering, found = Filter(kernel), [np.zeros_like(x) for x in sources.values()]
    for stretch in segments(time, GAP / recording.rate):
        own = time[stretch]
        pairs = [(x[stretch], y[stretch]) for x, y in zip(sources.values(), found, strict=True)]
        if len(own) < 4:
            continue
        for some, samples in batches(own, own, kernel):
            every = filtering.weights(own[samples], own[some], slopes)
            for weights, (values, out) in zip(every, pairs, strict=True):
                out[some] = weights @ values[samples]
    return found


def _better(
    recording: Recording, apart: Array, above: Array, moves: NDArray[np.bool_], kernel: Kernel
) -> Array:
    """Return what the slope of q says beyond a smoothed speed (apart), as far as it is known better.

    That is where it is slower than the two noises cross (Wiener's filter of two measurements). above: what
    the kernel took off the speed; all (T, M).
    """
    found, edge = np.zeros_like(apart), round(kernel.support * recording.rate)
    inner = [
        slice(s.start + edge, s.stop - edge)  # at ends kernels see one side only
        for s in segments(recording.timestamp, GAP / recording.rate)
        if s.stop - s.start > 2 * edge + _ENOUGH
    ]
    for j in range(apart.shape[1] if inner else 0):
        counts = np.concatenate([moves[s, j] for s in inner])
        below, beyond = (np.concatenate([x[s, j] for s in inner])[counts] for x in (apart, above))
        cross = _crossing(below, beyond, kernel.cutoff, recording.rate) if counts.sum() > _ENOUGH else 0.0
        kept = np.exp(-cross / recording.rate)
        for s in inner if cross > 0 else ():
            own = np.pad(apart[s, j], 1)  # from nothing, or the first sample would be believed
            found[s, j] = filtfilt([1 - kept], [1, -kept], own, padtype=None)[1:-1]  # 1 / (1 + (w/cross)^2)
    return found


def _crossing(apart: Array, above: Array, cutoff: float, rate: float) -> float:
    """Return below which frequency, rad/s, the slope of an angle is known better than the speed.

    apart (T,): their difference below a cutoff (Hz); above (T,): the speed beyond it. White noise of the
    speed is all of this and a part of that; the rest is the slope's, of the angle's noise and of imprecise
    stamps, and grows with frequency.
    """
    f, step = np.linspace(0.0, 2 * cutoff, 400, retstep=True)
    gain, share = 1 / (1 + (f / cutoff) ** 8), 2 * step / rate
    white, rising = (share * float(np.sum((2 * np.pi * f) ** k * gain**2)) for k in (0, 2))
    own = _variance(above) / (1 - 2 * share * float(np.sum(gain)) + white)
    angle = max(_variance(apart) - own * white, 0.0) / rising
    return float(np.sqrt(own / max(angle, 1e-9 * own, 1e-300)))


def _variance(noise: Array) -> float:
    """Return the variance of most of it, whatever the rest does."""
    return float((1.4826 * np.median(np.abs(noise))) ** 2)
