"""Torques and currents from motion alone, with the generated code of a model."""

from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from ..recordings import Recording, speeds
from .kernel import Filter, Kernel, batches, segments
from .rows import GAP, REST, SAMPLES_PER_PERIOD

Array = NDArray[np.float64]


def required_torque(motion: Recording, observer: ModuleType, cutoff: float = 10.0, order: int = 4) -> Array:
    """Return the drive torque (T, N) in Nm that the motion needs: dp/dt - beta + terms.

    observer: a module of gen-model's observer.py. Only dp/dt is low-passed (zero-phase Butterworth, Hz);
    beta and friction are those of each sample, so that a reversal stays as sharp as it is. The recorded
    current is not read.
    """
    n = observer.DOF
    q, qd = motion.q[:, :n], speeds(motion)[:, :n]
    hot = motion.joint_temperatures
    temperature = None if hot is None else hot[:, :n]
    momentum = observer.momentum(q, qd)
    rate_of_change = np.zeros_like(momentum)
    time = motion.timestamp - motion.timestamp[0]
    rate = 1 / float(np.median(np.diff(time)))
    kernel = Kernel(min(cutoff, rate / SAMPLES_PER_PERIOD), order)
    filtering = Filter(kernel)
    for stretch in segments(time, GAP / rate):
        own = time[stretch]
        if len(own) < 3:
            continue
        for rows, samples in batches(own, own, kernel):
            slope = filtering.weights(own[samples], own[rows], (1,))[0]
            rate_of_change[stretch][rows] = slope @ momentum[stretch][samples]
    rigid: Array = rate_of_change - observer.beta(q, qd)
    along = {}
    if hasattr(observer, "STATES"):
        # Terms that remember go along time, gaps included, and carry what the rigid body needs.
        along = {"dt": np.diff(time, prepend=time[0] - 1 / rate), "carried": rigid}
    found: Array = rigid + observer.friction(q, qd, temperature=temperature, **along)
    return found


def predicted_current(motion: Recording, observer: ModuleType, cutoff: float = 10.0, order: int = 4) -> Array:
    """Return the motor currents (T, N) in A that the motion needs; see `required_torque`."""
    return np.asarray(required_torque(motion, observer, cutoff, order) / observer.GAINS, np.float64)


def score(
    motion: Recording, current: Array, predicted: Array, cutoff: float = 10.0, order: int = 4
) -> tuple[Array, Array]:
    """Return sums of squares (N,) of filtered error and filtered current, A^2, where any joint moves.

    Both current and predicted (T, N) pass the low-pass of the fit, so the root of their ratio is the
    held-out error as the fit states it.
    """
    time = motion.timestamp - motion.timestamp[0]
    rate = 1 / float(np.median(np.diff(time)))
    kernel = Kernel(min(cutoff, rate / SAMPLES_PER_PERIOD), order)
    n = predicted.shape[1]
    both = np.hstack([current[:, :n] - predicted, current[:, :n], np.abs(speeds(motion)[:, :n]) > REST])
    error, size = np.zeros(n), np.zeros(n)
    for stretch in segments(time, GAP / rate):
        own = time[stretch]
        at = np.arange(own[0] + kernel.support, own[-1] - kernel.support, 1 / (4 * kernel.cutoff))
        for rows, samples in batches(own, at, kernel):
            smooth = Filter(kernel).weights(own[samples], at[rows], (0,))[0] @ both[stretch][samples]
            moving = (smooth[:, 2 * n :] > 0.5).any(axis=1)
            error += np.sum(smooth[moving, :n] ** 2, axis=0)
            size += np.sum(smooth[moving, n : 2 * n] ** 2, axis=0)
    return error, size
