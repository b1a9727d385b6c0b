"""Composes the answer: findings.json, the sentence, what the page shows."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .exhibits import curves, ruled_out, traces
from .findings import findings_of
from .parts import Parts
from .result import Explanation, Region
from .sentence import sentence

Array = NDArray[np.float64]


def compose(p: Parts) -> Explanation:
    """Return the whole answer."""
    with_name, strange = findings_of(p)
    findings = with_name + strange
    verdict = _verdict(findings, strange)
    answer = {
        "schema": 1,
        "verdict": verdict,
        "findings": findings,
        "where": [_place(r) for r in p.regions],
        "fit": {
            "unit": "Nm",
            "scheme": p.proof.scheme,
            "before": _row(p.proof.before),
            "after": _row(p.proof.after),
            "after_interval95": [_row(x) for x in p.proof.interval],
        },
        "placebo_rate": p.placebos,
    }
    said = sentence(verdict, findings, p.evidence.has_reference)
    return Explanation(
        p.robot.title, p.sources, answer, said, p.model, p.proof, p.regions,
        traces(p), ruled_out(p), curves(p), p.lacks, p.next_motion,
    )  # fmt: skip


def _row(values: Array) -> list[float]:
    return [float(f"{v:.5g}") for v in values]


def _verdict(findings: Sequence[Mapping[str, Any]], strange: Sequence[Mapping[str, Any]]) -> str:
    if not findings:
        return "nothing_missing"
    if len(strange) == len(findings):
        return "unexplained"
    return "partly_explained" if strange else "explained"


def _place(r: Region) -> dict[str, Any]:
    return {
        "joint": r.joint, "share": round(r.share, 3), "variable": r.variable,
        "range": [float(f"{r.low:.4g}"), float(f"{r.high:.4g}")], "recording": r.recording,
        "intervals": [[round(a, 3), round(b, 3)] for a, b in r.intervals],
    }  # fmt: skip
