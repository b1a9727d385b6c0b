"""Seconds and memory of audit + fit, and of a regressor beside figaroh's and Pinocchio's.

python benchmarks/fit.py [--robot ur5e] [--workers 2] [--minutes 10 60]

Recordings are simulated: Fourier motion of six joints at 500 Hz with noise, written as CSV. Memory is the
largest sum of proportional set sizes of the process and its children, sampled every 50 ms (Linux).
figaroh wants its own environment beside this one: pip install figaroh, then --figaroh PYTHON.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import numpy as np
from machine import as_text, description

from residuum.codegen.generate import generate
from residuum.codegen.load import load_text
from residuum.codegen.regressors import regressor
from residuum.identify.workflow import Task, run
from residuum.robots import load_robot
from residuum.robots.model import TermData
from residuum.symbolic.nominal import nominal_model, robot_arm

RATE = 500.0
SAMPLES = 20_000
PEER = """
import json, sys, time
import numpy as np, pinocchio as pin
from types import SimpleNamespace
q, qd, qdd = np.load(sys.argv[1])
model = pin.buildSampleModelManipulator()
data = model.createData()
start = time.perf_counter()
stacked = np.empty((len(q), model.nv, 10 * (model.njoints - 1)))
for k in range(len(q)):
    stacked[k] = pin.computeJointTorqueRegressor(model, data, q[k], qd[k], qdd[k])
found = {"pinocchio": time.perf_counter() - start, "joints": model.nv}
try:
    from figaroh.tools.regressor import build_regressor_basic
    robot = SimpleNamespace(model=model, data=data)
    options = dict(is_joint_torques=True, is_external_wrench=False, force_torque=None, has_friction=False,
                   has_actuator_inertia=False, has_joint_offset=False, act_idxv=list(range(model.nv)))
    start = time.perf_counter()
    build_regressor_basic(robot, q, qd, qdd, options)
    found["figaroh"] = time.perf_counter() - start
except Exception as error:
    found["figaroh"] = f"{type(error).__name__}: {error}"
