"""The whole chain on a virtual robot: record, fit, explain, generate, upload, collide, freedrive.

A healthy arm and one with a hidden payload and more friction stand behind `residuum serve`; every step is the
command that a user types, in a process of its own. Nothing is shared but files and sockets. It takes two to
three minutes and ends with 1 at the first step that does not do what it should.

    python examples/whole_chain.py --out chain
"""

import argparse
import json
import sys
import time
from pathlib import Path

import numpy as np
import tomli_w
from processes import StepError, residuum, robot
from whole_chain_guard import Seen, guard_motion, obstacle, watch

from residuum.errors import InputError
from residuum.robots import load_robot
from residuum.virtual.motions import HOME, random_poses

MASS, FRICTION_JOINT, FRICTION = 2.5, 2, 3.0
"""What is hidden: kg at the flange, and Nm of Coulomb friction more on a joint."""
HIDDEN = {
    "payload": {"mass": MASS, "centre_of_mass": [0.0, 0.0, 0.06]},
    "coulomb_friction": [{"joint": FRICTION_JOINT, "torque": FRICTION}],
}
RATE, SPEED = 125, 8  # Hz of the recordings; times real time while they are made
FIT = ("--term", "stribeck", "--false-alarms", "2")
"""2 an hour and joint lie beyond what two minutes of recording show; a robot at work needs hours of them."""
STATES = {1: "measuring", 2: "guarding", 3: "stopping", 5: "holding", 6: "freedrive", 7: "refused"}


def told(step: str, started: float, result: str) -> None:
    """Print a step's line."""
    print(f"{step:28} {time.monotonic() - started:5.1f} s  {result}", flush=True)


def motion_program(dof: int, seed: int) -> str:
    """Return a URScript program that moves the first `dof` joints through random poses, over and over."""
    data, _ = load_robot("ur5e")
    poses = random_poses(data, 14, seed)
    poses[:, dof:] = HOME[dof:]
    speeds = np.random.default_rng(seed).permutation(np.geomspace(0.15, 1.5, len(poses)))
    lines = [
        f"    movej([{', '.join(f'{x:.4f}' for x in pose)}], a=3.0, v={v:.3f})"
        for pose, v in zip(poses, speeds, strict=True)
    ]
    return "\n".join(["def motion():", "  while True:", *lines, "    sleep(0.5)", "  end", "end", ""])


def recorded(out: Path, plant: Path, seconds: float, dof: int, seed: int) -> list[str]:
    """Serve a plant, run two motions on it and record both."""
    files = []
    for k in (1, 2):
        file, script = out / f"{plant.stem}_{k}.csv", out / f"motion_{k}.script"
        script.write_text(motion_program(dof, k), encoding="ascii")
        started = time.monotonic()
        with robot(plant, speed=SPEED, seed=seed + k) as host:
            residuum("upload", str(script), "--host", host)
            said = residuum(
                "record", "--host", host, "--seconds", str(seconds), "--rate", str(RATE), "--out", str(file)
            )
        told(f"record {plant.stem} {k}", started, said.split(": ", 1)[1])
        if "0 lost, 0 repeated" not in said:
            raise StepError(f"{file}: packages are missing: {said}")
        files.append(str(file))
    return files


def explained(model: Path, changed: list[str], healthy: list[str]) -> None:
    """Explain what changed, and check that payload and friction are named; say what else is named."""
    started = time.monotonic()
    references = [x for file in healthy for x in ("--reference", file)]
    residuum("explain", *changed, *references, "--model", str(model), "--out", str(model.parent / "answer"))
    answer = json.loads((model.parent / "answer" / "findings.json").read_text(encoding="utf-8"))
    named = {(f["effect"], tuple(f["joints"])): f for f in answer["findings"]}
    told("explain", started, f"{answer['verdict']}: " + "; ".join(map(_short, answer["findings"])))
    load = next((f for (effect, _), f in named.items() if effect == "payload"), None)
    if load is None:
        raise StepError("explain named no payload")
    mass = load["parameters"]["mass"]
    if abs(mass["value"] - MASS) > 2 * mass["std"]:
        raise StepError(f"the payload's interval {mass} does not hold {MASS} kg")
    if ("coulomb_friction", (FRICTION_JOINT,)) not in named:
        raise StepError(f"explain did not name the friction of joint {FRICTION_JOINT}")
    wrong = [effect for effect, _ in named if effect not in HIDDEN]
    if wrong:
        print(f"{'':37}it also named what was not hidden: {', '.join(wrong)}", flush=True)


