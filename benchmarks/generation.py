"""Wall time and peak memory of `gen-model`, imports included.

python benchmarks/generation.py [--robot ur5e] [--repetitions 5] [--json FILE]

The first run of each warms the disk and is left out.
"""

import argparse
import json
import os
import statistics
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from machine import as_text, description

GEN_MODEL = (sys.executable, "-c", "from residuum.cli.gen_model import main; main()")


@dataclass(frozen=True)
class Run:
    """Wall time and processor time, s; peak resident memory, MB."""

    wall: float
    processor: float
    memory: float


def run(robot: str, dof: int, out: str) -> Run:
    """Run gen-model once in a process of its own."""
    command = [*GEN_MODEL, "--dof", str(dof), "--robot", robot, "--out", out]
    silent = [(os.POSIX_SPAWN_OPEN, fd, os.devnull, os.O_WRONLY, 0) for fd in (1, 2)]
    start = time.perf_counter()
    child = os.posix_spawn(command[0], command, os.environ, file_actions=silent)
    _, status, usage = os.wait4(child, 0)
    wall = time.perf_counter() - start
    if status:
        raise SystemExit(f"gen-model --dof {dof} --robot {robot} failed")
    unit = 1e6 if sys.platform == "darwin" else 1e3 / 1.024  # bytes there, KiB elsewhere
    return Run(wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / unit)


def row(dof: int, runs: list[Run]) -> str:
    """Return a line of the table."""
    wall = [r.wall for r in runs]
    processor = [r.processor for r in runs]
    return (
        f"| gen-model --dof {dof} | {min(wall):.2f} | {statistics.median(wall):.2f} | {min(processor):.2f} "
        f"| {statistics.median(processor):.2f} | {max(r.memory for r in runs):.0f} |"
    )


def main() -> None:
    """Measure 3 and 6 joints turn by turn and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--robot", default="ur5e")
    parser.add_argument("--repetitions", type=int, default=5)
    parser.add_argument("--json", type=Path, metavar="FILE")
    options = parser.parse_args()
    runs: dict[int, list[Run]] = {3: [], 6: []}
    with tempfile.TemporaryDirectory() as out:
        for repetition in range(-1, options.repetitions):
            for dof, found in runs.items():
                one = run(options.robot, dof, out)
                if repetition >= 0:
                    found.append(one)
    about = description(("numpy", "sympy", "casadi"))
    print(as_text(about))
    print(f"\n{options.robot}, {options.repetitions} runs of each, warm disk:\n")
    print("| command | wall, minimum s | median s | processor, minimum s | median s | peak memory, MB |")
    print("|---|---:|---:|---:|---:|---:|")
    for dof, found in runs.items():
        print(row(dof, found))
    if options.json:
        figures = {str(dof): [vars(r) for r in found] for dof, found in runs.items()}
        options.json.write_text(json.dumps({"machine": about, "runs": figures}, indent=1))


if __name__ == "__main__":
    main()
