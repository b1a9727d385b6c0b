"""Nanoseconds for p = M qd and beta = C^T qd - g: generated code beside its peers, in one run.

python benchmarks/speed.py [--robot ur5e] [--states 4000] [--repetitions 40] [--json FILE]

Every implementation must give the same numbers before it is timed. Repetitions are interleaved, each goes
through all states once, and processor time is counted, so that what else runs here weighs on all alike.
"""

import argparse
import json
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np
from machine import as_text, description, stay_on_one_core
from subjects import generated, pinocchio, symforce, wrenfold
from subjects.native import Loop
from subjects.subject import States, Subject, Unavailable, worst_difference

from residuum.errors import InputError
from residuum.robots import load_robot

T = TypeVar("T")
TOLERANCE = 1e-9
SAMPLES = 10_000  # what NumPy is given at a time
PACKAGES = ("numpy", "pin", "cmeel-eigen", "symforce", "wrenfold")


@dataclass(frozen=True)
class Figure:
    """Time of one implementation, ns of processor time per state, over the repetitions."""

    joints: int
    name: str
    kind: str
    minimum: float
    median: float
    ratio: float  # median over that of the generated code of the same table
    operations: int | None
    difference: float | None  # from the generated NumPy, relative; None: not checked, a part of the work


def say(words: str) -> None:
    """Say what goes on, apart from the tables."""
    print(words, file=sys.stderr, flush=True)


def attempt(build: Callable[[], T], name: str, otherwise: T) -> T:
    """Return what a peer builds; where it cannot, say so in one line and go on."""
    try:
        return build()
    except Unavailable as error:
        say(f"{name}: left out: {error}")
    except Exception as error:  # a peer's own failure must not stop the rest
        say(f"{name}: left out: {type(error).__name__}: {str(error).splitlines()[0] if str(error) else ''}")
    return otherwise


def subjects(name: str, folder: Path) -> dict[int, list[Subject]]:
    """Build everything that can be built, for 3 and 6 joints."""
    robot, _ = load_robot(name)
    loop = Loop(folder)
    say("compiling Pinocchio, which takes a minute or two")
    compiled = attempt(lambda: pinocchio.library(folder), "Pinocchio C++", None)
    found: dict[int, list[Subject]] = {}
    for dof in (3, 6):
        say(f"generating and compiling the rest for {dof} joints")
        ours = generated.generate(name, dof, folder)
        found[dof] = [
            *generated.numpy(ours),
            *generated.native(ours, loop),
            generated.trigonometry(ours, loop),
        ]
        peers: dict[str, Callable[[], list[Subject]]] = {
            "Pinocchio from Python": lambda d=dof: pinocchio.python(robot, d),
            "SymForce": lambda d=dof: symforce.native(robot, d, folder, loop),
            "wrenfold": lambda d=dof: wrenfold.native(robot, d, folder, loop),
        }
        if compiled is not None:
            peers["Pinocchio C++"] = lambda d=dof: pinocchio.native(robot, d, compiled, loop)
        for peer, build in peers.items():
            found[dof] += attempt(build, f"{peer}, {dof} joints", [])
    return found


def checked(all_subjects: Sequence[Subject], states: States) -> dict[str, float]:
    """Return each one's difference from the first; one that is off must not be timed."""
    reference = all_subjects[0].evaluate(states)
    differences = {s.name: worst_difference(s.evaluate(states), reference) for s in all_subjects if s.whole}
    for name, difference in differences.items():
        if not difference < TOLERANCE:
            raise SystemExit(f"{name}: differs by {difference:.1e}; nothing was timed")
    return differences


def measure(joints: int, all_subjects: Sequence[Subject], count: int, repetitions: int) -> list[Figure]:
    """Time implementations turn by turn."""
    states = States.random(count, joints)
    given = {"numpy": States.random(SAMPLES, joints), "motion": States.motion(SAMPLES, joints)}
    differences = checked(all_subjects, states)
    times = {s.name: np.empty(repetitions) for s in all_subjects}
    for repetition in range(-1, repetitions):  # the first only warms up
        for s in all_subjects:
            taken = s.time(given.get(s.kind, states))
            if repetition >= 0:
                times[s.name][repetition] = taken
    own = {"native": np.median(times["residuum C, momentum and beta"])}
    other = np.median(times["residuum NumPy, core, random states"])
    return [
        Figure(
            joints, s.name, s.kind, float(times[s.name].min()), float(np.median(times[s.name])),
            float(np.median(times[s.name]) / own.get(s.kind, other)), s.operations,
            differences.get(s.name),
        )
        for s in all_subjects
    ]  # fmt: skip


def table(figures: Sequence[Figure]) -> str:
    """Return a Markdown table."""
    lines = [
        "| implementation | operations | minimum, ns | median, ns | times ours |",
        "|---|---:|---:|---:|---:|",
    ]
    for f in sorted(figures, key=lambda f: f.median):
        operations = "" if f.operations is None else str(f.operations)
        lines.append(f"| {f.name} | {operations} | {f.minimum:.1f} | {f.median:.1f} | {f.ratio:.2f} |")
    return "\n".join(lines)


def main() -> None:
    """Run the comparison and print its tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--robot", default="ur5e")
    parser.add_argument("--states", type=int, default=4000, help="distinct random states, 1000 or more")
    parser.add_argument("--repetitions", type=int, default=40)
    parser.add_argument("--json", type=Path, metavar="FILE")
    options = parser.parse_args()
    if options.states < 1000 or options.repetitions < 1:
        parser.error("give 1000 states or more and 1 repetition or more")
    try:
        load_robot(options.robot)
    except InputError as error:
        parser.error(str(error))
    stay_on_one_core()
    about = description(PACKAGES)
    with tempfile.TemporaryDirectory() as folder:
        built = subjects(options.robot, Path(folder))
        say("timing")
        figures = [
            f for n, found in built.items() for f in measure(n, found, options.states, options.repetitions)
        ]
    print(as_text(about))
    print(f"\n{options.robot}, {options.states} states, {options.repetitions} repetitions, gcc -O3, one core")
    for joints in built:
        for title, native in (("compiled, one state at a time", True), ("called from Python", False)):
            print(f"\n{joints} joints, {title}:\n")
            print(table([f for f in figures if f.joints == joints and (f.kind == "native") == native]))
    if options.json:
        rows = [vars(f) for f in figures]
        options.json.write_text(json.dumps({"machine": about, "options": {"robot": options.robot,
                                "states": options.states, "repetitions": options.repetitions}, "figures": rows}, indent=1))  # fmt: skip


if __name__ == "__main__":
    main()