def _short(finding: dict) -> str:
    numbers = [
        f"{n} {x['value']} {x['unit']}" for n, x in finding["parameters"].items() if n in ("mass", "Fc")
    ]
    joints = "all" if len(finding["joints"]) > 2 else ", ".join(map(str, finding["joints"]))
    return f"{finding['effect']} (joint {joints}) {', '.join(numbers)}".rstrip()


def generated(out: Path, model: Path, name: str) -> Path:
    """Generate the guard of a model; return its script."""
    started = time.monotonic()
    motion = out / "guarded_motion.script"
    motion.write_text(guard_motion(), encoding="ascii")
    said = residuum(
        "--model", str(model), "--motion", str(motion), "--reaction", "freedrive", "--out", str(out / name),
        verb="gen-model",
    )  # fmt: skip
    told(f"gen-model {name}", started, said.splitlines()[-1])
    return next((out / name).glob("*/collision_guard.script"))


def guarded(plant: Path, script: Path, seconds: float, step: str) -> Seen:
    """Upload a guard to a fresh robot and watch its registers for some seconds of the robot's time."""
    started = time.monotonic()
    with robot(plant, speed=1, seed=9) as host:
        seen = watch(host, seconds, lambda: residuum("upload", str(script), "--host", host))
    told(step, started, seen.text(STATES))
    return seen


def chain(out: Path, seconds: float, dof: int) -> None:
    """Do all of it; raises StepError at the first step that fails."""
    (out / "plants").mkdir(parents=True, exist_ok=True)
    plants = {"healthy": {}, "changed": HIDDEN, "obstructed": HIDDEN | {"obstacle": [obstacle()]}}
    paths = {name: out / "plants" / f"{name}.toml" for name in plants}
    for name, plant in plants.items():
        paths[name].write_text(tomli_w.dumps(plant), encoding="utf-8")
    healthy = recorded(out, paths["healthy"], seconds, dof, 10)
    changed = recorded(out, paths["changed"], seconds, dof, 20)
    started, model = time.monotonic(), out / "healthy.toml"
    said = residuum("fit", *healthy, "--dof", str(dof), *FIT, "--out", str(model)).splitlines()
    told("fit", started, next(" ".join(x.split()) for x in said if x.startswith("threshold, Nm")))
    explained(model, changed, healthy)
    before = generated(out, model, "before")
    after = generated(out, out / "answer" / "model.toml", "after")
    collided(paths["changed"], paths["obstructed"], before, after)


def collided(free: Path, obstructed: Path, before: Path, after: Path) -> None:
    """Run the guards: the old one must not be content, the new one quiet until there is something to hit."""
    blind = guarded(free, before, 12.0, "changed arm, old guard")
    if (blind.states[-1:], blind.reason) != ([7], 8) and 3 not in blind.states:
        raise StepError(f"the guard that does not know the payload neither refused nor alarmed: {blind}")
    quiet = guarded(free, after, 20.0, "changed arm, new guard")
    if quiet.states != [1, 2]:
        raise StepError(f"the guard of the explained model did not guard quietly: {quiet}")
    hit = guarded(obstructed, after, 20.0, "collision, new guard")
    if hit.states != [1, 2, 3, 6] or not 0.0 < hit.delay < 0.2:
        raise StepError(f"no collision with freedrive after it: {hit}")
    print(f"done: detected {1e3 * hit.delay:.0f} ms after 5 N at the wrist, then freedrive", flush=True)


def main() -> None:
    """Read the options and run the chain."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    options.add_argument("--out", type=Path, default=Path("chain"), help="folder for everything")
    options.add_argument("--seconds", type=float, default=60.0, help="length of each of four recordings")
    options.add_argument("--dof", type=int, default=6, choices=(3, 4, 5, 6), help="moving joints")
    given = options.parse_args()
    try:
        chain(given.out, given.seconds, given.dof)
    except (StepError, InputError) as error:
        sys.exit(f"failed: {error}")


if __name__ == "__main__":
    main()
