"""Held-out error with the names that were found, over that with the true ones, on the cases of a trial.

residuum trial --cases 60 --seed 7 --out trial --workers 2
python benchmarks/truth_known.py trial [--sizes 0.5]

Both models are fitted to the same rows with the same weights, and every row is predicted by a fit without its
block. The second one has the hypotheses of the true effects on their true joints, at the nonlinear values that
fit best. Cases whose effects are no columns (contact, outside the catalogue) are left out.
"""

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from residuum.mismatch.candidates import Candidate
from residuum.mismatch.evidence import Evidence, gather
from residuum.mismatch.judging import judge
from residuum.mismatch.naming import chosen, nuisance, reweighed, scored
from residuum.mismatch.proof import motion, rms_where
from residuum.mismatch.refit import left_out
from residuum.mismatch.selection import Directions
from residuum.recordings import read
from residuum.recordings.audit import clean
from residuum.robots import load_robot
from residuum.symbolic.nominal import nominal_model
from residuum.trials.answering import case_files
from residuum.trials.files import read_json

Array = NDArray[np.float64]


def gathered(folder: Path) -> Evidence:
    """Return the evidence of a case."""
    files = case_files(folder)
    robot, digest = load_robot(files.robot)
    runs = [clean(read(p))[0] for p in (*files.recordings, *files.reference)]
    observed = [True] * len(files.recordings) + [False] * len(files.reference)
    return gather(runs, observed, nominal_model(robot, digest, len(robot.joint)), robot)


def true_ones(evidence: Evidence, effects: list[dict[str, Any]]) -> Iterator[list[Candidate]]:
    """Give the hypotheses of each true effect; none where it is no column of its joint."""
    for e in effects:
        on_one = {j - 1 for j in e["joints"]} if len(e["joints"]) == 1 else {None}
        yield [c for c in evidence.found.each if c.effect == e["effect"] and c.joint in on_one]


def with_truth(evidence: Evidence, effects: list[dict[str, Any]], masses: float) -> Directions:
    """Return the model of true effects that all have columns; masses: as `nuisance` takes them."""
    model = nuisance(evidence, masses)
    for some in true_ones(evidence, effects):
        model = chosen(
            model, evidence, max(scored(evidence, model, some), key=lambda s: s.evidence).candidate
        )
    return model


def errors(evidence: Evidence, model: Directions) -> Array:
    """Return the rms (N,) Nm of left-out rows in which the joint moves."""
    return rms_where(left_out(evidence, model).residual, motion(evidence))


def run(trial: Path, least: float) -> None:
    """Print a row a case and the summary."""
    ratios = []
    print(
        "| case | truth | found | joint | held-out rms found, Nm | truth known, Nm | ratio |\n|---|---|---|---|---|---|---|"
    )
    for folder in sorted((trial / "cases").iterdir()):
        truth = read_json(trial / "sealed" / f"{folder.name}.json")
        if truth["kind"] != "catalogue" or max(e["size"] for e in truth["effects"]) < least:
            continue
        evidence = gathered(folder)
        if not all(true_ones(evidence, truth["effects"])):
            continue
        judged = judge(evidence)
        known = with_truth(evidence, truth["effects"], judged.masses)
        weighed = reweighed(evidence, known)
        found, best = errors(weighed, judged.model), errors(weighed, known)
        j = truth["effects"][0]["joint"] - 1
        ratios.append(found[j] / best[j])
        named = ", ".join(a.score.candidate.effect for a in judged.accepted if a.is_finding) or "nothing"
        hidden = ", ".join(e["effect"] for e in truth["effects"])
        print(
            f"| {folder.name} | {hidden} | {named} | {j + 1} | {found[j]:.3f} | {best[j]:.3f} | {ratios[-1]:.3f} |",
            flush=True,
        )
    within = sum(r <= 1.05 for r in ratios)
    print(
        f"\nWithin 5 % of the truth known: {within} of {len(ratios)}; median ratio {np.median(ratios):.3f}."
    )


def main() -> None:
    """Read arguments and run."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("trial", type=Path)
    parser.add_argument("--sizes", type=float, default=0.0, help="smallest effect, of the residual's rms")
    a = parser.parse_args()
    if not (a.trial / "cases").is_dir():
        sys.exit(f"{a.trial}: holds no cases; run residuum trial first")
    run(a.trial, a.sizes)


if __name__ == "__main__":
    main()
