"""The two riddles that Gylling 2019 left open, on a simulated UR5e whose truth is known.

There joint 1's residual grew with the arm's reach, and joints 2 and 3 needed a "gravity" column in q. Here
joints 1-3 of the virtual UR5e move while the wrist stands, the thesis' scheme is fitted, and explain is asked
what the thesis' own model lacks. docs/thesis_riddles.md says what that does and does not show.

    python examples/thesis_riddles.py --out riddles
"""

import argparse
import json
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from processes import residuum

from residuum.codegen.generate import model_toml, observer_text
from residuum.codegen.load import load_text
from residuum.identify.observation import observe
from residuum.recordings import read
from residuum.robots import Robot, load_robot
from residuum.robots.model import Model
from residuum.robots.toml import read as read_toml
from residuum.symbolic.nominal import nominal_model
from residuum.virtual import Plant, effects, simulate
from residuum.virtual.motions import Motion, fourier, join, move, sweep

WRIST = (-1.4, -1.5708, 0.0)  # rad, where joints 4-6 stand
SECONDS, RATE = 60.0, 125.0  # s of each of two random motions; Hz
FOLDED_TO_STRETCHED = ((-1.57, 0.0), (-1.57, 1.57), (-1.2, 0.4), (-0.9, 0.3), (-0.6, 0.2), (-0.3, 0.0))
"""rad of joints 2 and 3 at which joint 1 goes to and fro, from no reach to nearly all of it."""
LOAD_FRICTION = 0.08  # of the torque that gears 2 and 3 carry; real UR10e logs show such a term there
GAIN = 25.0  # 1/s, of the generated observers
BINS = 6


@dataclass(frozen=True)
class Samples:
    """Settled samples where the arm moves, all behind the observer's low-pass, (T, 3).

    q rad, qdd rad/s^2 (as commanded), left: motor torque that the model does not explain, Nm. friction: the
    thesis' columns sgn qd, qd, qd^2, qd^3 (eq. 3.2.8), (T, 3, 4).
    """

    q: np.ndarray
    qdd: np.ndarray
    left: np.ndarray
    friction: np.ndarray

    def moves(self, joint: int) -> np.ndarray:
        """Return where a joint (0-based) has moved one way for a while (T,): at rest friction is anything."""
        return np.abs(self.friction[:, joint, 0]) > 0.9


def motions() -> dict[str, Motion]:
    """Return two random motions of joints 1-3, and joint 1 to and fro at growing reach; the wrist stands."""
    robot, _ = load_robot("ur5e")
    found = {}
    for seed in (1, 2):
        m = fourier(robot, SECONDS, seed)
        q, qd, qdd = m.q.copy(), m.qd.copy(), m.qdd.copy()
        q[:, 3:], qd[:, 3:], qdd[:, 3:] = WRIST, 0.0, 0.0
        found[f"random_{seed}"] = Motion(q, qd, qdd)
    poses = [(-0.8, *pose, *WRIST) for pose in FOLDED_TO_STRETCHED]
    parts = [sweep(1, pose, -0.8, 0.8, (0.25, 0.5, 1.0)) for pose in poses]
    between = [move(np.array(a), np.array(b)) for a, b in pairwise(poses)]
    found["reach"] = join(parts[0], *(x for pair in zip(between, parts[1:], strict=True) for x in pair))
    return found


def simulated(robot: Robot, out: Path, name: str, plant: Plant) -> list[Path]:
    """Write a recording of every motion."""
    paths = []
    for seed, (motion, path) in enumerate(motions().items()):
        paths.append(out / f"{name}_{motion}.csv")
        simulate(robot, plant, path, rate=RATE, seed=seed).recording.write_csv(paths[-1])
    return paths


def samples(paths: list[Path], model: Model) -> Samples:
    """Return what the observer of a model leaves of the motor torque; friction is not taken off."""
    module = load_text(observer_text(model.model_copy(update={"term": (), "observer_gain": GAIN})))
    parts = []
    for path in paths:
        recording = read(path)
        seen, v = observe(recording, module), recording.qd[:, :3]
        keep = seen.settled & (np.abs(v).max(axis=1) > 0.02)
        friction = np.stack([np.sign(v) * (np.abs(v) > 0.01), v, v**2, v**3], axis=2)
        smooth = (low_passed(x) for x in (recording.q[:, :3], recording.target_qdd[:, :3], friction))
        q, qdd, friction = (x[keep] for x in smooth)
        parts.append((q, qdd, -seen.residual[keep], friction))
    return Samples(*(np.concatenate(x) for x in zip(*parts, strict=True)))


