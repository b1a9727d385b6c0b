"""Running a generated guard, and the same detectors in NumPy."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from residuum.codegen import guard
from residuum.codegen.functions import listings, symbolic_model
from residuum.codegen.generate import render, urscripts
from residuum.codegen.load import load_text
from residuum.codegen.options import Options
from residuum.robots import load_robot
from residuum.robots.model import TermData, Thresholds
from residuum.symbolic.nominal import nominal_model
from residuum.urscript import Array, Dialect, Machine, RecordedWorld

FRICTION = (("coulomb", {"Fc": 7.25}), ("viscous", {"Fv": 9.125}))
WITHOUT_LIMIT = 1e6


def model_of(robot: str, dof: int, static: float, per_speed: float = 0.0, friction: bool = True):
    """A model with Coulomb and viscous friction and the same threshold (Nm) on every joint."""
    terms = [TermData(name=n, joint=j, parameters=p) for j in range(1, dof + 1) for n, p in FRICTION]
    limits = Thresholds(static=(static,) * dof, per_speed=(per_speed,) * dof)
    update = {"thresholds": limits, "term": tuple(terms) if friction else ()}
    return nominal_model(*load_robot(robot), dof).model_copy(update=update)


class Printer:
    """Prints the same model with many options, deriving it once."""

    def __init__(self, model) -> None:
        self.symbolic = symbolic_model(model)
        self.listings = listings(self.symbolic)

    def scripts(self, **options) -> dict[str, str]:
        return urscripts(self.symbolic, self.listings, Options(**options))

    def guard(self, **options) -> str:
        return self.scripts(**options)["collision_guard.script"]

    @cached_property
    def observer(self):
        return load_text(render(self.symbolic, self.listings, Options()).files["observer.py"])


@dataclass
class Track:
    """What the guard told in each step that it told anything: frames (T,), residual and score (T, N)."""

    frames: np.ndarray
    states: np.ndarray
    residual: np.ndarray
    score: np.ndarray
    limit: np.ndarray
    joint: int

    @property
    def begin(self) -> int:
        """Number of the first step with state 2."""
        return int(np.argmax(self.states == 2))


def track(text: str, world, frames: int, dof: int, dialect: Dialect | None = None) -> Track:
    """Run until the guard reacts, at most so many frames."""
    machine, rows, told = Machine(text, world, dialect), [], 0
    for frame in range(frames):
        machine.frame()
        out = world.outputs
        state = out.get(("integer", guard.INTEGERS["state"]), 0)
        if out.get(("integer", guard.INTEGERS["frame"]), 0) != told:
            told = out["integer", guard.INTEGERS["frame"]]
            numbers = [
                [out["float", guard.FLOATS[x] + k] for k in range(dof)]
                for x in ("residual", "score", "limit")
            ]
            rows.append((frame, state, *numbers))
        if machine.finished or state > 2:
            break
    columns = [np.array(x) for x in zip(*rows, strict=True)]
    return Track(*columns, joint=world.outputs["integer", guard.INTEGERS["joint"]])


def scores(detector: str, residual, limit, qd, target_qd) -> np.ndarray:
    """What the guard calls score, (T, N): 1.0 and more is a collision."""
    if detector in ("static", "speed"):
        return np.abs(residual) / limit
    by_velocity = np.abs(target_qd - qd) / guard.SPEED_DEVIATION
    if detector == "velocity":
        return by_velocity
    by_sum = cusum(residual / limit) / guard.CUSUM_TIME
    if detector == "cusum":
        return by_sum
    return (1.0 * (np.abs(residual) >= limit) + (by_sum >= 1) + (by_velocity >= 1)) / guard.VOTES


def cusum(share, drift: float = guard.CUSUM_DRIFT, dt: float = 0.002) -> np.ndarray:
    """Page's test on either side, the larger sum (T, N) in s."""
    up = np.zeros(share.shape[1])
    down, sums = up.copy(), []
    for row in share:
        up = np.maximum(0.0, up + (row - drift) * dt)
        down = np.maximum(0.0, down - (row + drift) * dt)
        sums.append(np.maximum(up, down))
    return np.array(sums)


def first_detection(score) -> tuple[int, int]:
    """(step, joint 1..N) of the first collision; (-1, 0) without one."""
    hit = np.flatnonzero(score.max(axis=1) >= 1.0)
    return (int(hit[0]), int(score[hit[0]].argmax()) + 1) if len(hit) else (-1, 0)


@dataclass
class Rows:
    """A motion at 500 Hz, (T, 6) each; currents in whole mA, as registers give them."""

    q: np.ndarray
    qd: np.ndarray
    current: np.ndarray
    target_qd: np.ndarray

    def world(self, **options) -> RecordedWorld:
        return RecordedWorld(self.q, self.qd, self.current, rtde={"target_qd": self.target_qd}, **options)

    def back(self, steps: int) -> "Rows":
        """As get_rtde_value gives them: so many steps ago."""
        at = np.maximum(np.arange(len(self.q)) - steps, 0)
        return Rows(self.q[at], self.qd[at], self.current[at], self.target_qd[at])


