"""The simulated robot as its controller sees it: power, safety, payload, tool, and one command a cycle."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ...robots import Robot
from ..command import Command, Freedrive, Stop
from ..controller import TICK
from ..model import RigidBody, symmetric
from ..plant import Plant
from ..simulator import Simulator, State
from .kinematics import Kinematics, transform

Array = npt.NDArray[np.float64]

HOME = (0.0, -1.5708, 1.5708, -1.5708, -1.5708, 0.0)  # rad
DEVIATION = 0.1
"""rad between target and actual angle that stops the robot (assumed; UR publishes no figure)."""
UNLOCK_AFTER = 5.0
"""s after a protective stop before it can be released (PolyScope's own rule)."""
STEADY = 0.5
"""s of rest that is_steady asks for (script manual 5.11)."""
BRAKING = 10.0
"""rad/s^2 when a program ends in motion (assumed)."""
SLOWING = TICK / 0.25
"""Change of the rate along a path in one cycle, for pauses and the speed slider (assumed)."""
CONTACT = 20.0
"""N at the tool that tool_contact takes for a contact (assumed)."""
RUNNING, IDLE, POWER_OFF = 7, 5, 3


@dataclass(frozen=True)
class Payload:
    """What the controller was told: mass (kg), centre (m), inertia xx, yy, zz, xy, xz, yz (kg m^2)."""

    mass: float = 0.0
    centre: tuple[float, ...] = (0.0, 0.0, 0.0)
    inertia: tuple[float, ...] = (0.0,) * 6


class Arm:
    """One robot under power.

    command: for the next cycle and until changed. state, before: the latest cycle and the one before.
    alarm: is called with the reason when the robot goes into a protective stop.
    speed_fraction: of the speed slider; held: a pause. rate: the part of its speed at which a path is
    followed now; it goes to speed_fraction, or to 0 when held, within 0.25 s.
    """

    def __init__(self, robot: Robot, plant: Plant, start: tuple[float, ...] = HOME, seed: int = 0) -> None:
        self.robot, self.kinematics = robot, Kinematics(robot)
        self.simulator = Simulator(robot, plant, np.array(start), seed)
        self._plant, self._seed = plant, seed
        self.command: Command = Stop()
        self.ticks = 0
        self.mode, self.protective_stop = RUNNING, False
        self.freedrive = False
        self.speed_fraction = self.rate = 1.0
        self.held = False
        self.tcp: tuple[float, ...] = (0.0,) * 6
        self.tool = np.eye(4)
        self.payload = Payload()
        self.alarm: Callable[[str], None] = lambda _reason: None
        self.history: deque[Array] = deque(maxlen=1000)
        self._rest = self._touch = 0
        self._stopped_at = 0.0
        self.state = self.before = self.simulator.step(self.command)
        self.zero = np.zeros(6)

    @property
    def time(self) -> float:
        """Time since the start in s: cycles times 2 ms."""
        return self.ticks * TICK

    @property
    def powered(self) -> bool:
        """Whether motors are on and brakes are off."""
        return self.mode == RUNNING

    @property
    def movable(self) -> bool:
        """Whether a program may run and move."""
        return self.powered and not self.protective_stop

    @property
    def steady(self) -> bool:
        """Whether nothing was asked to move for half a second."""
        return self._rest * TICK >= STEADY

    @property
    def touching(self) -> int:
        """Cycles since the tool began to feel more than 20 N; 0 without contact."""
        return self._touch

    @property
    def target(self) -> tuple[Array, Array]:
        """Reference angles (N,) rad and speeds (N,) rad/s."""
        return self.state.rtde["target_q"], self.state.rtde["target_qd"]

    @property
    def wrench(self) -> Array:
        """What the wrist sensor feels since it was zeroed (6,) N, Nm."""
        return np.asarray(self.state.rtde["actual_TCP_force"] - self.zero)

    def tick(self) -> None:
        """Let 2 ms pass."""
        command = self.command if self.movable else Stop(BRAKING)
        if self.freedrive and self.movable:
            command = Freedrive()
        self.before = self.state
        try:
            self.state = self.simulator.step(command)
        except FloatingPointError as error:
            self._recover(str(error))
        self.ticks += 1
        goal = 0.0 if self.held else self.speed_fraction
        self.rate += min(max(goal - self.rate, -SLOWING), SLOWING)
        self._watch()

    def release(self) -> None:
        """Forget what a program asked for: brake, and hold."""
        self.freedrive, self.command = False, Stop(BRAKING)

    def stop(self, reason: str) -> None:
        """Go into a protective stop: brake and hold until `unlock`."""
        if not self.protective_stop:
            self.protective_stop, self.freedrive = True, False
            self.command, self._stopped_at = Stop(BRAKING), self.time
            self.alarm(reason)

    def unlock(self) -> bool:
        """Leave a protective stop; not within 5 s after it."""
        if self.protective_stop and self.time - self._stopped_at < UNLOCK_AFTER:
            return False
        self.protective_stop = False
        return True

    def set_tcp(self, pose: tuple[float, ...]) -> None:
        """Say where the tool is at the flange (m, rotation vector in rad)."""
        self.tcp, self.tool = tuple(float(x) for x in pose), transform(pose)

    def set_payload(self, payload: Payload) -> None:
        """Say what hangs at the flange; the feed-forward follows, and the force sensor is zeroed."""
        self.payload, self.zero = payload, self.state.rtde["actual_TCP_force"].copy()
        xx, yy, zz, xy, xz, yz = payload.inertia
        body = RigidBody(payload.mass, np.array(payload.centre), symmetric((xx, yy, zz, xy, xz, yz)))
        self.simulator.declare(body if payload.mass > 0.0 else None)

    def _watch(self) -> None:
        rtde = self.state.rtde
        self.history.append(rtde["actual_q"])
        still = not self.freedrive and not rtde["target_qd"].any()
        self._rest = self._rest + 1 if still else 0
        force = self.wrench[:3]
        self._touch = self._touch + 1 if float(force @ force) > CONTACT**2 else 0
        gap = np.abs(rtde["target_q"] - rtde["actual_q"])
        if not self.freedrive and self.powered and float(gap.max()) > DEVIATION:
            joint = int(gap.argmax()) + 1
            self.stop(f"joint {joint} is {gap.max():.3f} rad off its target")

    def _recover(self, reason: str) -> None:
        """Set up the arm again at rest where it last was."""
        self.simulator = Simulator(self.robot, self._plant, self.state.rtde["actual_q"], self._seed)
        self.state = self.simulator.step(Stop())
        self.stop(reason)


def joints_of(state: State, name: str) -> tuple[float, ...]:
    """Return a field of a state as numbers."""
    return tuple(state.rtde[name].tolist())
