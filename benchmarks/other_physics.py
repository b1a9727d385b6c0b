"""Concealed cases from robots whose physics is not ours, in the files of a trial.

python benchmarks/other_physics.py --cases 60 --seed 1 --out foreign --workers 2
residuum trial --cases 60 --seed 1 --out foreign --stage answer --stage score --workers 2

The robots are MuJoCo's: friction is what its constraint solver holds, the controller a plain PD with
feed-forward. A quarter is clean, half have a reference, rates are 125 and 500 Hz. The size in the tables is the rms
of what an effect changes over that of the sensors' noise, both below 10 Hz, on the joint where that is
largest; what is fitted anyway (without a reference: offset, Coulomb and viscous friction) is taken off for the
visible size.

--inverse: robots of inverse dynamics and added friction instead (foreign/inverse.py), a fifth of them with
something that the catalogue has no name for.
"""

import argparse
import sys
from concurrent.futures import as_completed
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from foreign.arm import Change, Healthy, record
from foreign.changes import ALWAYS, GIVEN, LARGE, OUTSIDE, REFERENCE, Scene
from foreign.inverse import along
from foreign.paths import path
from numpy.typing import NDArray

from residuum.recordings import Recording
from residuum.robots import Robot, load_robot
from residuum.trials.families import ON_A_JOINT
from residuum.trials.files import write_json
from residuum.trials.pool import pool
from residuum.trials.sealing import seal
from residuum.trials.sizing import MOVING, beside_friction, gains, low_pass

Array = NDArray[np.float64]

#: Nm and Nm s/rad of a UR5e's and a UR10e's joints.
FRICTION = {
    "ur5e": (np.array([6.5, 7.0, 5.5, 1.5, 1.3, 1.2]), np.array([5.0, 6.0, 4.5, 1.1, 1.0, 0.9])),
    "ur10e": (np.array([11.0, 13.0, 8.0, 2.4, 2.0, 1.9]), np.array([10.0, 12.0, 7.0, 1.9, 1.6, 1.5])),
}
CLEAN, LARGE_ARM, SAME_PATH = 0.25, 0.3, 0.4
#: Of robots of inverse dynamics: with something outside the catalogue; rad/s in which friction turns.
STRANGE, TURNS = 0.15, (0.002, 0.01, 0.03)


def healthy_robot(rng: np.random.Generator, name: str, reference: bool) -> Healthy:
    """Draw a robot: with a reference it may differ from its file, without one only in straight friction."""
    own = 1.0 if reference else 0.0
    dry, damping = (x * rng.uniform(0.7, 1.3, 6) for x in FRICTION[name])
    return Healthy(
        masses=1 + own * 0.03 * rng.standard_normal(6), rotors=1 + own * 0.08 * rng.standard_normal(6),
        dry=dry, damping=damping, curved=reference and rng.random() < 0.5,
        offset=own * 0.1 * LARGE * rng.standard_normal(6),
        noise=np.array([0.05, 0.05, 0.04, 0.025, 0.025, 0.025]) * rng.uniform(0.4, 1.5),
        soft=float(rng.choice([0.004, 0.01, 0.02])), cold=rng.uniform(26, 34, 6),
        heat=rng.uniform(0.3, 1.5, 6),
    )  # fmt: skip


