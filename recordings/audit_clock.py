"""Delay between the clock of the motion and that of the current."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from .recording import BoolArray, FloatArray, Recording
from .report import Finding, Quantity
from .speed import speeds

FARTHEST = 0.1
"""s; delays are sought up to this, either way."""

MOST_ROWS = 20_000
BLOCKS = 10
SIGMAS = 4.0

SLOW = 0.02
"""rad/s over which Coulomb friction turns its sign in the model of the current."""

LEAST_MOTION = 0.2
"""rad; a joint with less range says nothing about delay."""

SHARP = 0.005
"""s; standard deviation of a delay that is worth comparing with that of other joints."""

MODEL_ERROR = 0.01
"""s; friction and elasticity that the simple model of the current lacks pose as delays up to about this."""


@dataclass(frozen=True)
class Delay:
    """Delay of the current behind the motion, s, with its standard deviation."""

    value: float
    std: float


def clock(recording: Recording) -> list[Finding]:
    """Note a delay of current behind motion when the joints that move agree on it.

    For each joint the current is fitted with gravity and inertia (`target_current` if recorded, else
    harmonics of the arm's angles and the acceleration), Coulomb and viscous friction, all shifted in time.
    The shift of least error counts; its uncertainty is the jackknife over ten blocks. One joint alone is not
    enough: its elasticity or friction would pose as a clock. Timestamps must increase.
    """
    part = recording.take(slice(0, MOST_ROWS))
    found = {j + 1: d for j in range(part.joints) if (d := joint_delay(part, j)) is not None}
    delays = {j: d for j, d in found.items() if d.std < SHARP}
    if len(delays) < 2:
        return []
    both = combine(list(delays.values()))
    step = float(np.median(np.diff(part.timestamp)))
    if abs(both.value) < max(SIGMAS * both.std, step, MODEL_ERROR):
        return []
    way = "behind" if both.value > 0 else "ahead of"
    text = f"currents lag {way} the motion by {1e3 * abs(both.value):.1f} ms (+- {1e3 * both.std:.1f} ms)"
    numbers = {"delay": Quantity(both.value, "s"), "std": Quantity(both.std, "s")}
    remedy = "let the fit estimate a time delay, or record all channels from one source"
    return [
        Finding(
            "clock_offset",
            "note",
            text.replace("lag ahead", "are ahead"),
            remedy,
            tuple(delays),
            numbers=numbers,
        )
    ]


def combine(delays: list[Delay]) -> Delay:
    """Weighted mean; when the delays scatter by more than they should, its deviation grows with that."""
    value = np.array([d.value for d in delays])
    weight = 1 / np.array([d.std for d in delays]) ** 2
    mean = float(np.sum(weight * value) / weight.sum())
    excess = float(np.sum(weight * (value - mean) ** 2)) / max(1, len(delays) - 1)
    return Delay(mean, float(np.sqrt(max(1.0, excess) / weight.sum())))


def joint_delay(recording: Recording, joint: int) -> Delay | None:
    """Delay seen by one joint, or None when it does not move enough or the best shift is at the border."""
    if np.ptp(recording.q[:, joint]) < LEAST_MOTION or recording.duration < 20 * FARTHEST:
        return None
    time = recording.timestamp
    features = _features(recording, joint)
    inside = (time > time[0] + FARTHEST) & (time < time[-1] - FARTHEST)
    step = max(float(np.median(np.diff(time))), 0.004)
    half = int(FARTHEST / step)
    shifts = np.asarray(step * np.arange(-half, half + 1), np.float64)
    if inside.sum() < 20 * features.shape[1] or half < 2:
        return None
    current = recording.current[inside, joint]
    errors = np.array(
        [_squares(time, features, inside, current, s) for s in shifts], np.float64
    )  # (S, BLOCKS)
    total = errors.sum(axis=1)
    whole = _minimum(shifts, total)
    left_out = [_minimum(shifts, total - errors[:, b]) for b in range(BLOCKS)]
    if whole is None or None in left_out:
        return None
    spread = np.array([v for v in left_out if v is not None]) - whole
    std = float(np.sqrt((BLOCKS - 1) / BLOCKS * np.sum(spread**2)))
    return Delay(whole, max(std, 1e-4))


def _features(recording: Recording, joint: int) -> FloatArray:
    speed = speeds(recording)
    qd = speed[:, joint]
    columns = [np.ones_like(qd), qd, np.tanh(qd / SLOW)]
    if recording.target_current is not None:
        return np.column_stack([*columns, recording.target_current[:, joint]])
    # gravity of an arm whose joints 2 to 4 are parallel goes with the sums of their angles
    lift = np.cumsum(recording.q[:, 1:4], axis=1).T if recording.joints > 1 else recording.q.T
    acceleration = np.gradient(speed, recording.timestamp, axis=0)
    return np.column_stack([*columns, acceleration, np.cos(lift).T, np.sin(lift).T])


def _squares(
    time: FloatArray, features: FloatArray, inside: BoolArray, current: FloatArray, shift: float
) -> FloatArray:
    """Sum of squared errors in each block, (BLOCKS,), with the features `shift` seconds late."""
    at = time[inside] - shift
    A = np.column_stack([np.interp(at, time, column) for column in features.T])
    error = current - A @ np.linalg.lstsq(A, current, rcond=1e-9)[0]
    return np.array([np.sum(part**2) for part in np.array_split(error, BLOCKS)], np.float64)


def _minimum(shifts: FloatArray, errors: npt.NDArray[np.floating[Any]]) -> float | None:
    """Shift of the least error by a parabola through three points; None at the border."""
    k = int(np.argmin(errors))
    if k in (0, len(shifts) - 1):
        return None
    left, mid, right = errors[k - 1 : k + 2]
    bend = left - 2 * mid + right
    return float(shifts[k] + (shifts[1] - shifts[0]) * (left - right) / (2 * bend)) if bend > 0 else None
