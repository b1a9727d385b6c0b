"""Channels that stand still: dead, frozen for a while, or clipped at a limit."""

import numpy as np

from .recording import BoolArray, FloatArray, Recording
from .report import Finding, Quantity, rows_finding

RARE = 1e-3
"""Expected number, in the whole recording, of runs as long as the one found, below which it is no chance."""

FROZEN = 0.1
"""s; a shorter run of equal values harms no fit."""

CLIPPED = 5
"""Rows at the extreme value that make a clipped peak."""

MOVES = 0.01
"""rad; range of a joint that moves."""


def stuck(recording: Recording) -> tuple[BoolArray, list[Finding]]:
    """Rows in which the current of some joints is frozen while others go on, (T,), and dead channels.

    Currents carry noise, so equal neighbours are chance: a run of n of them is expected T p^(n-1) times, with
    p the share of equal neighbours in the rest of the channel. All channels frozen together at rest is a
    noise-free recording, not a fault, and is left alone.
    """
    bad = np.zeros(len(recording), bool)
    current = recording.current
    if len(recording) < 2 * CLIPPED:
        return bad, []
    dead = np.ptp(current, axis=0) == 0
    findings = _dead(recording, dead) if dead.any() and not dead.all() else []
    if dead.all():
        text = "no current ever changes: dead channels, power off, or a noise-free simulation at rest"
        moves = bool((np.ptp(recording.q, axis=0) > MOVES).any())
        findings = [Finding("stuck", "refuse" if moves else "note", text, "record with the robot powered on")]
    going_on = ~_frozen_rows(recording)
    for joint in np.flatnonzero(~dead):
        frozen = _frozen(current[:, joint], recording.timestamp)
        rows = frozen & (going_on | _at_extreme(current[:, joint]))
        if rows.any():
            findings.append(_finding(recording, int(joint), rows))
            bad |= rows
    return bad, findings


def _finding(recording: Recording, joint: int, rows: BoolArray) -> Finding:
    clipped = bool(_at_extreme(recording.current[:, joint])[rows].all())
    value = float(recording.current[rows, joint][0])
    kind = "saturated" if clipped else "stuck"
    text = f"{{n}} with actual_current {'clipped' if clipped else 'frozen'} at {value:.4g} A"
    return rows_finding(kind, recording, rows, text, joints=(joint + 1,))


def _dead(recording: Recording, dead: BoolArray) -> list[Finding]:
    findings = []
    for joint in np.flatnonzero(dead).tolist():
        value = float(recording.current[0, joint])
        moves = bool(np.ptp(recording.q[:, joint]) > MOVES)
        findings.append(
            Finding(
                "stuck", "refuse" if moves else "note",
                f"actual_current is {value:.4g} A from beginning to end{' though the joint moves' * moves}",
                "record the channel again", (joint + 1,), numbers={"value": Quantity(value, "A")},
            )
        )  # fmt: skip
    return findings


def _frozen(value: FloatArray, time: FloatArray) -> BoolArray:
    """Mark runs of equal values too long for chance: long in time, or a few rows at the extreme value."""
    equal = np.r_[False, value[1:] == value[:-1]]
    start = np.flatnonzero(~equal)
    length = np.diff(np.r_[start, len(value)])
    longest = int(length.max())
    chance = (equal.sum() - (longest - 1) + 1) / (len(value) - longest + 2)
    rare = len(value) * chance ** (length - 1.0) < RARE
    seconds = time[start + length - 1] - time[start]
    extreme = _at_extreme(value)[start]
    hit = rare & (length >= CLIPPED) & ((seconds >= FROZEN) | extreme)
    return np.asarray(np.repeat(hit, length), np.bool_)


def _at_extreme(value: FloatArray) -> BoolArray:
    return np.asarray((value == value.max()) | (value == value.min()))


def _frozen_rows(recording: Recording) -> BoolArray:
    """Rows that equal the one before in every current and position, and the first of such a run, (T,)."""
    same = np.all(np.diff(np.c_[recording.q, recording.current], axis=0) == 0, axis=1)
    return np.asarray(np.r_[same, False] | np.r_[False, same], np.bool_)


def stalled_rows(recording: Recording) -> tuple[BoolArray, list[Finding]]:
    """Rows in which everything but time is frozen although the arm moves on meanwhile, (T,).

    The arm does when the position after the freeze is away from that in it by more than `MOVES`.
    """
    bad = np.zeros(len(recording), bool)
    if len(recording) < 2:
        return bad, []
    same = np.r_[False, np.all(np.diff(np.c_[recording.q, recording.current], axis=0) == 0, axis=1)]
    start = np.flatnonzero(~same)
    length = np.diff(np.r_[start, len(same)])
    after = np.minimum(start + length, len(same) - 1)
    away = np.abs(recording.q[after] - recording.q[start]).max(axis=1) > MOVES
    bad = np.repeat((length > 1) & away, length) & same
    if not bad.any():
        return bad, []
    text = "{n} that repeat the one before while the arm moves on: the recorder stalled"
    return bad, [rows_finding("stalled_rows", recording, bad, text)]
