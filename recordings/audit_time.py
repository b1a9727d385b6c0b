"""Time that runs back, stands still, or leaves gaps."""

from bisect import bisect_left

import numpy as np

from .recording import BoolArray, FloatArray, Recording
from .report import Finding, Quantity, bad_ranges, rows_finding

GAP_STEPS = 5
"""A gap is a step of more than this many median steps: shorter ones are jitter of recorders on a PC."""

RESTART = 1.0
"""s; when time runs back for longer than this, the file holds two recordings."""

MOST_STALLED = 0.1
"""Share of rows with a repeated timestamp above which the clock is too coarse for the rate."""


def time_order(recording: Recording) -> tuple[BoolArray, list[Finding]]:
    """Rows to drop (T,) so that timestamps increase, as few as possible. Timestamps must be finite."""
    time = recording.timestamp
    step = np.diff(time)
    if np.all(step > 0):
        return np.zeros(len(time), bool), []
    repeated = np.r_[False, step == 0]
    same = _same_as_before(recording) & repeated
    keep = np.flatnonzero(~repeated)
    bad = repeated.copy()
    bad[keep] = ~_longest_increasing(time[keep])
    findings = [*_duplicates(recording, same), *_stalls(recording, repeated & ~same)]
    return bad, findings + _back(recording, bad & ~repeated)


def _duplicates(recording: Recording, same: BoolArray) -> list[Finding]:
    if not same.any():
        return []
    return [rows_finding("duplicate_rows", recording, same, "{n} that repeat the row before")]


def _stalls(recording: Recording, stalled: BoolArray) -> list[Finding]:
    if not stalled.any():
        return []
    share = float(stalled.mean())
    if share <= MOST_STALLED:
        text = "{n} with the timestamp of the row before and other values"
        return [rows_finding("time_stalls", recording, stalled, text)]
    text = f"time stands still in {share:.0%} of the rows while the values change"
    remedy = "record the controller's own timestamp at full resolution"
    rows = bad_ranges(recording, stalled)
    numbers = {"share": Quantity(share, "1")}
    return [Finding("time_stalls", "refuse", text, remedy, rows=rows, numbers=numbers)]


def _back(recording: Recording, bad: BoolArray) -> list[Finding]:
    if not bad.any():
        return []
    edges = np.flatnonzero(np.diff(np.r_[False, bad, False].astype(np.int8)))
    spans = [(int(a), int(b) - 1) for a, b in zip(edges[::2], edges[1::2], strict=True)]
    step = np.diff(recording.timestamp)
    usual = float(np.median(step[step > 0])) if np.any(step > 0) else 0.0
    longest = max(b - a + 1 for a, b in spans) * usual
    if longest <= RESTART:
        return [rows_finding("time_jumps", recording, bad, "{n} whose timestamps run back or leap ahead")]
    line = int(recording.rows[int(np.argmin(step)) + 1])
    text = f"time starts again at row {line}: the file holds more than one recording"
    return [Finding("time_restarts", "refuse", text, f"split the file before row {line}")]


def gaps(recording: Recording) -> list[Finding]:
    """Note steps of more than `GAP_STEPS` median steps; timestamps must increase."""
    time = recording.timestamp
    step = np.diff(time)
    if not len(step):
        return []
    wide = np.flatnonzero(step > GAP_STEPS * float(np.median(step)))
    if not len(wide):
        return []
    text = f"{len(wide)} gap{'s' if len(wide) > 1 else ''} in time, the longest {step.max():.3g} s"
    return [
        Finding(
            "gap", "note", text, "nothing is interpolated across; record without pauses if it matters",
            rows=tuple((int(recording.rows[k]), int(recording.rows[k + 1])) for k in wide),
            intervals=tuple((float(time[k]), float(time[k + 1])) for k in wide),
            numbers={"longest": Quantity(float(step.max()), "s")},
        )
    ]  # fmt: skip


def summary(recording: Recording) -> dict[str, Quantity]:
    """Duration, rate (one over the median step), and shortest and longest step."""
    step = np.diff(recording.timestamp)
    if not len(step):
        return {"duration": Quantity(0.0, "s")}
    median = float(np.median(step))
    return {
        "duration": Quantity(recording.duration, "s"),
        "rate": Quantity(1 / median if median > 0 else 0.0, "Hz"),
        "step_min": Quantity(float(step.min()), "s"),
        "step_median": Quantity(median, "s"),
        "step_p99": Quantity(float(np.quantile(step, 0.99)), "s"),
        "step_max": Quantity(float(step.max()), "s"),
    }


def _same_as_before(recording: Recording) -> BoolArray:
    same = np.ones(len(recording), bool)
    for value in recording.arrays().values():
        new = value[1:] != value[:-1]
        same[1:] &= ~(new if new.ndim == 1 else new.any(axis=1))
    same[:1] = False
    return same


def _longest_increasing(time: FloatArray) -> BoolArray:
    """Mark the members of a longest strictly increasing subsequence (patience sorting), (T,)."""
    tails: list[float] = []
    tail_at: list[int] = []
    before = np.full(len(time), -1)
    for k, value in enumerate(time.tolist()):
        place = bisect_left(tails, value)
        if place:
            before[k] = tail_at[place - 1]
        tails[place : place + 1] = [value]
        tail_at[place : place + 1] = [k]
    kept = np.zeros(len(time), bool)
    at = tail_at[-1] if tail_at else -1
    while at >= 0:
        kept[at] = True
        at = int(before[at])
    return kept
