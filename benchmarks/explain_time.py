"""How long explain takes, and how that grows with the length: one simulated UR5e, 500 Hz, six joints.

python benchmarks/explain_time.py [--minutes 2.5 5 10] [--seed 1] [--out DIR]

Recordings of 50 s of one robot that hides three effects; no reference, so that the masses and all of the
catalogue are asked. Each length runs in a process of its own, reading included.
"""

import argparse
import multiprocessing
import os
import resource
import tempfile
import time
from collections import defaultdict
from concurrent.futures import ProcessPoolExecutor
from itertools import pairwise
from pathlib import Path

import numpy as np

from residuum.mismatch import Task, explain
from residuum.robots import load_robot
from residuum.trials import healthy, paths
from residuum.trials.case import Bench
from residuum.trials.catalogue import CATALOGUE
from residuum.trials.generate import write_parquet
from residuum.trials.scene import Scene

RATE, SECONDS = 500, 50.0
HIDDEN = ("stribeck", "joint_elasticity", "cable_spring")


def recorded(out: Path, count: int, seed: int) -> list[Path]:
    """Simulate recordings that are not there yet."""
    files = [out / f"seed_{seed}_run_{k:02d}.parquet" for k in range(count)]
    if all(f.exists() for f in files):
        return files
    robot, _ = load_robot("ur5e")
    rng = np.random.default_rng(seed)
    plant = healthy.plain(robot, rng)
    motions = tuple(paths.recording(robot, rng, (SECONDS, SECONDS)) for _ in files)
    heat = tuple(healthy.temperatures(rng, count))
    seeds = tuple(int(s) for s in rng.integers(2**31, size=count))
    bench = Bench(robot, RATE, plant, motions, heat, seeds)
    scene = Scene(robot, motions, healthy.factory(robot), rng, False)
    drawn = [CATALOGUE[name](scene) for name in HIDDEN]
    for file, run in zip(files, bench.run(tuple((d, d.start) for d in drawn)), strict=True):
        write_parquet(file, run.recording)
    return files


def timed(files: list[Path]) -> None:
    """Explain some recordings and print how long each stage took."""
    robot, digest = load_robot("ur5e")
    marks = [("start", time.perf_counter())]

    def stage(name: str) -> None:
        marks.append((name.split(",")[0], time.perf_counter()))

    found = explain(Task(tuple(files), (), robot, digest, len(robot.joint)), stage)
    stage("end")
    whole = marks[-1][1] - marks[0][1]
    stages = defaultdict[str, float](float)
    for (name, begin), (_, end) in pairwise(marks):
        stages[name] += end - begin
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    names = ", ".join(f"{f['effect']} {f['joints']}" for f in found.findings["findings"])
    print(f"{len(files) * SECONDS / 60:.1f} min: {whole:.0f} s, {memory:.2f} GB; {names or 'nothing'}")
    print("  " + ", ".join(f"{n} {s:.1f} s" for n, s in stages.items() if s > 0.5), flush=True)


def main() -> None:
    """Simulate, then time each length in a process of its own."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--minutes", nargs="+", type=float, default=[2.5, 5.0, 10.0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path(tempfile.gettempdir()) / "explain_time")
    given = parser.parse_args()
    counts = [max(1, round(60 * m / SECONDS)) for m in given.minutes]
    given.out.mkdir(parents=True, exist_ok=True)
    files = recorded(given.out, max(counts), given.seed)
    print(f"{os.cpu_count()} cores, {RATE} Hz, six joints; hidden: {', '.join(HIDDEN)}", flush=True)
    for count in counts:
        with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as fresh:
            fresh.submit(timed, files[:count]).result()


if __name__ == "__main__":
    main()
