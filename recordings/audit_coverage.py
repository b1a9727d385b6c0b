"""What a recording can show at all: joints, motion, length, rate. Notes, and refusal when nothing is left."""

import numpy as np

from .recording import Recording
from .report import Finding, Quantity

FEWEST = 10
SHORT = 2.0
"""s; shorter than one motion."""

SLOW_RATE = 20.0
"""Hz; below this accelerations are not seen."""

MOVES = 0.01
"""rad; range of a joint that moves."""

MOST_DROPPED = 0.5

_USEFUL = {"qd": "speeds are derived from actual_q", "joint_temperatures": "warming cannot be told from wear"}


def coverage(recording: Recording, rows_read: int) -> list[Finding]:
    """Judge what is left of `rows_read` rows."""
    left = _left(recording, rows_read)
    if any(f.severity == "refuse" for f in left):
        return left
    return [*left, *_channels(recording), *_motion(recording), *_length(recording)]


def _left(recording: Recording, rows_read: int) -> list[Finding]:
    kept = len(recording)
    numbers = {"kept": Quantity(kept, "1"), "read": Quantity(rows_read, "1")}
    if kept < FEWEST:
        text = f"only {kept} of {rows_read} rows can be used"
        return [Finding("too_few_rows", "refuse", text, "record again", numbers=numbers)]
    if rows_read - kept > MOST_DROPPED * rows_read:
        text = f"{rows_read - kept} of {rows_read} rows are bad: what is left cannot be trusted"
        return [Finding("mostly_bad", "refuse", text, "record again", numbers=numbers)]
    return []


def _channels(recording: Recording) -> list[Finding]:
    findings = []
    if recording.joints < 6:
        text = f"{recording.joints} joints are recorded; the others are taken as rigid"
        findings.append(Finding("missing_joints", "note", text, "record all six for a whole arm"))
    if recording.qd is None:
        text = f"no actual_qd: {_USEFUL['qd']}"
        findings.append(Finding("missing_channel", "note", text, "record actual_qd for better speeds"))
    if recording.ignored:
        text = f"columns of incomplete channels are not used: {', '.join(recording.ignored)}"
        findings.append(Finding("incomplete_channel", "note", text, "record all joints of a channel"))
    return findings


def _motion(recording: Recording) -> list[Finding]:
    spans = np.ptp(recording.q, axis=0)
    moving = tuple((np.flatnonzero(spans > MOVES) + 1).tolist())
    numbers = {f"range_{j + 1}": Quantity(float(s), "rad") for j, s in enumerate(spans)}
    if not moving:
        text = "no joint moves: one pose shows gravity and offset, not friction or inertia"
        return [Finding("single_pose", "note", text, "add recordings with motion", numbers=numbers)]
    if len(moving) == 1 and recording.joints > 1:
        text = f"only joint {moving[0]} moves: it alone can be told about"
        remedy = "add recordings in which the other joints move"
        return [Finding("one_joint_moving", "note", text, remedy, moving, numbers=numbers)]
    return []


def _length(recording: Recording) -> list[Finding]:
    findings = []
    if recording.duration < SHORT:
        text = f"only {recording.duration:.2g} s long"
        numbers = {"duration": Quantity(recording.duration, "s")}
        findings.append(Finding("short", "note", text, "record longer", numbers=numbers))
    rate = 1 / float(np.median(np.diff(recording.timestamp)))
    if rate < SLOW_RATE:
        text = f"{rate:.3g} Hz is too slow to see accelerations"
        numbers = {"rate": Quantity(rate, "Hz")}
        findings.append(Finding("slow_rate", "note", text, "record at 100 Hz or more", numbers=numbers))
    return findings
