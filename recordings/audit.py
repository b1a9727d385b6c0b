"""Audit a recording: say what is wrong with it, leave out the rows that are, refuse what would mislead."""

from collections.abc import Callable

import numpy as np

from .audit_clock import clock
from .audit_coverage import FEWEST, coverage
from .audit_jumps import jumps, spikes
from .audit_motion import motion
from .audit_stuck import stalled_rows, stuck
from .audit_time import gaps, summary, time_order
from .audit_values import absurd, not_finite, without_hopeless_channels
from .recording import BoolArray, Recording
from .report import AuditReport, Finding, row_ranges

RowCheck = Callable[[Recording], tuple[BoolArray, list[Finding]]]


def audit(recording: Recording) -> AuditReport:
    """Say what is wrong with a recording.

    Checks, in order: rows lost in reading; non-finite values; order of time; units and positions against
    speeds; physical limits; rows torn from elsewhere; frozen and clipped channels; what the motion can show;
    gaps; current spikes; delay between current and motion. Bad data raise nothing; `AuditReport.require`
    does.
    """
    return clean(recording)[1]


def clean(
    recording: Recording, motion_only: bool = False, with_clock: bool = True
) -> tuple[Recording, AuditReport]:
    """Audit, and give the recording without its bad rows and unusable optional channels.

    `motion_only`: say nothing about the measured currents (for recordings that were read without them).
    `with_clock` False: do not look for a delay of current behind motion (for later pieces of one file).
    When the verdict is "refuse", what is given is as far as cleaning came, and not to be used:
    `report.require()` raises InputError then.
    """
    rows_read = len(recording) + sum(len(d.rows) for d in recording.dropped)
    kept, findings = without_hopeless_channels(recording)
    findings = _lost(recording) + findings
    kept, findings = _drop(kept, findings, (not_finite, time_order))
    if not _refused(findings) and len(kept) >= FEWEST:
        kept, findings = _rows(kept, findings, motion_only)
    if not _refused(findings):
        findings += coverage(kept, rows_read)
    if not _refused(findings):
        findings += gaps(kept) + ([] if motion_only else spikes(kept))
        findings += clock(kept) if with_clock and not motion_only else []
    return kept, AuditReport(recording.name, tuple(findings), rows_read, len(kept), summary(kept))


def _rows(kept: Recording, findings: list[Finding], motion_only: bool) -> tuple[Recording, list[Finding]]:
    # units come first: in the wrong unit every row is absurd; medians judge them, which bad rows spare
    units = motion(kept)
    if _refused(units):
        return kept, findings + units
    contradicted = any(f.kind == "contradiction" for f in units)
    checks: tuple[RowCheck, ...] = (
        absurd,
        lambda r: jumps(r, trust_speed=not contradicted),
        stalled_rows,
        *(() if motion_only else (stuck,)),
    )
    return _drop(kept, findings + units, checks)


def _drop(
    kept: Recording, findings: list[Finding], checks: tuple[RowCheck, ...]
) -> tuple[Recording, list[Finding]]:
    for check in checks:
        bad, found = check(kept)
        findings = findings + found
        kept = kept.take(~bad) if bad.any() else kept
    return kept, findings


def _lost(recording: Recording) -> list[Finding]:
    return [
        Finding(
            "unreadable_rows",
            "dropped",
            f"{len(d.rows)} unreadable: {d.reason}",
            rows=row_ranges(np.sort(d.rows)),
        )
        for d in recording.dropped
    ]


def _refused(findings: list[Finding]) -> bool:
    return any(f.severity == "refuse" for f in findings)
