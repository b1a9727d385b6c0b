"""A real robot against itself: what explain says has changed where nothing has, and where something was added.

python benchmarks/real_reference.py RECORDINGS/unloaded_*.csv [--robot ur10e] [--added] [--seed 1]

Untouched: each recording against all others, then halves at random; every name is a false one, unless the
robot itself was not the same, as when it is cold. Added (--added): one effect at a time in one half, at sizes
of its rms over the residual's, all of it; the other half is the reference, on other paths.
"""

import argparse
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from added import cases, columns_of

from residuum.mismatch.evidence import Evidence, gather, renewed, residual
from residuum.mismatch.judging import Judged, judge
from residuum.mismatch.refit import parameters
from residuum.recordings import Recording, read
from residuum.recordings.audit import clean
from residuum.robots import Robot, load_robot
from residuum.symbolic.nominal import nominal_model

Say = Callable[[str], None]
HALVES = 7


def untouched(recordings: Sequence[Recording], robot: Robot, digest: str, seed: int, say: Say) -> None:
    """Print what is named in each split of recordings on which nothing was changed."""
    n, rng, named = len(recordings), np.random.default_rng(seed), 0
    splits = [[k] for k in range(n)] + [sorted(rng.permutation(n)[: n // 2]) for _ in range(HALVES)]
    for split in splits:
        found = judge(_split(recordings, split, robot, digest)).accepted
        named += bool(found)
        names = [f"{a.score.candidate.effect} {_joint(a.score.candidate.joint)}" for a in found]
        say(f"  {', '.join(recordings[k].name for k in split)}: {', '.join(names) or 'nothing'}")
    say(f"named: {named} of {len(splits)}")


def added(recordings: Sequence[Recording], robot: Robot, digest: str, seed: int, say: Say) -> None:
    """Print, by size, how many effects that were added to half of the recordings get their name."""
    n = len(recordings)
    half = sorted(np.random.default_rng(seed).permutation(n)[: n // 2])
    evidence = _split(recordings, half, robot, digest)
    known = judge(evidence)
    theta = parameters(evidence, known.model)
    left = [residual(r, evidence.setup.space, theta) for r in evidence.runs]
    table: dict[float, Counter[str]] = {}
    for case in cases(evidence, columns_of(recordings, evidence), {}, left, 1, seed, whole=True):
        sides = zip(evidence.runs, case.added, evidence.observed, strict=True)
        runs = [replace(r, torque=r.torque + x * o) for r, x, o in sides]
        found = judge(renewed(evidence, runs), known=known, most=1)
        verdict, name = _verdict(found, case.family)
        table.setdefault(case.size, Counter())[verdict] += 1
        if verdict != "right":
            say(f"  {case.size:.2f} {case.name} {_joint(case.joint)}: {name or 'nothing'}")
    for size, count in table.items():
        whole = count.total()
        shares = ", ".join(f"{v} {100 * count[v] / whole:.0f} %" for v in ("right", "in class", "wrong"))
        say(f"{size:.2f} ({whole}): {shares}")


def _split(recordings: Sequence[Recording], observed: Sequence[int], robot: Robot, digest: str) -> Evidence:
    sides = [k in observed for k in range(len(recordings))]
    return gather(recordings, sides, nominal_model(robot, digest, len(robot.joint)), robot)


def _verdict(found: Judged, family: str) -> tuple[str, str]:
    first = next((a for a in found.accepted if a.is_finding), None)
    if first is None:
        return "none", ""
    name = first.score.candidate.effect
    return "right" if name == family else "in class" if family in first.names else "wrong", name


def _joint(joint: int | None) -> str:
    return "on all joints" if joint is None else f"on joint {joint + 1}"


def main() -> None:
    """Read arguments and run."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("recordings", nargs="+", type=Path)
    parser.add_argument("--robot", default="ur10e")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--added", action="store_true")
    a = parser.parse_args()
    robot, digest = load_robot(a.robot)
    recordings = [clean(read(p))[0] for p in a.recordings]
    (added if a.added else untouched)(recordings, robot, digest, a.seed, print)


if __name__ == "__main__":
    main()