def make(out: Path, number: int, seed: int, inverse: bool) -> None:
    """Simulate one case and write it down."""
    rng, case = np.random.default_rng([seed, number]), f"{number + 1:03d}"
    reference, name = bool(number % 2), "ur10e" if rng.random() < LARGE_ARM else "ur5e"
    robot, rate, seconds = load_robot(name)[0], int(rng.choice([125, 500])), rng.uniform(30, 60)
    healthy, simulate = healthy_robot(rng, name, reference), record
    some = ALWAYS + (REFERENCE if reference else ())
    if inverse:
        healthy, simulate = replace(healthy, soft=float(rng.choice(TURNS))), along
        some += GIVEN
    scene, drawn = Scene(rng, robot, healthy, int(rng.integers(6))), rng.random()
    strange = inverse and drawn > 1 - STRANGE
    some = OUTSIDE if strange else some
    change = Change() if drawn < CLEAN else some[int(rng.integers(len(some)))](scene)
    home = np.array([0, -1.4, 1.3, -1.5, -1.5, 0]) + rng.uniform(-0.3, 0.3, 6)
    same, runs, before = rng.random() < SAME_PATH, int(rng.integers(1, 4)), list[Recording]()
    folder, observed = out / "cases" / case, list[Recording]()
    for k in range(runs):
        way, noise, warmer = path(rng, seconds, home), int(rng.integers(2**31)), 8.0 * k
        observed.append(simulate(robot, healthy, change, way, rate, noise, warmer))
        before.append(simulate(robot, healthy, Change(), way, rate, noise, warmer))
        write(folder / f"observed_{k + 1}.parquet", observed[-1])
        if reference:
            other = way if same else path(rng, seconds, home)
            again = simulate(robot, healthy, Change(), other, rate, noise + 1, warmer)
            write(folder / f"reference_{k + 1}.parquet", again)
    files = {kind: sorted(x.name for x in folder.glob(f"{kind}_*")) for kind in ("observed", "reference")}
    label = {"robot": name, "recordings": files["observed"], "reference": files["reference"]}
    write_json(folder / "case.json", label)
    ratio, beside = sizes(robot, observed, before, healthy.noise)
    effect = {
        "effect": change.effect,
        "joints": change.joints if change.effect in ON_A_JOINT else (),
        "size": float(ratio.max()),
        "parameters": change.parameters,
    }
    truth = {
        "case": case, "kind": "outside" if strange else "catalogue" if change.effect else "clean",
        "robot": name, "rate": rate,
        "reference": reference, "effects": [effect] if change.effect else [], "ratio": ratio.tolist(),
        "beside_friction": beside.tolist(), "soft": healthy.soft, "curved": healthy.curved,
    }  # fmt: skip
    write_json(out / "sealed" / f"{case}.json", plainly(truth))


def sizes(
    robot: Robot, observed: list[Recording], before: list[Recording], noise: Array
) -> tuple[Array, Array]:
    """Return the change's rms over the noise's (6,), and its share that friction and an offset leave (6,)."""
    torque, rate = gains(robot), observed[0].rate
    change = [low_pass(torque * (a.current - b.current), rate) for a, b in zip(observed, before, strict=True)]
    rng = np.random.default_rng(0)
    white = low_pass(rng.standard_normal((20_000, 1)), rate)  # what the filter leaves of the noise
    level, change_rms = noise * torque * float(np.std(white)), np.zeros(6)
    beside = np.ones(6)
    for j in range(6):
        whole = np.concatenate([c[:, j] for c in change])
        qd = np.concatenate([r.qd[:, j] for r in before if r.qd is not None])
        moving = np.abs(qd) > MOVING
        if whole[moving].any():
            change_rms[j] = np.sqrt(np.mean(whole[moving] ** 2))
            beside[j] = beside_friction(qd[moving], whole[moving])
    return change_rms / level, beside


def write(path: Path, recording: Recording) -> None:
    """Write a recording under RTDE's names, as a controller that reports these four does."""
    path.parent.mkdir(parents=True, exist_ok=True)
    columns = {"timestamp": recording.timestamp}
    channels = (
        ("actual_q", recording.q), ("actual_qd", recording.qd), ("actual_current", recording.current),
        ("joint_temperatures", recording.joint_temperatures),
    )  # fmt: skip
    for name, values in channels:
        columns |= {f"{name}_{k}": column for k, column in enumerate(values.T)}
    pq.write_table(pa.table({k: np.round(v, 6) for k, v in columns.items()}), path, compression="zstd")


def plainly(value: Any) -> Any:
    """Return a value that JSON knows."""
    if isinstance(value, dict):
        return {k: plainly(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [plainly(v) for v in value]
    return value.item() if isinstance(value, np.generic) else value


def main() -> None:
    """Simulate all cases that are not there yet, and seal them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=int, default=60)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--inverse", action="store_true")
    a = parser.parse_args()
    missing = [k for k in range(a.cases) if not (a.out / "sealed" / f"{k + 1:03d}.json").exists()]
    with pool(a.workers) as executor:
        jobs = [executor.submit(make, a.out, k, a.seed, a.inverse) for k in missing]
        for done, job in enumerate(as_completed(jobs), start=1):
            job.result()
            print(f"\rsimulated {done}/{len(missing)} ", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)
    seal(a.out)


if __name__ == "__main__":
    main()
