"""Rows that cannot follow one another: no arm moves, accelerates or changes its current like that."""

import numpy as np
from scipy.ndimage import median_filter

from .audit_time import GAP_STEPS
from .channels import MAX_ACCELERATION, MAX_CURRENT
from .recording import BoolArray, FloatArray, Recording
from .report import Finding, Quantity, bad_ranges, rows_finding

SIGMAS = 12.0
LATE = 2.0
"""Sample periods by which a row may be early or late: host-side recorders repeat and miss samples."""

SHORTEST = 3
"""Rows that must follow one another before they vouch for each other."""

RESOLUTION = 1e-3
"""rad; ten steps of a table with four decimals."""

_MAD = 1.4826  # median absolute deviation to standard deviation, normal distribution


def jumps(recording: Recording, trust_speed: bool) -> tuple[BoolArray, list[Finding]]:
    """Rows that neither neighbour vouches for, (T,).

    Two neighbours vouch for each other when the step in position is what the speed says, within noise (12
    robust standard deviations), the acceleration no arm exceeds, and two periods of jitter. The speed is `qd`
    if `trust_speed`, else the running median of the difference quotient. Runs of fewer than three such rows
    are dropped; between two longer runs a jump is noted. Rows: finite, within limits, in order of time.
    """
    if len(recording) < SHORTEST:
        return np.zeros(len(recording), bool), []
    step = np.diff(recording.timestamp)
    near = step <= GAP_STEPS * np.median(step)
    fits = _fits(recording, step, trust_speed)
    run = np.r_[0, np.cumsum(~(fits & near))]
    bad = np.bincount(run)[run] < SHORTEST
    findings = []
    if bad.any():
        text = "{n} that do not follow from the rows around: corrupt, or torn from another motion"
        findings.append(rows_finding("torn_rows", recording, bad, text))
    broken = np.flatnonzero(~fits & near & ~bad[1:] & ~bad[:-1])
    return bad, findings + [_jump(recording, int(k)) for k in broken[:1] if len(broken)]


def _fits(recording: Recording, step: FloatArray, trust_speed: bool) -> BoolArray:
    moved = np.diff(recording.q, axis=0)  # (T-1, N)
    speed = _speed(recording, step[:, None], moved, trust_speed)
    error = moved - speed * step[:, None]
    noise = _MAD * np.median(np.abs(error - np.median(error, axis=0)), axis=0)
    late = LATE * np.median(step) * _around(np.abs(speed))
    allowed = SIGMAS * noise + late + MAX_ACCELERATION * step[:, None] ** 2 / 2 + RESOLUTION
    return np.asarray((np.abs(error) <= allowed).all(axis=1))


def _speed(recording: Recording, step: FloatArray, moved: FloatArray, trust_speed: bool) -> FloatArray:
    """Mean speed over each step, (T-1, N)."""
    if trust_speed and recording.qd is not None:
        return np.asarray((recording.qd[1:] + recording.qd[:-1]) / 2)
    return _around(moved / step)


def _around(value: FloatArray) -> FloatArray:
    """Give the running median over nine samples, which a few corrupt rows cannot move."""
    return np.asarray(median_filter(value, size=(9, 1), mode="nearest"))


def _jump(recording: Recording, k: int) -> Finding:
    moved = np.abs(recording.q[k + 1] - recording.q[k])
    joint = int(np.argmax(moved))
    t0, t1 = recording.timestamp[k], recording.timestamp[k + 1]
    text = f"position jumps by {moved[joint]:.3g} rad in {t1 - t0:.3g} s: two recordings in one file?"
    return Finding(
        "jump", "note", text, "split the file there if these are two motions", (joint + 1,),
        ((int(recording.rows[k]), int(recording.rows[k + 1])),), ((float(t0), float(t1)),),
        {"jump": Quantity(float(moved[joint]), "rad")},
    )  # fmt: skip


def spikes(recording: Recording) -> list[Finding]:
    """Note rows in which a current leaves and comes back within one sample, by a tenth of what any drive can.

    They stay: when an arm stops at once, or is struck, the drives do just that for a sample.
    """
    if len(recording) < SHORTEST:
        return []
    change = np.diff(recording.current, axis=0)
    up, down = change[:-1], -change[1:]
    size = np.where(up * down > 0, np.minimum(np.abs(up), np.abs(down)), 0.0)
    noise = _MAD * np.median(np.abs(change), axis=0)
    spike = size > np.maximum(SIGMAS * noise, MAX_CURRENT / 10)
    rows = np.r_[False, spike.any(axis=1), False]
    if not rows.any():
        return []
    joints = tuple((np.flatnonzero(spike.any(axis=0)) + 1).tolist())
    text = (
        f"current spike of one sample, up to {size.max():.3g} A: a sudden stop, a contact, or a corrupt value"
    )
    times = recording.timestamp[rows].tolist()
    return [
        Finding(
            "current_spike", "note", text, "leave the interval out if nothing stopped or struck the arm",
            joints, bad_ranges(recording, rows), tuple((t, t) for t in times),
            {"largest": Quantity(float(size.max()), "A")},
        )
    ]  # fmt: skip
