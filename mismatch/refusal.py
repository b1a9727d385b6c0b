"""The answer to recordings from which nothing can be concluded."""

from collections.abc import Sequence

import numpy as np

from ..recordings import Recording
from ..recordings.report import AuditReport
from ..robots import Robot
from ..robots.model import Model
from .result import Explanation, Proof, Source
from .sentence import sentence


def bad_data(
    robot: Robot, nominal: Model, sources: tuple[Source, ...],
    refusals: Sequence[tuple[Recording, AuditReport]], texts: tuple[str, ...] = (),
) -> Explanation:  # fmt: skip
    """Return the answer to recordings from which nothing can be concluded."""
    n = nominal.dof
    findings = []
    for recording, report in refusals:
        for f in report.findings:
            if f.severity == "refuse":
                texts = (*texts, f"{recording.name}: {f.text}" + (f"; {f.remedy}" if f.remedy else ""))
                findings.append(
                    {
                        "effect": "data_fault", "joints": [j for j in f.joints if j <= 6],
                        "indistinguishable_from": [], "confidence": 0.99, "parameters": {}, "equation": "",
                        "share": {}, "intervals": [list(i) for i in f.intervals],
                        "next_motion": f.remedy or None,
                    }
                )  # fmt: skip
    none = np.zeros(n)
    proof = Proof("nothing was fitted", none, none, np.zeros((n, 2)), none, none * np.nan, none, none, 1.0)
    answer = {
        "schema": 1, "verdict": "bad_data", "findings": findings, "where": [],
        "fit": {"unit": "Nm", "scheme": proof.scheme, "before": [], "after": [], "after_interval95": []},
        "placebo_rate": None,
    }  # fmt: skip
    said = sentence("bad_data", findings) + (f" {texts[0][0].upper()}{texts[0][1:]}." if texts else "")
    return Explanation(robot.title, sources, answer, said, nominal, proof, (), (), (), {}, texts, None)
