"""The arm's own controller: feed-forward from the nominal model, and a stiff servo in every joint.

It knows the robot file, the factory friction and a declared payload, and nothing of what is wrong with
this arm. Nominal torques come from MuJoCo's inverse dynamics.
"""

from math import pi, tanh

import mujoco

from ..robots import Robot
from .command import Command, Freedrive, Position, Speed, Stop, Torque
from .friction import Curve, Drag
from .model import Build, build_model, turned_inertia

TICK = 0.002  # s, the control cycle of an e-Series controller
BANDWIDTH = 12.0  # Hz, of the position loop at the median inertia; errors at 1.5 rad/s come out as in UR logs
DAMPING = 0.9  # of critical
INTEGRAL = 10.0  # rad/s, corner of the integral part
DIRECTION_SPEED = 0.01  # rad/s over which the Coulomb feed-forward changes sign
HELP_FROM, HELP_FULL = 0.02, 0.06  # rad/s between which freedrive takes over Coulomb friction


class Nominal:
    """What the controller believes: rigid body, rotors, friction and drive gains, N joints."""

    def __init__(self, robot: Robot, curves: list[Curve], build: Build) -> None:
        self._model = build_model(robot, build)
        self._data = mujoco.MjData(self._model)
        self._drags = [Drag(curve) for curve in curves]
        self._levels = [(c.high, -c.low) for c in curves]
        self.gains = [joint.drive_gain for joint in robot.joint]
        self.limits = [joint.max_torque / joint.drive_gain for joint in robot.joint]  # A
        self.rotors = [joint.reflected_inertia for joint in robot.joint]

    def load(self, robot: Robot, build: Build) -> None:
        """Change what is believed to be at the flange."""
        self._model = build_model(robot, build)
        self._data = mujoco.MjData(self._model)

    def moment(self, q: list[float], qd: list[float], qdd: list[float]) -> list[float]:
        """Return inverse dynamics with rotors, without friction (Nm), N each."""
        data = self._data
        data.qpos[:], data.qvel[:], data.qacc[:] = q, qd, qdd
        mujoco.mj_inverse(self._model, data)
        return list(data.qfrc_inverse.tolist())

    def friction(self, joint: int, qd: float) -> float:
        """Return the friction torque expected at a speed (Nm); its sign changes over 0.01 rad/s."""
        up, down = self._levels[joint]
        side = tanh(qd / DIRECTION_SPEED)
        return self._drags[joint](qd) + side * (up if side > 0 else down)

    def help(self, joint: int, qd: float, coulomb: float, viscous: float) -> float:
        """Return the friction (Nm) that freedrive may carry: parts of it, and none of Coulomb's near rest.

        Help by the sign of a speed that is about zero would shake the joint in its own presliding.
        """
        up, down = self._levels[joint]
        moving = min(max((abs(qd) - HELP_FROM) / (HELP_FULL - HELP_FROM), 0.0), 1.0)
        return viscous * self._drags[joint](qd) + coulomb * moving * (up if qd > 0 else -down)

    def inertia(self) -> list[float]:
        """Return what each joint has to turn at a median pose (kg m^2)."""
        return [float(x) for x in turned_inertia(self._model)[0]]


