"""Where foreign robots are told to go: trapezoids between points, pick and place, sines."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: s; a cycle of the controller. s; what smooths the corners of a trapezoid.
STEP, SMOOTH = 0.002, 0.05


def path(rng: np.random.Generator, seconds: float, home: Array) -> Array:
    """Return target angles (T, 6), rad, from home (6,)."""
    found = _sines(rng, seconds, home) if rng.random() < 0.5 else _moves(rng, seconds, home)
    width = round(SMOOTH / STEP) // 2
    window = np.hanning(2 * width + 1) / np.hanning(2 * width + 1).sum()
    padded = np.pad(found, ((width, width), (0, 0)), mode="edge")
    return np.stack([np.convolve(column, window, "valid") for column in padded.T], axis=1)


def _sines(rng: np.random.Generator, seconds: float, home: Array) -> Array:
    time, fastest = np.arange(round(seconds / STEP)) * STEP, rng.uniform(0.25, 0.5)
    found = np.zeros((len(time), len(home)))
    for j in range(len(home)):
        for k in (1, 2, 3):
            rate, size = rng.uniform(0.05, fastest), rng.uniform(0.1, 0.35) / k
            found[:, j] += size * np.sin(2 * np.pi * (rate * time + rng.random()))
    return np.asarray(home + (found - found[0]) * np.minimum(time / 3, 1)[:, None])


def _moves(rng: np.random.Generator, seconds: float, home: Array) -> Array:
    """Straight moves of all joints, or of one, with trapezoids of speed and rests between them."""
    count, at, here = round(seconds / STEP), 0, home.copy()
    spots = home + rng.uniform(-0.7, 0.7, (4, len(home))) if rng.random() < 0.5 else None
    found, k = np.tile(home, (count, 1)), 0
    while at < count:
        there = spots[k % 4] if spots is not None else home + rng.uniform(-0.8, 0.8, len(home))
        if spots is None and rng.random() < 0.3:
            there = np.where(np.arange(len(home)) == rng.integers(len(home)), there, here)
        share = _trapezoid(float(np.abs(there - here).max()), rng.uniform(0.15, 1.3), rng.uniform(0.6, 3.0))
        part = share[: count - at]
        found[at : at + len(part)] = here + part[:, None] * (there - here)
        found[at + len(part) :] = there
        at, here, k = at + len(part) + round(rng.uniform(0, 1.2) / STEP), there, k + 1
    return found


def _trapezoid(length: float, speed: float, acceleration: float) -> Array:
    """Return the share (T,) of a move that is done."""
    speed = min(speed, np.sqrt(length * acceleration))
    rise, whole = speed / acceleration, length / speed + speed / acceleration
    t = np.arange(int(whole / STEP) + 1) * STEP
    fall = length - 0.5 * acceleration * np.maximum(whole - t, 0) ** 2
    done = np.where(
        t < rise, 0.5 * acceleration * t**2, np.where(t < whole - rise, speed * (t - rise / 2), fall)
    )
    return np.asarray(done / length)
