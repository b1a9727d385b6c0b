"""Positions against speeds: units, signs, swapped joints, contradictions.

Over windows of a fifth of a second, the change of q_i is compared with the integral of a speed. The share of
windows in which the two agree is a robust number: corrupt rows and single contacts do not move it.
"""

from dataclasses import dataclass
from math import degrees

import numpy as np

from .channels import MAX_POSITION, MAX_SPEED
from .recording import FloatArray, Recording
from .report import Finding, Quantity

WINDOW = 0.2
"""s; long against sampling and filter delays (some 10 ms), short against a motion (seconds)."""

MOVED = 0.01
"""rad in a window; a hundred times the 1e-4 rad to which tables with four decimals resolve."""

ENOUGH = 10
"""Windows with motion below which nothing is said."""

CLOSE = 0.2
"""Relative difference up to which a window agrees: any unit, sign or joint mistaken misses it by far."""

GOOD, POOR = 0.8, 0.5
"""Share of agreeing windows above which all is well, and below which positions and speeds contradict."""

_BEYOND = 1e12
_RAD, _MILLI = degrees(1.0), 1000.0
_SCALES = (
    (_RAD, "positions are in degrees and speeds in rad/s", "multiply actual_q by pi/180"),
    (1 / _RAD, "speeds are in deg/s and positions in rad", "multiply the speeds by pi/180"),
    (_MILLI, "positions are in mrad and speeds in rad/s", "divide actual_q by 1000"),
    (1 / _MILLI, "timestamps are in ms, or speeds in mrad/s", "give seconds and rad/s"),
    (1e-6, "timestamps are in microseconds", "give seconds"),
    (1e-9, "timestamps are in nanoseconds", "give seconds"),
    (-1.0, "speeds have the opposite sign of the motion", "turn the sign of actual_qd or leave it out"),
)


@dataclass(frozen=True)
class Windows:
    """Change of position and integral of speed over W windows: both (W, N)."""

    moved: FloatArray
    integral: FloatArray

    def agreement(self, i: int, j: int, factor: float = 1.0) -> tuple[float, int]:
        """Share of windows with motion in which q_i changes by `factor` times the integral of qd_j."""
        x, y = self.moved[:, i], factor * self.integral[:, j]
        size = np.maximum(np.abs(x), np.abs(y))
        least = MOVED * max(1.0, abs(factor))  # factor > 1: positions in a finer unit
        moving = size > least
        count = int(moving.sum())
        agrees = np.abs(x - y)[moving] <= CLOSE * size[moving]
        return (float(agrees.mean()) if count else 1.0), count


def windows(recording: Recording, speed: FloatArray) -> Windows:
    """Cut a recording with increasing timestamps into windows of `WINDOW`, three samples at least.

    Windows that hold a gap, or values beyond all measure, are left out.
    """
    time, q = recording.timestamp, recording.q
    step = np.diff(time)
    median = float(np.median(step)) if len(step) else 0.0
    length = max(3, round(WINDOW / median)) if median > 0 else 3
    at = np.arange(0, len(time), length)
    if len(at) < 2:
        return Windows(np.empty((0, recording.joints)), np.empty((0, recording.joints)))
    with np.errstate(over="ignore", invalid="ignore"):
        area = step[:, None] * (speed[1:] + speed[:-1]) / 2
        integral = np.add.reduceat(area[: at[-1]], at[:-1], axis=0)
        moved = np.diff(q[at], axis=0)
        sound = (np.abs(moved) < _BEYOND).all(axis=1) & (np.abs(integral) < _BEYOND).all(axis=1)
    whole = np.diff(time[at]) < 3 * length * median
    return Windows(moved[whole & sound], integral[whole & sound])


def motion(recording: Recording) -> list[Finding]:
    """Judge units, signs, order and consistency of positions and speeds; finite rows in order of time."""
    if found := _absolute(recording):
        return found
    speed, label = (
        (recording.qd, "actual_qd") if recording.qd is not None else (recording.target_qd, "target_qd")
    )
    if speed is not None:
        found = _against(windows(recording, speed), recording.joints, label)
    return found or _target_order(recording)


