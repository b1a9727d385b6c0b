"""The motion instructions of URScript, one control cycle a `yield`; each sets the arm's next command.

What the script manual leaves open is chosen here and said in docs/virtual_controller.md.
"""

# ruff: noqa: D102 - a method do_NAME is the instruction NAME of the script manual

from collections.abc import Iterator
from math import sqrt

import numpy as np
import numpy.typing as npt

from ...urscript import Fault, Motion, Pose, Value
from ...urscript.poses import matrix, number, vector
from ..command import Position, Speed, Stop
from ..controller import TICK
from ..motions import move
from .arm import BRAKING, Arm
from .kinematics import error, pose_of, transform

Array = npt.NDArray[np.float64]
TURNING = 1.05
"""rad/s that turning the tool may reach in a movel (assumed: the speed a movej has by default)."""
SERVO_ACCELERATION = 40.0
"""rad/s^2 that following a servoj target may take (assumed)."""
AT_REST = 1e-9  # rad/s


class Moves:
    """Motion instructions on one arm."""

    arm: Arm
    waypoint: tuple[float, ...]

    def do_movej(self, q: Value, a: Value, v: Value, t: Value, r: Value) -> Motion:
        goal = self._goal(q)
        yield from self._rest(number(a))
        start = self.arm.target[0].copy()
        way = float(np.abs(goal - start).max())
        if way > 0.0:
            speed, acceleration = _bounds(way, number(v), number(a), number(t))
            path = move(start, goal, speed, acceleration)
            yield from self._play([path.q, path.qd, path.qdd])
        return None

    def do_movel(self, pose: Value, a: Value, v: Value, t: Value, r: Value) -> Motion:
        target = self._frame(pose)
        self.waypoint = pose_of(target)
        yield from self._rest(BRAKING)
        start = self.arm.kinematics.forward(self.arm.target[0], self.arm.tool)
        way = error(target, start)
        length, turn = float(np.linalg.norm(way[:3])), float(np.linalg.norm(way[3:]))
        size = max(length, turn * number(v) / TURNING)
        if size > 1e-9:
            speed, acceleration = _bounds(size, number(v), number(a), number(t))
            path = move(np.zeros(1), np.array([size]), speed, acceleration)
            yield from self._line(start, way / size, path.q[:, 0], path.qd[:, 0])
        return None

    do_movep = do_movel

    def do_servoc(self, pose: Value, a: Value, v: Value, r: Value) -> Motion:
        yield from self.do_movel(pose, a, v, 0, r)
        yield
        return None

    def do_servoj(self, q: Value, a: Value, v: Value, t: Value, lookahead: Value, gain: Value) -> Motion:
        goal, pole = vector(q, 6), sqrt(min(max(number(gain), 100.0), 2000.0))
        limits = np.array([joint.max_speed for joint in self.arm.robot.joint])
        for _ in range(max(1, round(number(t) / TICK))):
            at, speed = self.arm.target
            pull = np.clip(pole**2 * (goal - at), -pole * limits, pole * limits) - 2.0 * pole * speed
            pull = np.clip(pull, -SERVO_ACCELERATION, SERVO_ACCELERATION)
            faster = np.clip(speed + TICK * pull, -limits, limits)
            self._follow(at + TICK * faster, faster, (faster - speed) / TICK)
            yield
        self.arm.command = Stop(SERVO_ACCELERATION)
        return None

    def do_speedj(self, qd: Value, a: Value, t: Value) -> Motion:
        goal = vector(qd, 6)
        self._check_speeds(goal)
        self._ready()
        self.arm.command = Speed(tuple(goal.tolist()), number(a))
        try:
            if t is not None:
                yield from _cycles(number(t))
            else:
                yield
                while not np.allclose(self.arm.target[1], goal, atol=AT_REST):
                    yield
                return None
        except GeneratorExit:
            self.arm.command = Stop(number(a))
            raise
        self.arm.command = Stop(number(a))
        return None

    def do_speedl(self, xd: Value, a: Value, t: Value, aRot: Value) -> Motion:
        goal = vector(xd, 6)
        cycles = None if t is None else max(1, round(number(t) / TICK))
        try:
            yield from self._cartesian_ramp(goal, number(a), cycles)
        finally:
            self.arm.command = Stop(BRAKING)
        return None

    def do_stopj(self, a: Value) -> Motion:
        self._ready()
        self.arm.command = Stop(max(number(a), 0.01))
        yield
        while float(np.abs(self.arm.target[1]).max()) > AT_REST:
            yield
        return None

    def do_stopl(self, a: Value, aRot: Value) -> Motion:
        yield from self._cartesian_ramp(np.zeros(6), number(a), None)
        yield from self.do_stopj(BRAKING)
        return None

    def do_direct_torque(
        self, torque: Value, friction_comp: Value, viscous_scale: Value, coulomb_scale: Value
    ) -> Motion:
        raise Fault("direct_torque is not simulated", "not-available")
        yield

    def _goal(self, target: Value) -> Array:
        """Return joint angles of a joint target or a pose."""
        if not isinstance(target, Pose):
            return vector(target, 6)
        found = self.arm.kinematics.inverse(transform(target), self.arm.target[0], self.arm.tool)
        if found is None:
            raise Fault(f"no joint angles bring the tool to p{list(target)}", "kinematics")
        return found

    def _frame(self, target: Value) -> Array:
        if isinstance(target, Pose):
            return transform(target)
        return self.arm.kinematics.forward(vector(target, 6), self.arm.tool)

    def _ready(self) -> None:
        if self.arm.freedrive:
            raise Fault("motion while freedrive is on; call end_freedrive_mode() first", "freedrive")

    def _rest(self, deceleration: float) -> Motion:
        """Come to rest before a path begins."""
        self._ready()
        if float(np.abs(self.arm.target[1]).max()) > AT_REST:
            yield from self.do_stopj(deceleration)
        return None

    def _play(self, path: list[Array]) -> Motion:
        """Follow q, qd, qdd (T, N), slowed by the speed slider."""
        try:
            for at, rate in self._pace(len(path[0])):
                low = min(int(at), len(path[0]) - 2)
                q, qd, qdd = (rows[low] + (at - low) * (rows[low + 1] - rows[low]) for rows in path)
                self._follow(q, rate * qd, rate**2 * qdd)
                yield
        finally:
            self.arm.command = Stop(BRAKING)
        return None

    def _pace(self, rows: int) -> Iterator[tuple[float, float]]:
        """Yield the place on a path of some rows, cycle by cycle, and the part of full speed."""
        at = 0.0
        while at < rows - 1:
            rate = self.arm.rate
            at = min(at + rate, rows - 1.0)
            yield at, rate

    def _line(self, start: Array, direction: Array, way: Array, speed: Array) -> Motion:
        """Follow a straight line; direction (6,) per metre, way (T,) m, speed (T,) m/s."""
        try:
            for at, rate in self._pace(len(way)):
                low = min(int(at), len(way) - 2)
                s = way[low] + (at - low) * (way[low + 1] - way[low])
                frame = np.eye(4)
                frame[:3, 3] = start[:3, 3] + s * direction[:3]
                frame[:3, :3] = matrix(s * direction[3:]) @ start[:3, :3]
                self._track(frame, rate * float(speed[low]) * direction)
                yield
        finally:
            self.arm.command = Stop(BRAKING)
        return None

    def _cartesian_ramp(self, goal: Array, acceleration: float, cycles: int | None) -> Motion:
        """Bring the tool's speed (6,) to a goal and keep it for some cycles, or until it is reached."""
        self._ready()
        kinematics = self.arm.kinematics
        q, qd = self.arm.target
        twist = kinematics.jacobian(q, self.arm.tool) @ qd
        passed = 0
        while True:
            change = goal - twist
            size = float(np.linalg.norm(change))
            twist = twist + change * min(1.0, acceleration * TICK / size) if size > 0.0 else goal
            frame = kinematics.forward(q, self.arm.tool)
            frame[:3, 3] += TICK * twist[:3]
            frame[:3, :3] = matrix(TICK * twist[3:]) @ frame[:3, :3]
            q = self._track(frame, twist)
            yield
            passed += 1
            if passed >= cycles if cycles is not None else size <= acceleration * TICK:
                return None

    def _track(self, frame: Array, twist: Array) -> Array:
        """Ask for a tool frame and its speed; return the joint angles."""
        arm = self.arm
        before, speed = arm.target
        q = arm.kinematics.follow(frame, before, arm.tool)
        if q is None:
            raise Fault("the path leaves the robot's reach, or meets a singularity", "kinematics")
        jacobian = arm.kinematics.jacobian(q, arm.tool)
        qd = jacobian.T @ np.linalg.solve(jacobian @ jacobian.T + 1e-9 * np.eye(6), twist)
        self._follow(q, qd, (qd - speed) / TICK)
        return q

    def _follow(self, q: Array, qd: Array, qdd: Array) -> None:
        self._ready()
        self._check_speeds(qd)
        self.arm.command = Position(tuple(q.tolist()), tuple(qd.tolist()), tuple(qdd.tolist()))

    def _check_speeds(self, qd: Array) -> None:
        for number_, (speed, joint) in enumerate(zip(qd, self.arm.robot.joint, strict=True), start=1):
            if abs(speed) > 1.001 * joint.max_speed:
                raise Fault(
                    f"joint {number_} would turn at {speed:.2f} rad/s; it may {joint.max_speed:.2f}", "speed"
                )


def _cycles(seconds: float) -> Motion:
    for _ in range(max(1, round(seconds / TICK))):
        yield
    return None


def _bounds(way: float, speed: float, acceleration: float, duration: float) -> tuple[float, float]:
    """Return speed and acceleration of a move; a duration (s) above 0 goes before both."""
    if duration > 0.0:
        return way / (duration * 2.0 / 3.0), way / (duration * 2.0 / 3.0) / (duration / 3.0)
    if speed <= 0.0 or acceleration <= 0.0:
        raise Fault(f"a move needs speed and acceleration above 0, not {speed} and {acceleration}", "domain")
    return speed, acceleration
