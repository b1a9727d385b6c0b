"""What the robot does about a collision: the thesis' three strategies, as the guard carries them out."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..virtual import TICK, Command, Freedrive, Speed, Stop
from .published import RETRACT_ACCELERATION, RETRACT_SPEED

Array = npt.NDArray[np.float64]

STRATEGIES = {1: "stop and hold", 2: "stop, then freedrive", 3: "retract, then freedrive"}
#: The guard's own settings: rad/s^2 of the stop, s of retracting, rad/s of rest and s that it has to last.
DECELERATION, RETRACT_TIME, STILL, STILL_FOR, PATIENCE = 20.0, 0.3, 0.01, 0.02, 2.0


@dataclass(frozen=True)
class Alarm:
    """A detection: at which time (s), on which joint 1..N, and in which direction that is pushed (+-1)."""

    time: float
    joint: int
    direction: float


class Reaction:
    """The commands after an alarm, cycle by cycle. strategy: a key of STRATEGIES."""

    def __init__(self, strategy: int, alarm: Alarm, joints: int) -> None:
        self._alarm, self._joints = alarm, joints
        self._retract = strategy == 3
        self._free = strategy in (2, 3)
        self._still = self._cycles = 0
        self._phase = "stop"

    def command(self, qd: Array, target_qd: Array) -> Command:
        """Return the next command, given actual and target speeds (N,) rad/s."""
        self._cycles += 1
        if self._phase == "stop" and self._retract and not np.any(target_qd) and self._cycles > 1:
            self._phase, self._cycles, self._retract = "retract", 0, False
        if self._phase == "retract":
            if self._cycles * TICK < RETRACT_TIME:
                return self._away()
            self._phase, self._cycles = "stop", 0
        if self._phase == "stop" and self._free and not self._retract:
            self._still = self._still + 1 if float(np.abs(qd).max()) < STILL else 0
            if self._still * TICK >= STILL_FOR:
                self._phase = "free"
            elif self._cycles * TICK > PATIENCE:
                self._free = False
        return Freedrive() if self._phase == "free" else Stop(DECELERATION)

    def _away(self) -> Command:
        speeds = [0.0] * self._joints
        speeds[self._alarm.joint - 1] = self._alarm.direction * RETRACT_SPEED
        return Speed(tuple(speeds), RETRACT_ACCELERATION)