print(json.dumps(found))
"""


class Memory(threading.Thread):
    """Largest memory of this process and its children, MB."""

    def __init__(self) -> None:
        super().__init__(daemon=True)
        self.peak, self._done = 0.0, threading.Event()

    def run(self) -> None:
        while not self._done.wait(0.05):
            self.peak = max(self.peak, sum(map(_proportional, _family(os.getpid()))) / 1e3)

    def stop(self) -> float:
        self._done.set()
        return self.peak


def _family(process: int) -> list[int]:
    path = Path(f"/proc/{process}/task/{process}/children")
    children = [int(x) for x in path.read_text().split()] if path.exists() else []
    return [process, *(y for x in children for y in _family(x))]


def _proportional(process: int) -> int:
    try:
        lines = Path(f"/proc/{process}/smaps_rollup").read_text().splitlines()
    except OSError:
        return 0
    return sum(int(x.split()[1]) for x in lines if x.startswith("Pss:"))


def motion(count: int, seed: int = 0):
    """Sums of five sines a joint, up to 0.5 Hz: q, qd, qdd (count, 6)."""
    rng = np.random.default_rng(seed)
    t = np.arange(count)[:, None] / RATE
    q, qd, qdd = (np.zeros((count, 6)) for _ in range(3))
    for k in range(1, 6):
        w = 0.2 * np.pi * k
        a, phase = 0.5 * rng.normal(size=6) / k, rng.uniform(0, 6, 6)
        q += a * np.sin(w * t + phase)
        qd += w * a * np.cos(w * t + phase)
        qdd -= w**2 * a * np.sin(w * t + phase)
    return q, qd, qdd


def write(path: Path, robot: str, minutes: float) -> None:
    data, digest = load_robot(robot)
    model = nominal_model(data, digest, 6)
    friction = [
        TermData(name=n, joint=j, parameters={p: v})
        for j in range(1, 7)
        for n, p, v in (("coulomb", "Fc", 3.0), ("viscous", "Fv", 2.0))
    ]
    observer = load_text(generate(model.model_copy(update={"term": tuple(friction)})).files["observer.py"])
    rng = np.random.default_rng(1)
    q, qd, qdd = motion(round(60 * minutes * RATE))
    current = (observer.inverse_dynamics(q, qd, qdd) + observer.friction(q, qd)) / observer.GAINS
    current += 0.05 * rng.normal(size=q.shape)
    names = ["timestamp", *(f"actual_{c}_{j}" for c in ("q", "qd", "current") for j in range(6))]
    time_axis = np.arange(len(q)) / RATE
    table = np.column_stack(
        [time_axis, q + 2e-5 * rng.normal(size=q.shape), qd + 1e-3 * rng.normal(size=q.shape), current]
    )
    np.savetxt(path, table, fmt="%.9g", delimiter=",", header=",".join(names), comments="")


def timed_fit(path: Path, robot: str, workers: int) -> dict[str, object]:
    marks: list[tuple[str, float]] = []
    memory, start = Memory(), time.perf_counter()
    memory.start()
    data, digest = load_robot(robot)
    run(
        Task((path,), data, digest, 6, false_alarms=1.0, workers=workers),
        lambda x: marks.append((x, time.perf_counter() - start)),
    )
    total = time.perf_counter() - start
    stages = {
        name: round(b - a, 2) for (name, a), (_, b) in zip(marks, [*marks[1:], ("", total)], strict=True)
    }
    return {"seconds": round(total, 2), "MB": round(memory.stop()), **stages}


def regressors(robot: str, python: str) -> None:
    data, _ = load_robot(robot)
    found = regressor(robot_arm(data))
    q, qd, qdd = motion(SAMPLES)
    found.values("torque", q=q, qd=qd, qdd=qdd)
    start = time.perf_counter()
    found.values("torque", q=q, qd=qd, qdd=qdd)
    ours = time.perf_counter() - start
    print(f"\nregressor of six joints, us a sample ({SAMPLES} samples, one call):")
    print(f"  residuum, base parameters, NumPy      {1e6 * ours / SAMPLES:8.2f}")
    with tempfile.NamedTemporaryFile(suffix=".npy") as file:
        np.save(file, np.array([q, qd, qdd]))
        file.flush()
        done = subprocess.run([python, "-c", PEER, file.name], capture_output=True, text=True, check=False)
    if done.returncode:
        print(f"  peers: not measured ({done.stderr.strip().splitlines()[-1]})")
        return
    peers = json.loads(done.stdout.splitlines()[-1])
    for name, label in (
        ("pinocchio", "Pinocchio, link parameters, a loop"),
        ("figaroh", "figaroh build_regressor_basic"),
    ):
        value = peers[name]
        print(f"  {label:37} " + (value if isinstance(value, str) else f"{1e6 * value / SAMPLES:8.2f}"))


def main() -> None:
    options = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    options.add_argument("--robot", default="ur5e")
    options.add_argument("--workers", type=int, default=2)
    options.add_argument("--minutes", type=float, nargs="+", default=[10.0, 60.0])
    options.add_argument(
        "--figaroh", default=sys.executable, help="Python of an environment with figaroh and pin"
    )
    options.add_argument("--one", help=argparse.SUPPRESS)
    chosen = options.parse_args()
    if chosen.one:
        print(json.dumps(timed_fit(Path(chosen.one), chosen.robot, chosen.workers)))
        return
    print(as_text(description(("numpy", "scipy", "casadi", "pin"))))
    with tempfile.TemporaryDirectory() as folder:
        for minutes in chosen.minutes:
            path = Path(folder) / f"{minutes:g}min.csv"
            write(path, chosen.robot, minutes)
            command = [
                sys.executable,
                __file__,
                "--one",
                str(path),
                "--robot",
                chosen.robot,
                "--workers",
                str(chosen.workers),
            ]
            environment = os.environ | {"OPENBLAS_NUM_THREADS": "1"}
            start = time.perf_counter()
            done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
            if done.returncode:
                sys.exit(done.stderr)
            wall = time.perf_counter() - start
            print(
                f"\n{minutes:g} min, {path.stat().st_size / 1e6:.0f} MB: {wall:.1f} s with start-up  {done.stdout.strip()}"
            )
            path.unlink()
    regressors(chosen.robot, chosen.figaroh)


if __name__ == "__main__":
    main()