def low_passed(values: np.ndarray) -> np.ndarray:
    """Return values (T, ...) behind the observer's first-order filter."""
    share, found = 1 - np.exp(-GAIN / RATE), values.copy()
    for k in range(1, len(values)):
        found[k] = found[k - 1] + share * (values[k] - found[k - 1])
    return found


def gravity_column(s: Samples, joint: int) -> tuple[float, float]:
    """Return the thesis' alpha of a joint (0-based), Nm/rad, and the share of variance that it explains."""
    moves = s.moves(joint)
    plain, target = s.friction[moves, joint], s.left[moves, joint]
    both = np.column_stack([plain, s.q[moves, joint]])
    fits = [np.linalg.lstsq(w, target, rcond=None)[0] for w in (plain, both)]
    left = [np.mean((target - w @ x) ** 2) for w, x in zip((plain, both), fits, strict=True)]
    return float(fits[1][-1]), float(1 - left[1] / left[0])


def missing_inertia(s: Samples, lengths: Mapping[str, float]) -> tuple[np.ndarray, np.ndarray]:
    """Return mean reach |A + B| (BINS,) m, and the inertia that joint 1 lacks there (BINS,), kg m^2."""
    r = reach(s.q, lengths)
    edges = np.quantile(r, np.linspace(0, 1, BINS + 1))
    which = np.clip(np.searchsorted(edges, r, "right") - 1, 0, BINS - 1)
    turning = (which[:, None] == np.arange(BINS)) * s.qdd[:, :1]
    found = np.linalg.lstsq(np.hstack([s.friction[:, 0], turning]), s.left[:, 0], rcond=None)[0]
    return np.array([r[which == k].mean() for k in range(BINS)]), found[-BINS:]


def reach(q: np.ndarray, k: Mapping[str, float]) -> np.ndarray:
    """Return the thesis' |A + B| (T,), m: reach of the centres of mass of links 3 and 2."""
    return np.abs((k["l2"] + k["L2"]) * np.cos(q[:, 1]) + k["l3"] * np.cos(q[:, 1] + q[:, 2]))


def explained(paths: list[Path], model: Path, out: Path) -> tuple[list[str], Model]:
    """Run `residuum explain` against a nominal model; return the findings in words and the refined model."""
    residuum("explain", *map(str, paths), "--model", str(model), "--out", str(out))
    answer = json.loads((out / "findings.json").read_text(encoding="utf-8"))
    return [_words(f) for f in answer["findings"]], read_toml(Model, out / "model.toml")[0]


def _words(finding: dict) -> str:
    numbers = ", ".join(f"{n} {_value(x)} {x['unit']}" for n, x in finding["parameters"].items())
    alike = (
        f" (or {', '.join(finding['indistinguishable_from'])})" if finding["indistinguishable_from"] else ""
    )
    return f"{finding['effect']} on {finding['joints']}{alike}: {numbers}"


def _value(x: dict) -> str:
    return f"{x['value']}" if x["std"] is None else f"{x['value']} ± {x['std']}"


def by_angle(s: Samples, joint: int) -> tuple[list[float], list[float]]:
    """Return angle (rad) and mean of what is left without friction (Nm) in 25 slices of a joint's range."""
    moves = s.moves(joint)
    q, own, left = s.q[moves, joint], s.friction[moves, joint], s.left[moves, joint]
    both = np.column_stack([own, q, np.ones(len(q))])
    left = left - own @ np.linalg.lstsq(both, left, rcond=None)[0][:4]
    slices = np.array_split(np.argsort(q), 25)
    return [float(q[k].mean()) for k in slices], [float(left[k].mean()) for k in slices]