class Controller:
    """Turns commands into motor currents. Public lists (N each) are what RTDE calls target_*.

    q, qd, qdd: reference; moment: nominal torque without friction (Nm); current: feed-forward (A).
    """

    def __init__(self, nominal: Nominal, q: list[float]) -> None:
        self.nominal = nominal
        self.q, self.qd, self.qdd = list(q), [0.0] * len(q), [0.0] * len(q)
        self.moment, self.current = [0.0] * len(q), [0.0] * len(q)
        inertia, pole = nominal.inertia(), 2.0 * pi * BANDWIDTH
        self._stiffness = [j * pole**2 / k for j, k in zip(inertia, nominal.gains, strict=True)]  # A/rad
        self._damping = [2.0 * DAMPING * j * pole / k for j, k in zip(inertia, nominal.gains, strict=True)]
        self._integral = [0.0] * len(q)  # A
        self._bounds = [(-limit, limit) for limit in nominal.limits]
        self._servo = True

    def begin(self, command: Command, q: list[float], qd: list[float]) -> None:
        """Take a command for the next cycle, given measured angles (rad) and speeds (rad/s)."""
        if isinstance(command, Freedrive | Torque):
            self._servo = False
            self.q, self.qd, self.qdd = list(q), list(qd), [0.0] * len(q)
            self._without_servo(command, q, qd)
            return
        if not self._servo:  # take over from where the arm is, at the speed it has
            self._servo = True
            self.q, self.qd, self._integral = list(q), list(qd), [0.0] * len(q)
        if isinstance(command, Position):
            self.q, self.qd, self.qdd = list(command.q), list(command.qd), list(command.qdd)
        else:
            self._ramp(command)
        self._feed_forward()
        self._bound(command, q)

    def currents(self, ahead: float, dt: float, q: list[float], qd: list[float]) -> list[float]:
        """Return motor currents (A), `ahead` s into the cycle and for the next dt s, from measured motion."""
        if not self._servo:
            return list(self.current)
        out = []
        for k, (low, high) in enumerate(self._bounds):
            speed = self.qd[k] + ahead * self.qdd[k]
            error = self.q[k] + ahead * (self.qd[k] + 0.5 * ahead * self.qdd[k]) - q[k]
            i = (
                self.current[k]
                + self._stiffness[k] * error
                + self._damping[k] * (speed - qd[k])
                + self._integral[k]
            )
            if i > high:
                i = high
            elif i < low:
                i = low
            else:
                self._integral[k] += INTEGRAL * self._stiffness[k] * error * dt
            out.append(i)
        return out

    def _without_servo(self, command: Freedrive | Torque, q: list[float], qd: list[float]) -> None:
        nominal, n = self.nominal, len(q)
        self.moment = nominal.moment(q, [0.0] * n, [0.0] * n)
        if isinstance(command, Torque):
            torque = list(command.torque)
        else:
            torque = [
                self.moment[k]
                + nominal.help(k, qd[k], command.coulomb, command.viscous)
                - command.damping * nominal.rotors[k] * qd[k]
                for k in range(n)
            ]
        limits = zip(torque, nominal.gains, nominal.limits, strict=True)
        self.current = [max(-limit, min(limit, t / gain)) for t, gain, limit in limits]

    def _ramp(self, command: Speed | Stop) -> None:
        """Move the reference on by one cycle at bounded acceleration."""
        goal = command.qd if isinstance(command, Speed) else (0.0,) * len(self.q)
        most = TICK * (command.acceleration if isinstance(command, Speed) else command.deceleration)
        for k, target in enumerate(goal):
            change = max(-most, min(most, target - self.qd[k]))
            self.q[k] += TICK * (self.qd[k] + 0.5 * change)
            self.qd[k] += change
            self.qdd[k] = change / TICK

    def _feed_forward(self) -> None:
        nominal = self.nominal
        self.moment = nominal.moment(self.q, self.qd, self.qdd)
        self.current = [
            (self.moment[k] + nominal.friction(k, self.qd[k])) / gain for k, gain in enumerate(nominal.gains)
        ]

    def _bound(self, command: Command, q: list[float]) -> None:
        """Set the current limits; a torque-limited joint does not let its reference run away from it."""
        limits = self.nominal.limits
        self._bounds = [(-limit, limit) for limit in limits]
        if isinstance(command, Speed) and command.torque is not None:
            for k, torque in enumerate(command.torque):
                room = torque / self.nominal.gains[k]
                self._bounds[k] = (
                    max(-limits[k], self.current[k] - room),
                    min(limits[k], self.current[k] + room),
                )
                lead = room / self._stiffness[k]
                self.q[k] = max(q[k] - lead, min(q[k] + lead, self.q[k]))
