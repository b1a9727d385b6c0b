"""The values of all RTDE fields at one control cycle, packed once however many clients want them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from ...urscript.values import Value
from ..simulator import State
from .arm import DEVIATION, Arm
from .fields import FORMATS, OUTPUTS
from .kinematics import Kinematics, pose_of

VOLTAGE = 48.0  # V, of the robot's supply
RUNTIME = {"stopped": 1, "playing": 2, "paused": 4}
"""Program states and their numbers in RTDE."""
_JOINT_RUNNING = 253
_PROTECTIVE_BITS = 1 << 2 | 1 << 10  # protective stop, stopped due to safety

_MEASURED = (
    "target_q", "target_qd", "target_qdd", "target_current", "target_moment", "actual_q", "actual_qd",
    "actual_current", "joint_temperatures",
)  # fmt: skip

Table = Mapping[tuple[str, int], Value]
Numbers = tuple[float, ...]


@dataclass(frozen=True)
class Snapshot:
    """Everything the controller tells at one cycle.

    inputs, outputs: registers. digital: (group, number) -> on. program: stopped, playing or paused.
    """

    time: float
    state: State
    arm: Arm
    mode: int
    protective_stop: bool
    program: str
    inputs: Table
    outputs: Table
    digital: Mapping[tuple[str, int], bool]
    analog: tuple[float, float]
    _packed: dict[str, bytes] = field(default_factory=dict)

    def value(self, name: str) -> Numbers:
        """Return the numbers of a field of OUTPUTS."""
        return VALUES[name](self)

    def packed(self, name: str) -> bytes:
        """Return a field as RTDE sends it."""
        data = self._packed.get(name)
        if data is None:
            data = self._packed[name] = FORMATS[OUTPUTS[name]].pack(*VALUES[name](self))
        return data

    @property
    def kinematics(self) -> Kinematics:
        """Of the robot."""
        return self.arm.kinematics


def _state(name: str, s: Snapshot) -> Numbers:
    return tuple(s.state.rtde[name].tolist())


def _pose(name: str, s: Snapshot) -> Numbers:
    return pose_of(s.kinematics.forward(s.state.rtde[name], s.arm.tool))


def _speed(side: str, s: Snapshot) -> Numbers:
    jacobian = s.kinematics.jacobian(s.state.rtde[f"{side}_q"], s.arm.tool)
    return tuple((jacobian @ s.state.rtde[f"{side}_qd"]).tolist())


def _excess_torque(s: Snapshot) -> Numbers:
    """Motor torque less what the controller expects (Nm)."""
    gains = [joint.drive_gain for joint in s.arm.robot.joint]
    return tuple(((s.state.rtde["actual_current"] - s.state.rtde["target_current"]) * gains).tolist())


def _wrench_of_currents(s: Snapshot) -> Numbers:
    jacobian = s.kinematics.jacobian(s.state.rtde["actual_q"], s.arm.tool)
    wrench, *_ = np.linalg.lstsq(jacobian.T, -np.array(_excess_torque(s)), rcond=1e-3)
    return tuple(wrench.tolist())


def _elbow(s: Snapshot) -> Numbers:
    return tuple(s.kinematics.frames(s.state.rtde["actual_q"])[2][:3, 3].tolist())


def _elbow_speed(s: Snapshot) -> Numbers:
    frames = s.kinematics.frames(s.state.rtde["actual_q"])
    speed, elbow = np.zeros(3), frames[2][:3, 3]
    for k in range(2):
        speed += np.cross(frames[k][:3, 2], elbow - frames[k][:3, 3]) * s.state.rtde["actual_qd"][k]
    return tuple(speed.tolist())


def _momentum(s: Snapshot) -> Numbers:
    return (float(np.abs(s.state.rtde["actual_qd"]).sum()),)


def _safety(s: Snapshot) -> Numbers:
    return (3 if s.protective_stop else 1,)


def _status_bits(s: Snapshot) -> Numbers:
    return (int(s.mode == 7) | (s.program == "playing") << 1,)


def _safety_bits(s: Snapshot) -> Numbers:
    return (_PROTECTIVE_BITS if s.protective_stop else 1,)


def _digital_outputs(s: Snapshot) -> Numbers:
    first = {"standard": 0, "configurable": 8, "tool": 16}
    return (sum(1 << first[group] + n for (group, n), on in s.digital.items() if on and group in first),)


def _bits(table: str, first: int, s: Snapshot) -> Numbers:
    rows: Table = getattr(s, table)
    return (sum(1 << i for i in range(32) if rows.get(("boolean", first + i))),)


def _register(table: str, kind: str, number: int, s: Snapshot) -> Numbers:
    rows: Table = getattr(s, table)
    return (rows.get((kind, number), 0),)  # type: ignore[return-value]


def _robot_current(s: Snapshot) -> Numbers:
    return (0.5 + float(np.abs(s.state.rtde["actual_current"]).sum()) / 10.0,)


def _force(s: Snapshot) -> Numbers:
    return tuple((s.state.rtde["actual_TCP_force"] - s.arm.zero).tolist())


def _force_size(s: Snapshot) -> Numbers:
    return (float(np.linalg.norm(_force(s)[:3])),)


def _deviation(s: Snapshot) -> Numbers:
    return (float(np.abs(s.state.rtde["target_q"] - s.state.rtde["actual_q"]).max()) / DEVIATION,)


def _constant(*numbers: float) -> Callable[[Snapshot], Numbers]:
    return lambda _s: numbers


def _values() -> dict[str, Callable[[Snapshot], Numbers]]:
    """Return the function of every field; what is not simulated is zero."""
    sizes = {"VECTOR3D": 3, "VECTOR6D": 6, "VECTOR6INT32": 6}
    out = {name: _constant(*[0] * sizes.get(kind, 1)) for name, kind in OUTPUTS.items()}
    out |= {name: partial(_state, name) for name in _MEASURED}
    for table in ("inputs", "outputs"):
        side = table[:-1]
        for i in range(48):
            out[f"{side}_int_register_{i}"] = partial(_register, table, "integer", i)
            out[f"{side}_double_register_{i}"] = partial(_register, table, "float", i)
        for i in range(64, 128):
            out[f"{side}_bit_register_{i}"] = partial(_register, table, "boolean", i)
        out[f"{side}_bit_registers0_to_31"] = partial(_bits, table, 0)
        out[f"{side}_bit_registers32_to_63"] = partial(_bits, table, 32)
    for side in ("actual", "target"):
        out[f"{side}_TCP_pose"] = partial(_pose, f"{side}_q")
        out[f"{side}_TCP_speed"] = partial(_speed, side)
    return out | {
        "timestamp": lambda s: (s.time,),
        "actual_TCP_force": _force,
        "ft_raw_wrench": partial(_state, "actual_TCP_force"),
        "joint_control_output": partial(_state, "target_current"),
        "actual_current_window": _constant(*[1.0] * 6),
        "actual_current_as_torque": _excess_torque,
        "wrench_calc_from_currents": _wrench_of_currents,
        "tcp_force_scalar": _force_size,
        "robot_mode": lambda s: (s.mode,),
        "joint_mode": _constant(*[_JOINT_RUNNING] * 6),
        "tool_mode": _constant(_JOINT_RUNNING),
        "safety_mode": _safety,
        "safety_status": _safety,
        "robot_status_bits": _status_bits,
        "safety_status_bits": _safety_bits,
        "runtime_state": lambda s: (RUNTIME[s.program],),
        "speed_scaling": lambda s: (s.arm.rate,),
        "target_speed_fraction": lambda s: (s.arm.speed_fraction,),
        "actual_momentum": _momentum,
        "actual_main_voltage": _constant(VOLTAGE),
        "actual_robot_voltage": _constant(VOLTAGE),
        "actual_robot_current": _robot_current,
        "actual_joint_voltage": _constant(*[VOLTAGE] * 6),
        "actual_tool_accelerometer": _constant(0.0, 0.0, 9.81),
        "actual_digital_output_bits": _digital_outputs,
        "standard_analog_output0": lambda s: s.analog[:1],
        "standard_analog_output1": lambda s: s.analog[1:],
        "elbow_position": _elbow,
        "elbow_velocity": _elbow_speed,
        "tcp_offset": lambda s: s.arm.tcp,
        "payload": lambda s: (s.arm.payload.mass,),
        "payload_cog": lambda s: s.arm.payload.centre,
        "payload_inertia": lambda s: s.arm.payload.inertia,
        "joint_position_deviation_ratio": _deviation,
    }


VALUES = _values()
"""Field -> its numbers at a snapshot."""