def draw(path: Path, seen: Mapping[str, Samples], lengths: Mapping[str, float]) -> None:
    """Draw both riddles: what joint 1's inertia lacks by reach, and what joints 2 and 3 keep by angle."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11, 3.6), layout="constrained")
    axes = figure.subplots(1, 3)
    for colour, (name, s) in zip(("#c0392b", "#e0a030", "#7fb2e5", "#0b3b6b"), seen.items(), strict=True):
        axes[0].plot(*missing_inertia(s, lengths), "o-", color=colour, label=name)
        for joint in (1, 2):
            axes[joint].plot(*by_angle(s, joint), "o-", ms=3, color=colour)
    axes[0].set(xlabel="reach |A+B|, m", ylabel="inertia that joint 1 lacks, kg m²", title="Riddle 1")
    for joint in (1, 2):
        axes[joint].set(xlabel=f"q{joint + 1}, rad", ylabel="left without friction, Nm")
        axes[joint].set_title(f"Riddle 2, joint {joint + 1}")
    axes[0].legend(fontsize=8)
    for axis in axes:
        axis.axhline(0, color="#888888", lw=0.8)
    figure.savefig(path, dpi=110)


def main() -> None:
    """Simulate, show the riddles, ask explain, draw."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    options.add_argument("--out", type=Path, default=Path("riddles"), help="folder for everything")
    out = options.parse_args().out
    out.mkdir(parents=True, exist_ok=True)
    robot, digest = load_robot("ur5e")
    models = {
        "thesis": nominal_model(robot, digest, 3, WRIST, variant="thesis"),
        "links 1-3": nominal_model(robot, digest, 3, WRIST, wrist="absent"),
        "all links": nominal_model(robot, digest, 3, WRIST),
    }
    lengths = {name: value.value for name, value in models["thesis"].base.items()}
    told = {"thesis": out / "thesis_model.toml", "all links": out / "all_links.toml"}
    for name, path in told.items():
        path.write_text(model_toml(models[name]), encoding="utf-8")
    loaded = tuple(effects.LoadDependentFriction(joint=j, coefficient=LOAD_FRICTION) for j in (2, 3))
    for name, plant in (("plain", Plant()), ("load_friction", Plant(load_dependent_friction=loaded))):
        paths = simulated(robot, out, name, plant)
        print(
            f"\n{name}. The thesis' scheme (residuum fit --scheme thesis) on all three runs, then on `reach`:"
        )
        for some in (paths, paths[-1:]):
            fitted = residuum("fit", *map(str, some), "--scheme", "thesis", "--out", str(out / "thesis.toml"))
            print(*(x for x in fitted.splitlines() if x.startswith(("position", "joint 1"))), sep="\n")
        found, refined = explained(paths, told["thesis"], out / f"{name}_explained")
        seen = {k: samples(paths, m) for k, m in (models | {"explained": refined}).items()}
        report(seen, lengths)
        print("explain, told the thesis' model:", *found, sep="\n  ")
        mass = (refined.base["MX2"].value - models["links 1-3"].base["MX2"].value) / robot.joint[1].a
        real = sum(j.mass for j in robot.joint[3:])
        print(f"  its rigid body has {mass:.3f} kg more beyond the elbow; links 4-6 weigh {real:.3f} kg")
        whole, _ = explained(paths, told["all links"], out / f"{name}_all_links")
        print("explain, told all links:", *whole, sep="\n  ")
        draw(out / f"{name}.png", seen, lengths)


def report(seen: Mapping[str, Samples], lengths: Mapping[str, float]) -> None:
    """Print both riddles under each model."""
    print(f"{'model':12}{'alpha 2, 3, Nm/rad':>20}{'its share, %':>16}   joint 1 lacks, kg m², by reach")
    for name, s in seen.items():
        (a2, s2), (a3, s3) = gravity_column(s, 1), gravity_column(s, 2)
        at, lack = missing_inertia(s, lengths)
        by = "  ".join(f"{r:.2f} m {x:+.2f}" for r, x in zip(at, lack, strict=True))
        print(f"{name:12}{a2:+10.2f}{a3:+10.2f}{100 * s2:8.0f}{100 * s3:8.0f}   {by}")


if __name__ == "__main__":
    main()
