"""The fast band, where ripple lives: what the low-pass takes away, sample by sample.

Ripple turns with the motor, so at ordinary speeds it is far above the band in which friction and rigid body
are seen. There the torque is noise and ripple alone, and a sample at any rate knows the motor's angle.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

from ..identify.kernel import segments
from ..identify.rows import GAP

Array = NDArray[np.float64]

#: s and rad/s: steps of friction at reversals are fast, too; such samples say nothing of ripple.
_AFTER_REVERSAL, _SLOW = 0.2, 0.03


@dataclass(frozen=True)
class Fast:
    """High-passed samples of a recording, moving ones: time[j] (m,) s and data[j] (m, C + 1) of each joint.

    The first C columns are ripple's, the last the torque (Nm).
    """

    time: tuple[Array, ...]
    data: tuple[Array, ...]


def fast_band(
    time: Array, torque: Array, columns: Sequence[Array], qd: Array, since: Array, cutoff: float
) -> Fast:
    """High-pass torque (T, N) and ripple columns (each (T, N)) at cutoff (Hz), forth and back."""
    both = np.stack([*columns, torque], axis=2)  # (T, N, C + 1)
    passed = np.zeros_like(both)
    good = (since > _AFTER_REVERSAL) & (np.abs(qd) > _SLOW)
    rate = 1 / float(np.median(np.diff(time)))
    sections = butter(2, min(2 * cutoff / rate, 0.9), "highpass", output="sos")
    for stretch in segments(time, GAP / rate):
        if stretch.stop - stretch.start > 30:
            passed[stretch] = sosfiltfilt(sections, both[stretch], axis=0)
        else:
            good[stretch] = False
    joints = range(torque.shape[1])
    return Fast(
        tuple(time[good[:, j]] for j in joints),
        tuple(passed[good[:, j], j].astype(np.float32) for j in joints),
    )


def noise(runs: Sequence[Fast], j: int) -> float:
    """Return the variance of joint j's fast torque (Nm^2) times the samples per independent one.

    Robust, and with what the ripple columns explain taken off.
    """
    data = np.concatenate([r.data[j] for r in runs]).astype(float)
    if len(data) < 200:
        return np.inf
    coefficients = np.linalg.lstsq(data[:, :-1], data[:, -1], rcond=None)[0]
    rest = data[:, -1] - data[:, :-1] @ coefficients
    middle = 1.4826 * float(np.median(np.abs(rest)))
    rest = np.clip(rest, -4 * middle, 4 * middle)
    lags = [float(np.mean(rest[k:] * rest[:-k])) for k in range(1, 20)]
    variance = float(np.mean(rest**2))
    return max(variance + 2 * max(sum(x for x in lags), 0.0), variance, 1e-12)


def gram(fast: Fast, j: int, span: tuple[float, float], variance: float) -> Array:
    """Return the weighted Gram matrix (C + 1, C + 1) of joint j between two times (s)."""
    inside = (fast.time[j] >= span[0]) & (fast.time[j] < span[1])
    data = fast.data[j][inside].astype(float)
    return np.asarray(data.T @ data / variance, np.float64)
