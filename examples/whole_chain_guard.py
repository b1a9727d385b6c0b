"""What whole_chain.py needs of the guard: its motion, what stands in the way, what its registers say."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from residuum.driver import Rtde
from residuum.robots import load_robot
from residuum.virtual.motions import HOME
from residuum.virtual.server.kinematics import Kinematics

SWING, CONTACT, SPEED = 0.6, 0.3, 0.3  # rad to either side; rad at which the flange touches; rad/s
FIELDS = (
    "timestamp",
    *(f"output_int_register_{k}" for k in (24, 25, 26, 30)),
    "actual_TCP_force",
    "actual_q",
)
CONTACT_FORCE = 5.0  # N away from what the wrist felt the second before


@dataclass(frozen=True)
class Seen:
    """What a guard's registers said: states in order, reason, joint 1..6, seconds guarded quietly.

    delay: s from CONTACT_FORCE at the wrist to the detection, nan without both.
    """

    states: list[int]
    reason: int
    joint: int
    guarded: float
    delay: float

    def text(self, names: dict[int, str]) -> str:
        """Return it in words."""
        words = " -> ".join(names.get(s, str(s)) for s in self.states)
        words += f", {self.guarded:.1f} s guarded"
        words += f", joint {self.joint}" if self.joint else ""
        return words + (f", reason {self.reason}" if self.reason else "")


def guard_motion() -> str:
    """Return the motion that is guarded: joint 1 to and fro about the pose in which the robot wakes."""
    poses = [(sign * SWING, *HOME[1:]) for sign in (1, -1)]
    moves = [f"  movej([{', '.join(f'{x:.4f}' for x in pose)}], a=1.0, v={SPEED})" for pose in poses]
    return "\n".join(["while True:", *moves, "end", ""])


def obstacle() -> dict[str, object]:
    """Return foam whose face the flange meets squarely at CONTACT rad of joint 1 (3 N/mm, 60 N s/m)."""
    kinematics, pose = Kinematics(load_robot("ur5e")[0]), np.array(HOME)
    points = []
    for angle in (CONTACT, CONTACT + 1e-5):
        pose[0] = angle
        points.append(kinematics.forward(pose, np.eye(4))[:3, 3])
    way = points[1] - points[0]
    return {
        "place": points[0].tolist(), "normal": (-way / np.linalg.norm(way)).tolist(),
        "stiffness": 3000.0, "damping": 60.0,
    }  # fmt: skip


def watch(host: str, seconds: float, begin: Callable[[], object]) -> Seen:
    """Read the robot's stream from before `begin` for some seconds of its time, or 0.5 s past a reaction."""
    with Rtde(host, FIELDS, 500.0, timeout=30.0) as stream:
        begin()
        table = np.empty((0, len(stream.columns)))
        end = np.inf
        for block in stream.rows():
            table = np.vstack([table, block])
            started = np.flatnonzero(table[:, 1] == 1)
            if len(started) and not np.isfinite(end):
                end = table[started[0], 0] + seconds
            if len(over := np.flatnonzero(table[:, 1] >= 5)):
                end = min(end, table[over[0], 0] + 0.5)
            if table[-1, 0] > end or table[-1, 0] > table[0, 0] + seconds + 60:
                break
    return _seen(table)


def _seen(table: np.ndarray) -> Seen:
    """Return what rows of FIELDS (T, 17) say."""
    time, state = table[:, 0], table[:, 1].astype(int)
    changes = np.flatnonzero(np.diff(state, prepend=0))
    states = [int(state[k]) for k in changes if state[k]]
    guarding = time[state == 2]
    stop = np.flatnonzero(state == 3)
    delay = np.nan
    if len(stop) and len(guarding):
        delay = time[stop[0]] - _onset(table[: stop[0] + 25])
    reason, joint = (int(table[:, k].max()) for k in (2, 3))
    return Seen(states, reason, joint, float(np.ptp(guarding)) if len(guarding) else 0.0, float(delay))


def _onset(table: np.ndarray) -> float:
    """Return when the force at the wrist left what it was for the second before, s; nan if it never did."""
    force, step = table[:, 5:8], 500
    if len(force) <= step:
        return np.nan
    away = np.linalg.norm(force[step:] - _mean(force, step), axis=1)
    late = np.flatnonzero(away > CONTACT_FORCE)
    return float(table[step + late[0], 0]) if len(late) else np.nan


def _mean(values: np.ndarray, step: int) -> np.ndarray:
    """Return the mean (T - step, 3) of the `step` rows before each."""
    sums = np.vstack([np.zeros(values.shape[1]), np.cumsum(values, axis=0)])
    return (sums[step:-1] - sums[: -step - 1]) / step
