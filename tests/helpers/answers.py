"""What an answer of `residuum explain` has to look like, whatever it says."""

import json
from pathlib import Path
from typing import Any

from residuum.symbolic.effects import EFFECTS

VERDICTS = ("nothing_missing", "explained", "partly_explained", "unexplained", "bad_data")
NAMES = {*EFFECTS, "data_fault", "unknown"}
FILES = {"findings.json", "model.toml", "report.html"}


def findings(folder: Path) -> dict[str, Any]:
    """Read findings.json, strictly: NaN is no JSON."""

    def refuse(word: str) -> None:
        raise ValueError(f"{word} is no JSON number")

    found: dict[str, Any] = json.loads((folder / "findings.json").read_text(), parse_constant=refuse)
    return found


def names(answer: dict[str, Any]) -> list[str]:
    """Effects in the order of their strength."""
    return [f["effect"] for f in answer["findings"]]


def check(answer: dict[str, Any], dof: int = 6) -> None:
    """Assert the contract's structure by hand."""
    assert set(answer) == {"schema", "verdict", "findings", "where", "fit", "placebo_rate"}
    assert answer["schema"] == 1
    assert answer["verdict"] in VERDICTS
    assert answer["verdict"] != "nothing_missing" or not answer["findings"]
    assert answer["verdict"] == "bad_data" or {"before", "after"} <= set(answer["fit"])
    for finding in answer["findings"]:
        _check_finding(finding, dof)
    for place in answer["where"]:
        assert 1 <= place["joint"] <= dof and place["range"][0] <= place["range"][1]
        assert all(a <= b for a, b in place["intervals"])
    if answer["verdict"] != "bad_data":
        fit = answer["fit"]
        assert fit["unit"] == "Nm" and fit["scheme"]
        assert len(fit["before"]) == len(fit["after"]) == len(fit["after_interval95"]) == dof
        assert all(low <= high for low, high in fit["after_interval95"])
    assert answer["placebo_rate"] is None or 0 <= answer["placebo_rate"] <= 1


def _check_finding(finding: dict[str, Any], dof: int) -> None:
    assert finding["effect"] in NAMES
    assert set(finding["indistinguishable_from"]) <= NAMES - {finding["effect"]}
    assert finding["joints"] == sorted(set(finding["joints"])) and set(finding["joints"]) <= set(
        range(1, dof + 1)
    )
    assert 0 <= finding["confidence"] <= 1
    assert all(set(x) == {"value", "std", "unit"} for x in finding["parameters"].values())
    assert set(finding["share"]) <= {str(j) for j in finding["joints"]}
    assert all(0 <= x <= 1 for x in finding["share"].values())
    assert isinstance(finding["equation"], str)
    assert finding["next_motion"] is None or finding["next_motion"]
    for start, end in finding.get("intervals", ()):
        assert start <= end