def _absolute(recording: Recording) -> list[Finding]:
    """Degrees that show by size alone: arms do not turn that far, nor that fast."""
    q = recording.q[:, : max(1, min(recording.joints, 5))]
    numbers = {"median": Quantity(float(np.median(np.abs(q).max(axis=1))), "as recorded")}
    if numbers["median"].value > MAX_POSITION:
        unit, factor = ("degrees", "pi/180") if numbers["median"].value < 720 else ("mrad", "0.001")
        text = f"positions go to {numbers['median'].value:.0f}: these are {unit}, not rad"
        return [Finding("units", "refuse", text, f"multiply actual_q by {factor}", numbers=numbers)]
    if recording.qd is None or not np.any(fast := np.abs(recording.qd).max(axis=1) > MOVED):
        return []
    median = float(np.median(np.abs(recording.qd).max(axis=1)[fast]))
    if median <= MAX_SPEED:
        return []
    text = f"speeds go to {median:.0f}: these are deg/s or mrad/s, not rad/s"
    numbers = {"median": Quantity(median, "as recorded")}
    return [Finding("units", "refuse", text, "give actual_qd in rad/s or leave it out", numbers=numbers)]


def _against(cut: Windows, joints: int, label: str) -> list[Finding]:
    own = [cut.agreement(i, i) for i in range(joints)]
    wrong = [i for i, (share, count) in enumerate(own) if count >= ENOUGH and share < GOOD]
    if not wrong:
        return []
    explained = _scaled(cut, wrong) + _swapped(cut, wrong, joints, label)
    if explained:
        return explained
    return [_contradiction(i, own[i][0], label) for i in wrong if label == "actual_qd"]


def _scaled(cut: Windows, wrong: list[int]) -> list[Finding]:
    for factor, text, remedy in _SCALES:
        joints = tuple(i + 1 for i in wrong if _holds(cut.agreement(i, i, factor)))
        if joints:
            kind = "sign" if factor < 0 else "units"
            numbers = {"factor": Quantity(factor, "1")}
            return [Finding(kind, "refuse", text, remedy, joints, numbers=numbers)]
    return []


def _swapped(cut: Windows, wrong: list[int], joints: int, label: str) -> list[Finding]:
    pairs = [(i + 1, j + 1) for i in wrong for j in range(joints) if i != j and _holds(cut.agreement(i, j))]
    if not pairs:
        return []
    text = ", ".join(f"actual_q of joint {i} moves as {label} of joint {j} says" for i, j in pairs)
    involved = tuple(sorted({i for i, _ in pairs}))
    return [Finding("swapped_joints", "refuse", text, "put the columns in order, 0 the base", involved)]


def _holds(agreement: tuple[float, int]) -> bool:
    share, count = agreement
    return count >= ENOUGH and share >= GOOD


def _contradiction(i: int, share: float, label: str) -> Finding:
    text = f"{label} agrees with the change of actual_q in only {share:.0%} of the windows with motion"
    return Finding(
        "contradiction", "refuse" if share < POOR else "note", text,
        f"leave {label} out (speeds then come from positions), or mend the column that is wrong",
        (i + 1,), numbers={"agreement": Quantity(share, "1")},
    )  # fmt: skip


def _target_order(recording: Recording) -> list[Finding]:
    """Joints whose position sits on the target of another one all the time, and away from its own."""
    if recording.target_q is None:
        return []
    apart = np.array(
        [[np.median(np.abs(q - t)) for t in recording.target_q.T] for q in recording.q.T]
    )  # (N, N)
    best = apart.argmin(axis=1)
    pairs = [
        (i, int(j)) for i, j in enumerate(best)
        if i != j and best[j] == i and apart[i, j] < MOVED < apart[i, i] / 5
    ]  # fmt: skip
    if not pairs:
        return []
    text = ", ".join(f"actual_q of joint {i + 1} follows target_q of joint {j + 1}" for i, j in pairs)
    joints = tuple(i + 1 for i, _ in pairs)
    return [Finding("swapped_joints", "refuse", text, "put the columns in order, 0 the base", joints)]
