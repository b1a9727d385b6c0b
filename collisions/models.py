"""What the detectors know: models fitted to collision-free motion of the same virtual robot.

rigid: the published rigid body, no friction. plain: with Coulomb and viscous friction fitted. refined: also
Stribeck friction; and for a robot that is cold, hot or loaded, fitted to recordings of it in that state.
"""

import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from ..codegen.generate import observer_text
from ..identify.baseline import Options
from ..identify.requests import parse_request
from ..identify.thresholds import Residual, fit_thresholds
from ..identify.workflow import Task, run
from ..robots import Robot
from ..robots.model import Model, Thresholds
from ..symbolic.nominal import nominal_model
from ..virtual import Recording, motions, simulate
from .cells import POSE, plant
from .detectors import Eyes, Samples, Watch

Array = npt.NDArray[np.float64]

MODELS = ("rigid", "plain", "refined")
#: Joint speeds (rad/s) and width (rad) of the sweeps, and s of the motion of all joints.
SWEEPS, WIDTH, FOURIER = (0.1, 0.25, 0.5, 1.0), 0.8, 60.0
#: False alarms per hour and joint that fitted limits are for; what `residuum fit` takes by default.
PER_HOUR = 1.0


@dataclass(frozen=True)
class Known:
    """A model with the limits that its detectors have. current: limits (N,) Nm of the current difference."""

    name: str
    model: Model
    current: tuple[float, ...]


def free_recordings(robot: Robot, condition: str) -> list[Recording]:
    """Return collision-free motion in a condition: sweeps of every joint, and two of all joints."""
    sweeps = []
    for joint in range(len(robot.joint)):
        low = POSE[joint]
        sweeps.append(motions.sweep(joint + 1, POSE, low, low + WIDTH, SWEEPS))
    paths = [motions.join(*sweeps), *(motions.fourier(robot, FOURIER, seed=11 + k) for k in range(2))]
    return [simulate(robot, plant(condition), m, seed=31 + k).recording for k, m in enumerate(paths)]


def calibrate(robot: Robot, digest: str, kind: str, condition: str = "warm") -> Known:
    """Fit a model of MODELS in a condition, with limits from the same recordings.

    A refined model of a cold or hot robot is fitted to both and to a warm one, with the term that knows of
    temperature.
    """
    thermal = kind == "refined" and condition in ("cold", "hot")
    conditions = ("warm", "cold", "hot") if thermal else (condition,)
    free = [r for c in conditions for r in free_recordings(robot, c)]
    name = kind if condition == "warm" else f"{kind}-{'thermal' if thermal else condition}"
    if kind == "rigid":
        model = _with_limits(nominal_model(robot, digest, len(robot.joint)), free)
    else:
        terms = {"plain": (), "refined": ("stribeck",)}[kind]
        model = _fit(robot, digest, free, (*terms, *(("temperature_dependent",) if thermal else ())))
    watch = eyes(Known(name, model, (1.0,) * model.dof), 1.0)
    sizes = [_current(watch, r) for r in free]
    return Known(name, model, _limits(sizes, "the current difference").static_only or ())


def eyes(known: Known, gain: float) -> Eyes:
    """Return what detectors see with; gain (1/s) is that of the thesis' detector."""
    limits = known.model.thresholds
    assert limits is not None
    n = known.model.dof
    return Eyes(
        known.name,
        observer_text(known.model),
        static=np.array(limits.static_only or limits.static),
        speed=np.array(limits.static),
        per_speed=np.array(limits.per_speed or (0.0,) * n),
        current=np.array(known.current),
        gain=gain,
    )


def supplied(model: Model, current: tuple[float, ...]) -> Known:
    """Return a model of the user's; without thresholds, a fifth of the rated torque stands in."""
    if model.thresholds is None:
        limits = Thresholds(static=tuple(0.2 * j.max_torque for j in model.joint))
        model = model.model_copy(update={"thresholds": limits})
    return Known("supplied", model, current)


def _fit(robot: Robot, digest: str, free: list[Recording], terms: tuple[str, ...]) -> Model:
    n = len(robot.joint)
    options = Options(tuple(parse_request(t, n) for t in terms), "momentum", 10.0, 4, True)
    with tempfile.TemporaryDirectory() as folder:
        paths = tuple(Path(folder) / f"free_{k}.csv" for k in range(len(free)))
        for path, recording in zip(paths, free, strict=True):
            recording.write_csv(path)
        _, model = run(Task(paths, robot, digest, n, options, false_alarms=PER_HOUR, workers=1))
    return model


def _with_limits(model: Model, free: list[Recording]) -> Model:
    """Give a model the limits that its own residual on these recordings asks for."""
    blank = model.model_copy(update={"thresholds": Thresholds(static=(1.0,) * model.dof)})
    watch = eyes(Known("rigid", blank, (1.0,) * model.dof), 1.0)
    sizes = []
    for r in free:
        x = Samples.of(r.fields)
        residual = watch.observer.Observer().run(x.q, x.qd, x.current, x.heat)
        sizes.append(_residual(r, residual))
    return model.model_copy(update={"thresholds": _limits(sizes, "nothing: no friction is known")})


def _current(watch: Eyes, recording: Recording) -> Residual:
    x = Samples.of(recording.fields)
    return _residual(recording, Watch(watch, ("current",)).current_torque(x))


def _residual(recording: Recording, torque: Array) -> Residual:
    settled = 200  # samples: ten time constants
    time = recording["timestamp"][settled:]
    return Residual(time, np.abs(torque[settled:]), np.abs(recording["actual_qd"][settled:]))


def _limits(sizes: list[Residual], what: str) -> Thresholds:
    return fit_thresholds(sizes, PER_HOUR, np.ones(sizes[0].size.shape[1]), what)


def at_gain(seen: Eyes, gain: float) -> Eyes:
    """Return the same with another gain of the thesis' detector."""
    return replace(seen, gain=gain)
