"""False alarms: hours of collision-free motion, a minute at a time, so that it can be stopped and resumed."""

import hashlib
import json
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np
import numpy.typing as npt

from ..robots import Robot
from ..virtual import TICK, motions, simulate
from .campaign import Progress, spread
from .cells import ACCELERATION, POSE, plant
from .detectors import DETECTORS, Eyes, Samples, Watch
from .published import SPEEDS
from .run import SETTLING

Array = npt.NDArray[np.float64]

#: thesis: each joint to and fro at the thesis' speeds. all: all joints at once, up to 1.5 rad/s.
MOTIONS = ("thesis", "all")
#: s of a piece; rad of a sweep; s of rest at its ends; s between two alarms that are not the same.
PIECE, SWEEP, DWELL, APART = 60.0, 0.8, 0.3, 1.0


@dataclass
class Quiet:
    """A piece or a sum of them. hours: of motion; alarms: detector -> count; peak: -> largest score seen."""

    hours: float = 0.0
    alarms: dict[str, int] = field(default_factory=dict)
    peak: dict[str, float] = field(default_factory=dict)

    def add(self, other: "Quiet") -> None:
        """Add another."""
        self.hours += other.hours
        for name, count in other.alarms.items():
            self.alarms[name] = self.alarms.get(name, 0) + count
            self.peak[name] = max(self.peak.get(name, 0.0), other.peak[name])


def path(robot: Robot, motion: str, number: int) -> motions.Motion:
    """Return the motion of one piece, about a minute."""
    if motion == "all":
        return motions.fourier(robot, PIECE, seed=500 + number)
    joint, speed = sorted((j, v) for (j, _), v in SPEEDS.items())[number % len(SPEEDS)]
    near, far = np.array(POSE), np.array(POSE)
    near += np.random.default_rng([number, 6]).uniform(-0.1, 0.1, len(near))
    far[:] = near
    far[joint - 1] += SWEEP
    there, back = (motions.move(a, b, speed, ACCELERATION) for a, b in ((near, far), (far, near)))
    once = motions.join(there, motions.still(far, DWELL), back, motions.still(near, DWELL))
    times = max(1, round(PIECE / once.duration))
    return motions.join(motions.still(near, 1.0), *([once] * times))


def piece(robot: Robot, seen: tuple[Eyes, ...], motion: str, number: int) -> dict[str, Quiet]:
    """Move for a minute; return what the detectors of every model made of it, by model."""
    recording = simulate(robot, plant("warm"), path(robot, motion, number), seed=9000 + number).recording
    x = Samples.of(recording.fields)
    return {eyes.name: _count(Watch(eyes).run(x)) for eyes in seen}


def _count(scores: dict[str, Array]) -> Quiet:
    begin = round(SETTLING / TICK)
    top = {name: score[begin:].max(axis=1) for name, score in scores.items()}
    alarms = {}
    for name, score in top.items():
        times = np.flatnonzero(score >= 1.0) * TICK
        alarms[name] = int(len(times) > 0) + int((np.diff(times) > APART).sum())
    hours = len(next(iter(top.values()))) * TICK / 3600.0
    return Quiet(hours, alarms, {name: float(score.max()) for name, score in top.items()})


def hour(
    robot: Robot,
    seen: tuple[Eyes, ...],
    minutes: int,
    cache: Path,
    workers: int,
    progress: Progress = lambda _done, _all: None,
) -> dict[tuple[str, str], Quiet]:
    """Return (motion, model) -> what some minutes of each motion gave; what is in `cache` is kept."""
    key = _key(robot, seen)
    todo = [(m, k) for m in MOTIONS for k in range(minutes)]
    tasks: list[Callable[[], dict[str, Quiet]]] = [
        partial(_cached, cache / f"{m}_{k:03d}_{key}.json", robot, seen, m, k) for m, k in todo
    ]
    out: dict[tuple[str, str], Quiet] = {}
    for (motion, _), found in zip(todo, spread(tasks, workers, progress), strict=True):
        for name, quiet in found.items():
            out.setdefault((motion, name), Quiet()).add(quiet)
    return out


def _cached(file: Path, robot: Robot, seen: tuple[Eyes, ...], motion: str, number: int) -> dict[str, Quiet]:
    if file.is_file():
        return {name: Quiet(**values) for name, values in json.loads(file.read_text("utf-8")).items()}
    found = piece(robot, seen, motion, number)
    temporary = file.with_suffix(".part")
    temporary.write_text(json.dumps({name: vars(quiet) for name, quiet in found.items()}), "utf-8")
    temporary.replace(file)
    return found


def _key(robot: Robot, seen: tuple[Eyes, ...]) -> str:
    """Name everything that a piece depends on, but for this code."""
    parts = [robot.model_dump_json(), str(DETECTORS)]
    for eyes in seen:
        limits = (eyes.static, eyes.speed, eyes.per_speed, eyes.current)
        parts += [eyes.name, eyes.text, str(eyes.gain), *(str(x.tolist()) for x in limits)]
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()[:12]
