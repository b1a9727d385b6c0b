"""The score of a trial: verdicts, shares with intervals, and the files that hold them."""

import csv
import io
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from .files import read_json, write_json, write_text
from .judging import SIZES, Verdict, judge, nominal
from .sealing import check
from .shares import Share

Test = Callable[[Verdict], bool]
OUTCOMES: dict[str, Test] = {
    "right": lambda v: v.right,
    "right_in_class": lambda v: v.outcome == "right_in_class",
    "wrong_first": lambda v: v.outcome == "wrong",
    "any_wrong": lambda v: v.wrong,
    "abstained": lambda v: v.outcome == "abstained",
    "missed": lambda v: v.outcome == "missed",
}


def score(out: Path, answers: str = "answers") -> dict[str, Any]:
    """Reveal the truths, judge all answers, write out/score.json, score.md and cases.csv; return the score.

    answers: the folder of answers; for another than "answers" its name begins the files' names.
    Raises InputError when the seal is broken or a file is missing.
    """
    from .tables import report

    check(out)
    verdicts = [_verdict(out, answers, file) for file in sorted((out / "sealed").glob("[0-9]*.json"))]
    result = summary(verdicts)
    prefix = "" if answers == "answers" else f"{answers}_"
    write_json(out / f"{prefix}score.json", result)
    write_text(out / f"{prefix}cases.csv", cases_csv(verdicts))
    write_text(out / f"{prefix}score.md", report(result))
    return result


def summary(verdicts: list[Verdict]) -> dict[str, Any]:
    """Return all shares of a trial as data: {"count", "n", "share", "interval95"} each."""
    hidden = [v for v in verdicts if v.kind == "catalogue"]
    single = [v for v in hidden if len(v.effects) == 1]
    groups: dict[str, dict[str, list[Verdict]]] = {
        "all": {"all": hidden},
        "size": {_size(s): [v for v in hidden if v.bin == s] for s in SIZES},
        "size_with_reference": {_size(s): [v for v in hidden if v.bin == s and v.reference] for s in SIZES},
        "size_without_reference": {
            _size(s): [v for v in hidden if v.bin == s and not v.reference] for s in SIZES
        },
        "visible": {_size(s): [v for v in hidden if nominal(v.visible) == s] for s in SIZES},
        "reference": {t: [v for v in hidden if v.reference == (t == "with")] for t in ("with", "without")},
        "rate": {str(r): [v for v in hidden if v.rate == r] for r in (125, 500)},
        "robot": _by(hidden, lambda v: v.robot),
        "hidden_at_once": _by(hidden, lambda v: str(len(v.effects))),
        "effect": _by(single, lambda v: v.effects[0]),
    }
    return {
        "cases": len(verdicts),
        "catalogue": {g: {k: _shares(vs) for k, vs in rows.items()} for g, rows in groups.items()},
        "half_or_more": _shares([v for v in hidden if v.bin >= 0.5]),
        "both_found": Share(
            sum(v.found == 2 for v in hidden), sum(len(v.effects) == 2 for v in hidden)
        ).data(),
        "clean": _nothing([v for v in verdicts if v.kind == "clean"]),
        "outside": _nothing([v for v in verdicts if v.kind == "outside"]),
        "confusion": _confusion(verdicts),
        "parameters": _parameters(hidden),
        "confidence": _calibration(verdicts),
        "seconds": _seconds(verdicts),
        "failures": {v.case: v.failure for v in verdicts if v.failure},
    }


def cases_csv(verdicts: Iterable[Verdict]) -> str:
    """Return one line a case: truth, size, answer, outcome."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    names = ["case", "kind", "robot", "rate", "reference", "truth", "size", "visible", "first", "outcome"]
    writer.writerow([*names, "any_wrong", "joints", "found", "seconds", "failure"])
    for v in verdicts:
        joints = "" if v.joints is None else v.joints
        sizes = [f"{v.size:.3f}", f"{v.visible:.3f}"]
        row = [v.case, v.kind, v.robot, v.rate, v.reference, "+".join(v.effects), *sizes, v.first]
        writer.writerow([*row, v.outcome, v.wrong, joints, v.found, v.seconds, v.failure])
    return text.getvalue()


def _verdict(out: Path, answers: str, sealed: Path) -> Verdict:
    path = out / answers / sealed.name
    timing = path.with_suffix(".seconds")
    seconds = float(timing.read_text(encoding="utf-8")) if timing.exists() else None
    return judge(read_json(sealed), read_json(path), seconds)


def _shares(verdicts: list[Verdict]) -> dict[str, Any]:
    shares = {name: Share(sum(map(test, verdicts)), len(verdicts)).data() for name, test in OUTCOMES.items()}
    scored = [v.joints for v in verdicts if v.joints is not None]
    return shares | {"joints": Share(sum(scored), len(scored)).data()}


def _nothing(verdicts: list[Verdict]) -> dict[str, Any]:
    """Return shares of cases in which there was nothing to name, split by reference."""
    rows = {"all": verdicts}
    rows |= {t: [v for v in verdicts if v.reference == (t == "with")] for t in ("with", "without")}
    return {
        key: {
            "named": Share(sum(v.outcome == "named" for v in vs), len(vs)).data(),
            "unknown": Share(sum(v.outcome == "abstained" for v in vs), len(vs)).data(),
        }
        for key, vs in rows.items()
    }


def _confusion(verdicts: list[Verdict]) -> dict[str, dict[str, int]]:
    """Return truth -> first answer -> cases; truth "clean" for none."""
    found: dict[str, Counter[str]] = defaultdict(Counter)
    for v in verdicts:
        found["+".join(v.effects) or "clean"][v.first] += 1
    return {truth: dict(found[truth].most_common()) for truth in sorted(found)}


def _calibration(verdicts: list[Verdict]) -> dict[str, Any]:
    """Return, by confidence of the first name, how often it was right; names of clean robots are wrong."""
    edges, rows = (0.0, 0.8, 0.95, 1.0), {}
    for low, high in pairwise(edges):
        inside = [v for v in verdicts if v.confidence is not None and low < v.confidence <= high]
        rows[f"{low:g}-{high:g}"] = Share(sum(v.right for v in inside), len(inside)).data()
    return rows


def _parameters(verdicts: list[Verdict]) -> dict[str, Any]:
    """Return medians of relative parameter errors, by parameter and over all, of right names."""
    by: dict[str, list[float]] = defaultdict(list)
    for v in verdicts:
        for name, error in v.errors.items():
            by[name].append(error)
    every = [e for values in by.values() for e in values]
    rows = {name: {"n": len(e), "median": float(np.median(e))} for name, e in sorted(by.items())}
    return {"all": {"n": len(every), "median": float(np.median(every)) if every else None}, "by_name": rows}


def _seconds(verdicts: list[Verdict]) -> dict[str, float]:
    known = [v.seconds for v in verdicts if v.seconds is not None]
    return {"median": float(np.median(known)), "largest": max(known)} if known else {}


def _by(verdicts: list[Verdict], key: Callable[[Verdict], str]) -> dict[str, list[Verdict]]:
    return {k: [v for v in verdicts if key(v) == k] for k in sorted({key(v) for v in verdicts})}


def _size(size: float) -> str:
    return f">= {size:g}" if size == SIZES[-1] else f"{size:g}"