def after_rest(observer, q, qd, current, target_qd, rest: int = 320) -> Rows:
    """Let a motion begin with a rest in which the model is right, with noise on the currents."""
    random = np.random.default_rng(0)
    dof, still = observer.DOF, np.zeros((rest, 6))
    before = still + q[0]
    idle = 0.02 * random.standard_normal((rest, 6))
    idle[:, :dof] += observer.gravity(before[:, :dof]) / observer.GAINS
    return Rows(
        np.concatenate([before, q]),
        np.concatenate([still, qd]),
        np.round(np.concatenate([idle, current]), 3),
        np.concatenate([still, target_qd]),
    )


def simulated(observer, seconds: float = 3.0, push: float = 60.0, at: float = 2.0, dof: int = 6) -> Rows:
    """All joints swing as the model says; from `at` (s) on, joint 2 is pushed (Nm) and falls behind."""
    t = np.arange(0.0, seconds, 0.002)
    turn = np.array([0.5, 0.3, 0.4, 0.6, 0.5, 0.7])
    angle = 1.3 * (t - np.sin(t))[:, None]
    rate = 1.3 * (1 - np.cos(t))[:, None]
    q = np.array([0.3, -1.4, 1.1, -0.7, 1.2, 0.2]) + turn * np.sin(angle)
    target_qd = turn * rate * np.cos(angle)
    target_qdd = np.gradient(target_qd, 0.002, axis=0)
    qd = target_qd.copy()
    late = np.clip(t - at, 0.0, None)
    qd[:, 1] -= 0.8 * late
    joints = slice(0, dof)
    torque = observer.inverse_dynamics(q[:, joints], qd[:, joints], target_qdd[:, joints])
    torque = torque + observer.friction(q[:, joints], qd[:, joints])
    torque[:, 1] += push * (t > at)
    current = np.zeros_like(q)
    current[:, joints] = torque / observer.GAINS
    return after_rest(observer, q, qd, current, target_qd)


def real(observer, recording, seconds: float | None = None) -> Rows:
    """A recording brought to 500 Hz, after a rest; the target speed, where missing, is a running mean."""
    end = recording.timestamp[-1] if seconds is None else recording.timestamp[0] + seconds
    t = np.arange(recording.timestamp[0], end, 0.002)

    def at(rows):
        return np.stack([np.interp(t, recording.timestamp, x) for x in rows.T], axis=1)

    qd = at(recording.qd)
    width = np.ones(25) / 25
    target = np.stack([np.convolve(x, width, "same") for x in qd.T], axis=1)
    return after_rest(observer, at(recording.q), qd, at(recording.current), target)


def then_rest(observer, rows: Rows, at: int, rest: int = 4000) -> Rows:
    """Cut a motion and let it end with a rest in which the model is right."""
    end = after_rest(observer, rows.q[at : at + 1], *(np.zeros((1, 6)),) * 3, rest=rest)
    return Rows(
        *(
            np.concatenate([getattr(rows, x)[:at], getattr(end, x)])
            for x in ("q", "qd", "current", "target_qd")
        )
    )


class Arm(RecordedWorld):
    """A robot that takes time to stop, and notes what happens when.

    log: (frame, what). settle: steps from the stop's beginning to rest, None never.
    """

    def __init__(self, rows: Rows, settle: int | None = 80, **options) -> None:
        super().__init__(
            rows.q.copy(), rows.qd.copy(), rows.current.copy(), rtde={"target_qd": rows.target_qd}, **options
        )
        self.log: list[tuple[int, str]] = []
        self.settle = settle
        self.stopped: int | None = None

    def note(self, what: str) -> None:
        self.log.append((self.frame, what))

    def when(self, what: str) -> int:
        return next(frame for frame, said in self.log if said == what)

    @property
    def swing(self) -> float:
        """Speed of all joints after a stop, rad/s."""
        if self.stopped is None:
            return 0.0
        if self.settle is None:
            return 0.2
        return max(0.0, 0.2 * (1 - (self.frame - self.stopped) / self.settle))

    def do_get_actual_joint_speeds(self):
        return Array((self.swing,) * 6) if self.swing else super().do_get_actual_joint_speeds()

    def do_stopj(self, a):
        self.note("stopj")
        self.stopped = self.frame if self.stopped is None else self.stopped
        for _ in range(30):
            yield

    def do_speedj(self, qd, a, t):
        self.note(f"speedj {[float(x) for x in qd]} {a} {t}")
        for _ in range(round(t / 0.002)):
            yield

    def do_movej(self, q, a, v, t, r):
        self.note("movej")
        for _ in range(50):
            yield

    def do_freedrive_mode(self, axes, feature):
        self.note("freedrive")
        super().do_freedrive_mode(axes, feature)

    def do_end_freedrive_mode(self):
        self.note("end freedrive")
        super().do_end_freedrive_mode()

    def do_get_standard_digital_in(self, n):
        return self.digital.get(("standard in", n), False)

    @property
    def state(self) -> int:
        return self.outputs.get(("integer", guard.INTEGERS["state"]), 0)

    @property
    def reason(self) -> int:
        return self.outputs.get(("integer", guard.INTEGERS["reason"]), 0)


def run_until(machine: Machine, world: Arm, state: int, frames: int = 6000) -> int:
    """Run until the guard tells a state; return the frame, or fail."""
    for _ in range(frames):
        machine.frame()
        if world.state == state:
            return world.frame - 1
        if machine.finished:
            break
    raise AssertionError(f"state {state} was not reached; it is {world.state}, reason {world.reason}")
