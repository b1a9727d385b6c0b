"""One experiment: rest, approach, contact, detection, reaction; and what is measured of it."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..robots import Robot
from ..virtual import TICK, Simulator, Speed, State, Stop
from ..virtual.server.kinematics import Kinematics
from .cells import ACCELERATION, REST, TOUCH, Cell, Scene, plant, scene
from .detectors import Samples, Watch, first
from .reaction import Alarm, Reaction

Array = npt.NDArray[np.float64]
Trigger = Callable[[State, bool], Alarm | None]

#: s after contact that the impulse is summed over, that a run goes on, and that the joint has to stay slow.
IMPULSE_TIME, AFTER, STAYS = 1.0, 1.5, 0.05
#: rad/s: the joint has stopped below this; the guard's measure of rest. The thesis takes its noise band.
STOPPED = 0.01
#: s from the start during which the observer settles and nothing is watched: the guard does the same.
SETTLING = 0.5
#: s without contact after which a run is given up, beyond the time that the way should take.
GIVE_UP = 1.0


@dataclass(frozen=True)
class Trace:
    """A run: T cycles. time (T,) s; qd (T, N) rad/s as reported; external (T, N) Nm, force (T,) N: the truth.

    onset: time of first contact, s, NaN without; alarm: None when nothing was detected. fields: what RTDE
    reported, name -> (T, N).
    """

    cell: Cell
    time: Array
    force: Array
    onset: float
    alarm: Alarm | None
    fields: dict[str, Array]


@dataclass(frozen=True)
class Figures:
    """What is measured of a run: s, Ns, s, N, rad. early: the alarm came before the contact.

    delay is NaN without detection after contact; stop_time NaN when the joint does not rest in time.
    """

    delay: float
    impulse: float
    stop_time: float
    peak: float
    early: bool
    joint: int


class Closed:
    """A trigger: a detector in closed loop, cycle by cycle."""

    def __init__(self, watch: Watch) -> None:
        self._watch, (self._name,) = watch, watch.names

    def __call__(self, state: State, _touched: bool) -> Alarm | None:
        """Return the alarm when the detector sounds, None else."""
        score = self._watch.run(Samples.of(state.rtde))[self._name]
        found = first(score, 0)
        if found is None or state.time < SETTLING:
            return None
        return Alarm(state.time, found[1], float(np.sign(self._watch.residual[found[1] - 1])))


class AtTime:
    """A trigger that was worked out before: the same run, with the same noise, detects at the same time."""

    def __init__(self, alarm: Alarm | None) -> None:
        self._alarm = alarm

    def __call__(self, state: State, _touched: bool) -> Alarm | None:
        """Return the alarm when its time has come."""
        alarm = self._alarm
        return alarm if alarm is not None and state.time >= alarm.time - 1e-9 else None


class AfterContact:
    """A trigger some seconds after the contact: a protection of which only the delay is known."""

    def __init__(self, delay: float, joint: int) -> None:
        self._delay, self._joint, self._touched = delay, joint, np.inf

    def __call__(self, state: State, touched: bool) -> Alarm | None:
        """Return an alarm when the delay has passed."""
        if touched:
            self._touched = min(self._touched, state.time)
        late = state.time - self._touched >= self._delay - 1e-9
        return Alarm(state.time, self._joint, -1.0) if late else None


def drive(robot: Robot, cell: Cell, strategy: int | None, trigger: Trigger, after: float = AFTER) -> Trace:
    """Run one cell; strategy None goes on in spite of all."""
    here = scene(robot, cell)
    arm = Simulator(robot, plant(cell.condition), here.start, seed=1000 + cell.seed)
    arm.add_obstacle(here.obstacle)
    approach, rest = Speed(here.speeds, ACCELERATION), Stop()
    states: list[State] = []
    alarm: Alarm | None = None
    reaction: Reaction | None = None
    onset, end = np.nan, REST + 2.0 + GIVE_UP
    state = arm.step(rest)
    while state.time < end:
        states.append(state)
        touched = bool(state.truth["external"].any())
        if touched and np.isnan(onset):
            onset, end = state.time, state.time + after
        if alarm is None and (alarm := trigger(state, touched)) is not None and strategy is not None:
            reaction = Reaction(strategy, alarm, len(robot.joint))
        if reaction is not None:
            state = arm.step(reaction.command(state.rtde["actual_qd"], state.rtde["target_qd"]))
        else:
            state = arm.step(rest if state.time < REST else approach)
    return _trace(robot, cell, here, states, onset, alarm)


def _trace(
    robot: Robot, cell: Cell, here: Scene, states: list[State], onset: float, alarm: Alarm | None
) -> Trace:
    external = np.array([s.truth["external"] for s in states])
    link_q = np.array([s.truth["link_q"] for s in states])
    fields = {name: np.array([s.rtde[name] for s in states]) for name in states[0].rtde}
    force = contact_force(robot, here, external, link_q)
    return Trace(cell, np.array([s.time for s in states]), force, onset, alarm, fields)


def contact_force(robot: Robot, here: Scene, external: Array, q: Array) -> Array:
    """Return the force (T,) N along the obstacle's normal that gives these joint torques (T, N) Nm."""
    kinematics, tool = Kinematics(robot), np.eye(4)
    tool[:3, 3] = TOUCH
    normal = np.array(here.obstacle.normal)
    force = np.zeros(len(q))
    for k in np.flatnonzero(external.any(axis=1)):
        lever = kinematics.jacobian(q[k], tool)[:3].T @ normal
        force[k] = float(external[k] @ lever / (lever @ lever))
    return force


def measure(trace: Trace) -> Figures:
    """Return the figures of a run."""
    since = trace.time - trace.onset
    window = (since >= 0.0) & (since < IMPULSE_TIME)
    speed = np.abs(trace.fields["actual_qd"][:, trace.cell.joint - 1])
    alarm = trace.alarm
    early = alarm is not None and not alarm.time >= trace.onset
    return Figures(
        delay=np.nan if alarm is None or early else alarm.time - trace.onset,
        impulse=float(trace.force[window].sum() * TICK),
        stop_time=_stopped(since, speed),
        peak=float(trace.force.max(initial=0.0)),
        early=early,
        joint=0 if alarm is None else alarm.joint,
    )


def _stopped(since: Array, speed: Array) -> float:
    """Return the first time after contact from which the joint stays slow for a while, NaN without one."""
    need, slow = round(STAYS / TICK), (speed < STOPPED) & (since >= 0.0)
    total = np.concatenate([[0], np.cumsum(slow)])
    stays = np.flatnonzero(total[need:] - total[:-need] == need)
    return float(since[stays[0]]) if len(stays) else float("nan")
