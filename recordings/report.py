"""What an audit says, as data: findings with severity, place, numbers and remedy."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from math import isfinite
from typing import Any, Literal

import numpy as np

from ..errors import InputError
from .recording import BoolArray, IntArray, Recording

Severity = Literal["note", "dropped", "refuse"]
Verdict = Literal["good", "usable", "refuse"]

SHOWN_RANGES = 8


@dataclass(frozen=True)
class Quantity:
    """A number with its unit."""

    value: float
    unit: str

    def as_dict(self) -> dict[str, Any]:
        """For JSON, which knows no infinity: that becomes null."""
        return {"value": self.value if isfinite(self.value) else None, "unit": self.unit}


@dataclass(frozen=True)
class Finding:
    """One thing an audit found.

    `kind`: its short name. `severity`: "note" (know it), "dropped" (rows left out), "refuse" (an answer from
    this recording would be wrong). `text`: what it is, in words. `remedy`: what to do, empty when nothing.
    `joints`: 1..6. `rows`: ranges (first, last) of line numbers in the source file. `intervals`: (t0, t1) in
    s, as recorded. `numbers`: by name.
    """

    kind: str
    severity: Severity
    text: str
    remedy: str = ""
    joints: tuple[int, ...] = ()
    rows: tuple[tuple[int, int], ...] = ()
    intervals: tuple[tuple[float, float], ...] = ()
    numbers: Mapping[str, Quantity] = field(default_factory=dict)

    def as_dict(self) -> dict[str, Any]:
        """Plain lists and dicts, for JSON."""
        return {
            "kind": self.kind,
            "severity": self.severity,
            "text": self.text,
            "remedy": self.remedy or None,
            "joints": list(self.joints),
            "rows": [list(r) for r in self.rows],
            "intervals": [list(i) for i in self.intervals],
            "numbers": {k: q.as_dict() for k, q in self.numbers.items()},
        }


@dataclass(frozen=True)
class AuditReport:
    """All findings on one recording.

    `rows_read` and `rows_kept` count samples, `summary` tells duration, rate and jitter of what is kept.
    """

    name: str
    findings: tuple[Finding, ...]
    rows_read: int
    rows_kept: int
    summary: Mapping[str, Quantity]

    @property
    def verdict(self) -> Verdict:
        """Give "refuse" if any finding does, "usable" if rows were dropped, else "good"."""
        severities = {f.severity for f in self.findings}
        if "refuse" in severities:
            return "refuse"
        return "usable" if "dropped" in severities else "good"

    def require(self) -> None:
        """Raise InputError, one line with the first reason and its remedy, when the verdict is "refuse"."""
        for finding in self.findings:
            if finding.severity == "refuse":
                raise InputError(f"{self.name}: {describe(finding)}; {finding.remedy}")

    def as_dict(self) -> dict[str, Any]:
        """Plain lists and dicts, for JSON."""
        return {
            "name": self.name,
            "verdict": self.verdict,
            "rows_read": self.rows_read,
            "rows_kept": self.rows_kept,
            "summary": {k: q.as_dict() for k, q in self.summary.items()},
            "findings": [f.as_dict() for f in self.findings],
        }


def describe(finding: Finding) -> str:
    """One line: joints, what, rows."""
    joints = ", ".join(str(j) for j in finding.joints)
    plural = "s" if len(finding.joints) > 1 else ""
    where = f"joint{plural} {joints}: " if joints else ""
    rows = f" (row {ranges_text(finding.rows)})" if finding.rows else ""
    return f"{where}{finding.text}{rows}"


def ranges_text(ranges: Iterable[tuple[int, int]]) -> str:
    """For example "3-6, 9"; long lists are cut and say so."""
    listed = list(ranges)
    texts = [str(a) if a == b else f"{a}-{b}" for a, b in listed[:SHOWN_RANGES]]
    more = len(listed) - SHOWN_RANGES
    return ", ".join(texts) + (f" and {more} more places" if more > 0 else "")


def row_ranges(rows: IntArray) -> tuple[tuple[int, int], ...]:
    """Ranges (first, last) of ascending numbers."""
    if not len(rows):
        return ()
    breaks = np.flatnonzero(np.diff(rows) != 1)
    firsts, lasts = rows[np.r_[0, breaks + 1]], rows[np.r_[breaks, len(rows) - 1]]
    return tuple(zip(firsts.tolist(), lasts.tolist(), strict=True))


def bad_ranges(recording: Recording, bad: BoolArray) -> tuple[tuple[int, int], ...]:
    """Line numbers of the samples `bad` (T,), as ranges."""
    return row_ranges(recording.rows[bad])


def rows_finding(
    kind: str, recording: Recording, bad: BoolArray, text: str, remedy: str = "", joints: tuple[int, ...] = ()
) -> Finding:
    """Report that the samples `bad` (T,) are dropped; `{n}` in `text` becomes their number and noun."""
    count = int(bad.sum())
    noun = f"{count} row{'s' if count > 1 else ''}"
    return Finding(
        kind, "dropped", text.replace("{n}", noun), remedy, joints, bad_ranges(recording, bad),
        numbers={"rows": Quantity(count, "1")},
    )  # fmt: skip
