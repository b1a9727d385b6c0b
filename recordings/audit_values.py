"""Values that cannot be: not finite, or beyond what any UR arm can do."""

import numpy as np

from .channels import FIELDS, POSITION
from .recording import BoolArray, FloatArray, Recording
from .report import Finding, Quantity, rows_finding

MOST_BAD = 0.1
"""Share of bad rows above which an optional channel goes, instead of the rows."""

_NEEDED = ("timestamp", "q", "current")


def without_hopeless_channels(recording: Recording) -> tuple[Recording, list[Finding]]:
    """Leave out optional channels that are bad in more than a tenth of the rows."""
    findings = []
    for name in recording.arrays():
        share = float(np.mean(_bad(recording, name))) if len(recording) else 0.0
        if name not in _NEEDED and name != "qd" and share > MOST_BAD:
            numbers = {"share": Quantity(share, "1")}
            text = f"{FIELDS[name].name} is missing or absurd in {share:.0%} of the rows and is not used"
            findings.append(Finding("channel_unusable", "note", text, numbers=numbers))
            recording = recording.without([name])
    return recording, findings


def not_finite(recording: Recording) -> tuple[BoolArray, list[Finding]]:
    """Rows with an empty cell, NaN or infinity in any channel, (T,)."""
    bad = np.zeros(len(recording), bool)
    for value in recording.arrays().values():
        bad |= _any_column(~np.isfinite(value))
    text = "{n} with empty or non-finite cells"
    return bad, [rows_finding("not_finite", recording, bad, text)] if bad.any() else []


def absurd(recording: Recording) -> tuple[BoolArray, list[Finding]]:
    """Rows with a value beyond the physical limit of its channel, (T,), one finding a channel."""
    bad = np.zeros(len(recording), bool)
    findings = []
    for name, value in recording.arrays().items():
        over = _over(name, value)
        new = _any_column(over)
        if new.any():
            channel = FIELDS[name]
            joints = _joints(over) if channel.width == 0 else ()
            text = f"{{n}} where |{channel.name}| is beyond {channel.limit:.4g} {channel.unit}"
            findings.append(rows_finding("absurd", recording, new, text, joints=joints))
        bad |= new
    return bad, findings


def _bad(recording: Recording, name: str) -> BoolArray:
    value = recording.arrays()[name]
    return _any_column(~np.isfinite(value) | _over(name, value))


def _over(name: str, value: FloatArray) -> BoolArray:
    over = np.abs(value) > FIELDS[name].limit
    if FIELDS[name].unit == POSITION.unit and over.shape[-1] == 6:
        over[:, -1] = np.abs(value[:, -1]) > 100 * FIELDS[name].limit  # the last joint may turn without end
    return over


def _any_column(bad: BoolArray) -> BoolArray:
    return bad if bad.ndim == 1 else np.asarray(bad.any(axis=1))


def _joints(over: BoolArray) -> tuple[int, ...]:
    return tuple((np.flatnonzero(over.any(axis=0)) + 1).tolist())
