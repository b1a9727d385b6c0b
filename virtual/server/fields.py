"""The fields of RTDE: names, types, direction, and the versions that have them.

Names and types are those of UR's RTDE guide and of UR's client library (src/rtde/data_package.cpp).
"""

from collections.abc import Mapping
from struct import Struct
from types import MappingProxyType

FORMATS: Mapping[str, Struct] = MappingProxyType(
    {
        "BOOL": Struct(">?"),
        "UINT8": Struct(">B"),
        "UINT32": Struct(">I"),
        "UINT64": Struct(">Q"),
        "INT32": Struct(">i"),
        "DOUBLE": Struct(">d"),
        "VECTOR3D": Struct(">3d"),
        "VECTOR6D": Struct(">6d"),
        "VECTOR6INT32": Struct(">6i"),
        "VECTOR6UINT32": Struct(">6I"),
    }
)
"""Type -> its layout, big endian."""

_OUTPUTS = {
    "DOUBLE": """timestamp actual_execution_time target_execution_time speed_scaling target_speed_fraction
        actual_momentum actual_main_voltage actual_robot_voltage actual_robot_current standard_analog_input0
        standard_analog_input1 standard_analog_output0 standard_analog_output1 io_current
        euromap67_24V_voltage euromap67_24V_current tool_analog_input0 tool_analog_input1
        tool_output_current tool_temperature tcp_force_scalar payload joint_position_deviation_ratio
        collision_detection_ratio""",
    "VECTOR6D": """target_q target_qd target_qdd target_current target_moment actual_q actual_qd
        actual_current actual_current_window actual_current_as_torque joint_control_output actual_TCP_pose
        actual_TCP_speed actual_TCP_force target_TCP_pose target_TCP_speed joint_temperatures
        actual_joint_voltage tcp_offset ft_raw_wrench payload_inertia wrench_calc_from_currents""",
    "VECTOR3D": "actual_tool_accelerometer payload_cog elbow_position elbow_velocity",
    "VECTOR6INT32": "joint_mode",
    "INT32": "robot_mode safety_mode safety_status tool_output_voltage time_scale_source",
    "UINT32": """runtime_state robot_status_bits safety_status_bits analog_io_types tool_mode
        tool_analog_input_types euromap67_input_bits euromap67_output_bits script_control_line
        output_bit_registers0_to_31 output_bit_registers32_to_63 input_bit_registers0_to_31
        input_bit_registers32_to_63""",
    "UINT64": "actual_digital_input_bits actual_digital_output_bits",
    "UINT8": "tool_output_mode tool_digital_output0_mode tool_digital_output1_mode",
}

_INPUTS = {
    "DOUBLE": "speed_slider_fraction standard_analog_output_0 standard_analog_output_1",
    "VECTOR6D": "external_force_torque",
    "UINT32": "speed_slider_mask input_bit_registers0_to_31 input_bit_registers32_to_63",
    "UINT8": """standard_digital_output_mask standard_digital_output configurable_digital_output_mask
        configurable_digital_output tool_digital_output_mask tool_digital_output
        standard_analog_output_mask standard_analog_output_type""",
}

SINCE: Mapping[str, tuple[int, int]] = MappingProxyType({"actual_current_as_torque": (5, 23)})
"""Fields that older controllers do not have, with the first PolyScope 5 version that has them."""


def _registers(side: str) -> dict[str, str]:
    names = {f"{side}_int_register_{i}": "INT32" for i in range(48)}
    names |= {f"{side}_double_register_{i}": "DOUBLE" for i in range(48)}
    return names | {f"{side}_bit_register_{i}": "BOOL" for i in range(64, 128)}


def _listed(table: dict[str, str]) -> dict[str, str]:
    return {name: kind for kind, names in table.items() for name in names.split()}


OUTPUTS: Mapping[str, str] = MappingProxyType(_listed(_OUTPUTS) | _registers("output") | _registers("input"))
"""What a client may receive: name -> type."""

INPUTS: Mapping[str, str] = MappingProxyType(_listed(_INPUTS) | _registers("input"))
"""What a client may set: name -> type."""


def output_type(name: str, version: tuple[int, ...]) -> str | None:
    """Return the type of an output on a controller of some version, or None when it has no such field."""
    return OUTPUTS.get(name) if version[:2] >= SINCE.get(name, (0, 0)) else None
