"""What a program on the virtual controller sees: the simulated robot, its registers and outputs."""

# ruff: noqa: D102 - a method do_NAME is the instruction NAME of the script manual

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from ...urscript import Array, Fault, IdleWorld, Pose, Value, catalogue
from ...urscript.poses import number, vector
from ...urscript.strings import to_str
from .arm import Arm, Payload, joints_of
from .dynamics import Dynamics
from .fields import output_type
from .kinematics import pose_of, transform
from .moves import Moves
from .snapshot import Snapshot

JOINTS = 6
PORT_REGISTERS = {
    270: ("actual_q", 1e3),
    280: ("actual_qd", 1e3),
    290: ("actual_current", 1e3),
    300: ("joint_temperatures", 1.0),
}
"""First register of the joints -> field and scale: mrad, mrad/s, mA, deg C (UR article 16377)."""


class RobotWorld(Moves, IdleWorld):
    """The world of all programs of one controller.

    version: of the controller. say: takes what textmsg and popup say. signed: how a negative port register
    appears; the script manual says signed, the Modbus article unsigned.
    Time passes in the controller, not in `step`: several programs share one world.
    """

    def __init__(
        self, arm: Arm, version: tuple[int, ...], say: Callable[[str], None], signed: bool = True
    ) -> None:
        super().__init__()
        self.arm, self.version, self.say, self.signed = arm, version, say, signed
        self.dynamics = Dynamics(arm.robot)
        self.waypoint = pose_of(arm.kinematics.forward(arm.target[0], arm.tool))
        self.analog = [0.0, 0.0]
        self.watchdogs: dict[str, tuple[float, str]] = {}
        self.snapshot: Snapshot | None = None

    def instruction(self, name: str) -> Callable[..., Any] | None:
        """Give the method `do_NAME`, else a setting that has no effect, or None."""
        own: Callable[..., Any] | None = getattr(self, f"do_{name}", None)
        if own is None and name in catalogue() and catalogue()[name].returns == "none":
            if catalogue()[name].timed:
                return partial(_refuse, name)
            return partial(self.set, name)
        return own

    def step(self) -> None:
        """Nothing: the controller lets time pass."""

    # joints

    def do_get_actual_joint_positions(self) -> Array:
        return self._joints("actual_q")

    def do_get_actual_joint_speeds(self) -> Array:
        return self._joints("actual_qd")

    def do_get_target_joint_positions(self) -> Array:
        return self._joints("target_q")

    def do_get_target_joint_speeds(self) -> Array:
        return self._joints("target_qd")

    def do_get_target_joint_accelerations(self) -> Array:
        return self._joints("target_qdd")

    def do_get_joint_temp(self, j: Value) -> float:
        if isinstance(j, bool) or not isinstance(j, int) or not 0 <= j < JOINTS:
            raise Fault(f"get_joint_temp counts joints from 0 to 5, not {j!r}", "index")
        return joints_of(self.arm.state, "joint_temperatures")[j]

    def do_get_joint_torques(self) -> Array:
        gains = np.array([joint.drive_gain for joint in self.arm.robot.joint])
        rtde = self.arm.state.rtde
        return Array((gains * (rtde["actual_current"] - rtde["target_current"])).tolist())

    def do_get_actual_joint_positions_history(self, steps: Value) -> Array:
        history = self.arm.history
        if isinstance(steps, bool) or not isinstance(steps, int) or steps < 0:
            raise Fault("get_actual_joint_positions_history counts steps from 0", "domain")
        return Array(history[-1 - min(steps, len(history) - 1)].tolist())

    def do_is_steady(self) -> bool:
        return self.arm.steady

    # tool

    def do_get_actual_tcp_pose(self) -> Pose:
        return self._pose("actual_q")

    def do_get_target_tcp_pose(self) -> Pose:
        return self._pose("target_q")

    def do_get_actual_tool_flange_pose(self) -> Pose:
        return Pose(pose_of(self.arm.kinematics.frames(self.arm.state.rtde["actual_q"])[-1]))

    def do_get_actual_tcp_speed(self) -> Array:
        return self._tool_speed("actual")

    def do_get_target_tcp_speed(self) -> Array:
        return self._tool_speed("target")

    def do_get_target_waypoint(self) -> Pose:
        return Pose(self.waypoint)

    def do_get_tcp_offset(self) -> Pose:
        return Pose(self.arm.tcp)

    def do_set_tcp(self, pose: Value) -> None:
        self.arm.set_tcp(tuple(vector(pose, 6).tolist()))

    def do_get_tcp_force(self) -> Array:
        return Array(self.arm.wrench.tolist())

    def do_force(self) -> float:
        return float(np.linalg.norm(self.arm.wrench[:3]))

    def do_zero_ftsensor(self) -> None:
        self.arm.zero = self.arm.state.rtde["actual_TCP_force"].copy()

    def do_tool_contact(self, direction: Value) -> int:
        return self.arm.touching

    # kinematics and dynamics

    def do_get_forward_kin(self, q: Value, tcp: Value) -> Pose:
        angles = self.arm.state.rtde["actual_q"] if q is None else vector(q, JOINTS)
        return Pose(pose_of(self.arm.kinematics.forward(angles, self._tool(tcp))))

    def do_get_inverse_kin(self, x: Value, qnear: Value, place: Value, turn: Value, tcp: Value) -> Array:
        found = self._inverse(x, qnear, place, turn, tcp)
        if found is None:
            raise Fault(f"get_inverse_kin: no joint angles bring the tool to {to_str(x)}", "kinematics")
        return Array(found.tolist())

    def do_get_inverse_kin_has_solution(
        self, x: Value, qnear: Value, place: Value, turn: Value, tcp: Value
    ) -> bool:
        return self._inverse(x, qnear, place, turn, tcp) is not None

    def do_is_within_safety_limits(self, pose: Value, qnear: Value) -> bool:
        if isinstance(pose, Pose):
            return self._inverse(pose, qnear, 0.0, 0.0, None) is not None
        return bool(np.abs(vector(pose, JOINTS)).max() <= 2.0 * np.pi)

    def do_get_jacobian(self, q: Value, tcp: Value) -> Array:
        return _matrix(self.arm.kinematics.jacobian(self._angles(q), self._tool(tcp)))

    def do_get_jacobian_time_derivative(self, q: Value, qd: Value, tcp: Value) -> Array:
        at, speed, tool, h = self._angles(q), self._angles(qd, "actual_qd"), self._tool(tcp), 1e-5
        jacobian = self.arm.kinematics.jacobian
        return _matrix((jacobian(at + h * speed, tool) - jacobian(at - h * speed, tool)) / (2.0 * h))

    def do_get_mass_matrix(self, q: Value, include_rotors_inertia: Value) -> Array:
        return _matrix(self.dynamics.mass_matrix(self._angles(q), include_rotors_inertia is True))

    def do_get_coriolis_and_centrifugal_torques(self, q: Value, qd: Value) -> Array:
        return Array(self.dynamics.coriolis(self._angles(q), self._angles(qd, "actual_qd")).tolist())

    def do_get_gravity(self) -> Array:
        return Array(float(x) for x in self.arm.robot.gravity)

    # payload

    def do_set_target_payload(self, m: Value, cog: Value, inertia: Value, transition_time: Value) -> None:
        self._load(number(m), vector(cog, 3), vector(inertia, 6))

    def do_set_payload(self, m: Value, cog: Value) -> None:
        centre = np.array(self.arm.payload.centre) if cog is None else vector(cog, 3)
        self._load(number(m), centre, np.zeros(6))

    def do_set_payload_mass(self, m: Value) -> None:
        self.do_set_payload(m, None)

    def do_set_payload_cog(self, CoG: Value) -> None:
        self.do_set_payload(self.arm.payload.mass, CoG)

    def do_get_target_payload(self) -> float:
        return self.arm.payload.mass

    def do_get_target_payload_cog(self) -> Array:
        return Array(self.arm.payload.centre)

    def do_get_target_payload_inertia(self) -> Array:
        return Array(self.arm.payload.inertia)

    # modes

    def do_freedrive_mode(self, axes: Value, feature: Value) -> None:
        self.arm.freedrive = True

    def do_freedrive_mode_no_incorrect_payload_check(self) -> None:
        self.arm.freedrive = True

    def do_end_freedrive_mode(self) -> None:
        self.arm.release()

    do_teach_mode = do_freedrive_mode_no_incorrect_payload_check
    do_end_teach_mode = do_end_freedrive_mode

    def do_get_freedrive_status(self) -> int:
        return int(self.arm.freedrive)

    def do_protective_stop(self) -> None:
        self.arm.stop("protective_stop() in the program")

    def do_rtde_set_watchdog(self, name: Value, min_frequency: Value, action: Value) -> None:
        if action not in ("pause", "stop", "ignore"):
            raise Fault(f"rtde_set_watchdog: action {action!r} is not pause, stop or ignore", "domain")
        if action == "ignore" or number(min_frequency) <= 0.0:
            self.watchdogs.pop(str(name), None)
        else:
            self.watchdogs[str(name)] = (number(min_frequency), str(action))

    # registers and messages

    def do_read_port_register(self, address: Value) -> int:
        """Give registers of the joints as whole numbers of 16 bits."""
        for first, (name, scale) in PORT_REGISTERS.items():
            if isinstance(address, int) and first <= address < first + JOINTS:
                value = round(joints_of(self.arm.state, name)[address - first] * scale)
                value = min(max(value, -(2**15)), 2**15 - 1)
                return value if self.signed else value % 2**16
        fixed = {258: self.arm.mode, 266: 3 if self.arm.protective_stop else 1}
        if isinstance(address, int) and address in fixed:
            return fixed[address]
        raise Fault(f"port register {address} is not simulated", "address")

    def do_get_rtde_value(self, key: Value) -> Value:
        """Give a field as it was one step ago (script manual 5.25)."""
        if not isinstance(key, str) or output_type(key, self.version) is None or self.snapshot is None:
            raise Fault(f"get_rtde_value: no field {key!r}", "rtde-field")
        numbers = self.snapshot.value(key)
        return numbers[0] if len(numbers) == 1 else Array(numbers)

    def do_set_standard_analog_out(self, n: Value, f: Value) -> None:
        if n not in (0, 1) or isinstance(n, bool):
            raise Fault(f"analog output {n!r} is not 0 or 1", "address")
        self.analog[int(n)] = min(max(number(f), 0.0), 1.0)

    def do_get_standard_digital_in(self, n: Value) -> bool:
        return False

    do_get_configurable_digital_in = do_get_standard_digital_in
    do_get_tool_digital_in = do_get_standard_digital_in
    do_get_digital_in = do_get_standard_digital_in

    def do_textmsg(self, s1: Value, s2: Value) -> None:
        self.say(to_str(s1) + to_str(s2))

    def do_socket_send_string(self, text: Value, name: Value) -> bool:
        return False

    do_socket_send_line = do_socket_send_string
    do_socket_send_int = do_socket_send_string
    do_socket_send_byte = do_socket_send_string

    def _joints(self, name: str) -> Array:
        return Array(self.arm.state.rtde[name].tolist())

    def _angles(self, q: Value, name: str = "actual_q") -> "np.ndarray[Any, np.dtype[np.float64]]":
        return self.arm.state.rtde[name] if q is None else vector(q, JOINTS)

    def _tool(self, tcp: Value) -> "np.ndarray[Any, np.dtype[np.float64]]":
        return self.arm.tool if tcp is None else transform(vector(tcp, 6))

    def _pose(self, name: str) -> Pose:
        return Pose(pose_of(self.arm.kinematics.forward(self.arm.state.rtde[name], self.arm.tool)))

    def _tool_speed(self, side: str) -> Array:
        rtde = self.arm.state.rtde
        jacobian = self.arm.kinematics.jacobian(rtde[f"{side}_q"], self.arm.tool)
        return Array((jacobian @ rtde[f"{side}_qd"]).tolist())

    def _inverse(
        self, x: Value, qnear: Value, place: Value, turn: Value, tcp: Value
    ) -> "np.ndarray[Any, np.dtype[np.float64]] | None":
        tolerance = max(number(place), number(turn))
        return self.arm.kinematics.inverse(
            transform(vector(x, 6)), self._angles(qnear), self._tool(tcp), tolerance
        )

    def _load(
        self, mass: float, centre: "np.ndarray[Any, np.dtype[np.float64]]", inertia: "np.ndarray[Any, Any]"
    ) -> None:
        if mass < 0.0:
            raise Fault(f"a payload of {mass} kg", "domain")
        self.arm.set_payload(Payload(mass, tuple(centre.tolist()), tuple(inertia.tolist())))


def _matrix(rows: "np.ndarray[Any, np.dtype[np.float64]]") -> Array:
    return Array(Array(row) for row in rows.tolist())


def _refuse(name: str, *_arguments: Value) -> None:
    raise Fault(f"{name} is not simulated", "not-available")
