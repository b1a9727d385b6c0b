"""The RTDE channels that a recording can carry: names, units, and what no UR arm can exceed.

Names and types: UR's RTDE guide. Limits are physical, and generous by a factor of two or more: they
separate corrupt values from rare ones, not good motion from bad.
"""

from dataclasses import dataclass
from math import inf, pi

PER_JOINT = 0

MAX_POSITION = 4 * pi
"""rad; twice the joint range of +-360 deg (UR user manuals). The last joint of a UR3e turns without end."""

MAX_SPEED = 4 * pi
"""rad/s; twice the 360 deg/s of the UR3e's wrists, the fastest joints of the e-Series."""

MAX_ACCELERATION = 50.0
"""rad/s^2; from 180 deg/s to rest in 60 ms, quicker than any stopping time UR publishes (0.2 s and more)."""

MAX_CURRENT = 66.0
"""A; twice 330 Nm (the largest joint rating up to UR16e) over 10 Nm/A (identified drive gain, UR10e)."""


@dataclass(frozen=True)
class Channel:
    """One RTDE output: its name in the file, the `Recording` field, columns, unit and largest credible value.

    `width` is the number of columns, `PER_JOINT` for one a joint. `field` is None for the channels that
    stand in `Recording.others`.
    """

    name: str
    field: str | None
    width: int
    unit: str
    limit: float = inf

    def columns(self, joints: int) -> list[str]:
        """Column names in a file with `joints` joints."""
        if self.width == 1:
            return [self.name]
        return [f"{self.name}_{k}" for k in range(self.width or joints)]


TIMESTAMP = Channel("timestamp", "timestamp", 1, "s")
POSITION = Channel("actual_q", "q", PER_JOINT, "rad", MAX_POSITION)
CURRENT = Channel("actual_current", "current", PER_JOINT, "A", MAX_CURRENT)
REQUIRED = (TIMESTAMP, POSITION, CURRENT)

OPTIONAL = (
    Channel("actual_qd", "qd", PER_JOINT, "rad/s", MAX_SPEED),
    Channel("target_q", "target_q", PER_JOINT, "rad", MAX_POSITION),
    Channel("target_qd", "target_qd", PER_JOINT, "rad/s", MAX_SPEED),
    Channel("target_qdd", "target_qdd", PER_JOINT, "rad/s^2", 1e4),
    Channel("target_current", "target_current", PER_JOINT, "A", MAX_CURRENT),
    Channel("target_moment", "target_moment", PER_JOINT, "Nm", 5e3),
    Channel("joint_temperatures", "joint_temperatures", PER_JOINT, "deg C", 300.0),
    Channel("actual_TCP_force", "actual_TCP_force", 6, "N, Nm", 1e4),
)

OTHERS = (
    Channel("joint_control_output", None, PER_JOINT, "A"),
    Channel("actual_current_as_torque", None, PER_JOINT, "Nm"),
    Channel("actual_joint_voltage", None, PER_JOINT, "V"),
    Channel("actual_TCP_pose", None, 6, "m, rad"),
    Channel("actual_TCP_speed", None, 6, "m/s, rad/s"),
    Channel("target_TCP_pose", None, 6, "m, rad"),
    Channel("target_TCP_speed", None, 6, "m/s, rad/s"),
    Channel("ft_raw_wrench", None, 6, "N, Nm"),
    Channel("actual_tool_accelerometer", None, 3, "m/s^2"),
    Channel("payload_cog", None, 3, "m"),
    Channel("payload", None, 1, "kg"),
    Channel("speed_scaling", None, 1, "1"),
    Channel("actual_main_voltage", None, 1, "V"),
    Channel("actual_robot_voltage", None, 1, "V"),
    Channel("actual_robot_current", None, 1, "A"),
    Channel("runtime_state", None, 1, "1"),
    Channel("robot_mode", None, 1, "1"),
    Channel("safety_status", None, 1, "1"),
)

FIELDS = {c.field: c for c in (*REQUIRED, *OPTIONAL) if c.field}
