"""Motions to send through an arm, sampled every 2 ms, at rest at both ends; random ones by seed."""

from dataclasses import dataclass
from itertools import pairwise
from math import ceil, pi, sqrt

import mujoco
import numpy as np
import numpy.typing as npt

from ..robots import Robot
from .controller import TICK
from .model import build_model, link_frame

Array = npt.NDArray[np.float64]
SPEED = 1.5  # rad/s, default bound of random motions
ACCELERATION = 4.0  # rad/s^2
TABLE = 0.08  # m above the base plane that frames 3..N keep
HOME = (0.0, -1.5708, 1.5708, -1.5708, -1.5708, 0.0)  # rad


@dataclass(frozen=True)
class Motion:
    """A path in time: q, qd, qdd (T, N) in rad, rad/s, rad/s^2, every 2 ms from 0.

    grips: (from, to) in s when the gripper is closed, for `Payload(intervals=...)`.
    """

    q: Array
    qd: Array
    qdd: Array
    grips: tuple[tuple[float, float], ...] = ()

    @property
    def time(self) -> Array:
        """Time (T,) in s."""
        return np.asarray(TICK * np.arange(len(self.q)))

    @property
    def duration(self) -> float:
        """Length in s."""
        return TICK * len(self.q)


def join(*parts: Motion) -> Motion:
    """Return motions one after the other; each must begin where the one before ends."""
    grips, start = list[tuple[float, float]](), 0.0
    for part in parts:
        grips += [(a + start, b + start) for a, b in part.grips]
        start += part.duration
    q, qd, qdd = (np.concatenate([getattr(part, name) for part in parts]) for name in ("q", "qd", "qdd"))
    return Motion(q, qd, qdd, tuple(grips))


def still(pose: tuple[float, ...] | Array, seconds: float) -> Motion:
    """Return rest at a pose (N,) rad."""
    q = np.tile(np.asarray(pose, dtype=float), (max(round(seconds / TICK), 1), 1))
    return Motion(q, np.zeros_like(q), np.zeros_like(q))


def move(start: Array, end: Array, speed: float = 1.05, acceleration: float = 1.4) -> Motion:
    """Return one movej between poses (N,) rad: trapezoidal speed, all joints in step (UR's defaults)."""
    way = np.asarray(end, dtype=float) - np.asarray(start, dtype=float)
    longest = float(np.abs(way).max())
    if longest == 0.0:
        return still(start, TICK)
    ramp = min(speed / acceleration, sqrt(longest / acceleration))
    top = acceleration * ramp
    total = longest / top + ramp
    t = TICK * np.arange(ceil(total / TICK) + 1)
    late = np.clip(total - t, 0.0, None)
    early = t < ramp
    braking = (late < ramp) & ~early
    s = np.where(early, 0.5 * acceleration * t**2, top * (t - 0.5 * ramp))
    s = np.where(braking, longest - 0.5 * acceleration * late**2, s)
    v = np.where(early, acceleration * t, np.where(braking, acceleration * late, top))
    a = np.where(early, acceleration, np.where(braking & (late > 0.0), -acceleration, 0.0))
    return Motion(start + np.outer(s, way) / longest, np.outer(v, way) / longest, np.outer(a, way) / longest)


def point_to_point(
    poses: Array, dwell: float = 1.0, speed: float = 1.05, acceleration: float = 1.4
) -> Motion:
    """Return moves through poses (K, N) rad with `dwell` s of rest at each."""
    parts = [still(poses[0], dwell)]
    for start, end in pairwise(poses):
        parts += [move(start, end, speed, acceleration), still(end, dwell)]
    return join(*parts)


def random_poses(robot: Robot, count: int, seed: int = 0, reach: float = 1.2) -> Array:
    """Return poses (count, N) rad within `reach` of a bent arm, all above the table."""
    rng, table = np.random.default_rng(seed), _Table(robot)
    n = len(robot.joint)
    poses: list[Array] = []
    for _ in range(1000 * count):
        pose = np.array(HOME[:n]) + reach * np.array([2.0, 0.7, 1.0, 1.5, 1.5, 2.0][:n]) * rng.uniform(
            -1, 1, n
        )
        if table.clear(pose[None]):
            poses.append(pose)
        if len(poses) == count:
            return np.array(poses)
    raise ValueError(f"no {count} poses above the table found; give another reach than {reach}")


def still_poses(robot: Robot, count: int = 10, seconds: float = 4.0, seed: int = 0) -> Motion:
    """Return random poses with `seconds` of rest at each, and moves between them."""
    return point_to_point(random_poses(robot, count, seed), seconds)


def fourier(
    robot: Robot,
    seconds: float = 30.0,
    seed: int = 0,
    harmonics: int = 5,
    period: float = 15.0,
    speed: float = SPEED,
    acceleration: float = ACCELERATION,
) -> Motion:
    """Return a random Fourier series of all joints (Swevers et al. 1997) above the table.

    Every joint reaches its bound of speed (rad/s), acceleration (rad/s^2) or range, whichever comes first.
    Raises ValueError when no such series is found.
    """
    rng, table, n = np.random.default_rng(seed), _Table(robot), len(robot.joint)
    warped = _ease(seconds)
    ranges = np.array([2.6, 0.9, 1.2, 2.2, 2.2, 2.8][:n])
    for _ in range(200):
        a, b = rng.standard_normal((2, harmonics, n))
        centre = np.array(HOME[:n]) + np.array([1.0, 0.3, 0.3, 0.5, 0.5, 1.0][:n]) * rng.uniform(-1, 1, n)
        q, qd, qdd = _series(warped, a, b, 2.0 * pi / period)
        bounds = np.abs(q).max(0) / ranges, np.abs(qd).max(0) / speed, np.abs(qdd).max(0) / acceleration
        scale = 1.0 / np.max(bounds, axis=0)
        for _ in range(4):
            if table.clear((centre + scale * q)[::25]):
                return Motion(centre + scale * q, scale * qd, scale * qdd)
            scale = scale * np.array([1.0, 0.7, 0.7, 1.0, 1.0, 1.0][:n])
    raise ValueError("no Fourier motion above the table found; give another seed, or lower speed")


def sweep(joint: int, pose: tuple[float, ...], low: float, high: float, speeds: tuple[float, ...]) -> Motion:
    """Return joint 1..N going to and fro between two angles (rad) at each of some speeds (rad/s)."""
    ends = np.tile(np.asarray(pose, dtype=float), (2, 1))
    ends[:, joint - 1] = low, high
    parts = [still(ends[0], 0.5)]
    for v in speeds:
        parts += [move(ends[0], ends[1], v, ACCELERATION), move(ends[1], ends[0], v, ACCELERATION)]
    return join(*parts, still(ends[0], 0.5))


def small_reversals(
    joint: int,
    pose: tuple[float, ...],
    widths: tuple[float, ...] = (0.001, 0.003, 0.01, 0.03, 0.1),
    speed: float = 0.02,
    times: int = 3,
) -> Motion:
    """Return joint 1..N creeping to and fro over some widths (rad), `times` each: presliding shows there."""
    start = np.asarray(pose, dtype=float)
    parts = [still(start, 0.5)]
    for width in widths:
        end = start.copy()
        end[joint - 1] += width
        parts += [move(start, end, speed, 0.5), move(end, start, speed, 0.5)] * times
    return join(*parts, still(start, 0.5))


def pick_and_place(robot: Robot, cycles: int = 4, pause: float = 0.6, seed: int = 0) -> Motion:
    """Return picks and places between random spots, with pauses; `grips` says when something is held."""
    spots = random_poses(robot, 2 * cycles, seed, reach=0.8)
    lift = np.array([0.0, -0.25, -0.1, 0.35, 0.0, 0.0][: len(robot.joint)])
    parts, grips, held, time = [still(spots[0] + lift, pause)], list[tuple[float, float]](), 0.0, pause
    for k, spot in enumerate(spots):
        previous = spots[max(k - 1, 0)] + lift
        down = [move(previous, spot + lift, 1.5, 2.5), move(spot + lift, spot, 0.5, 1.0), still(spot, pause)]
        touch = time + sum(part.duration for part in down) - 0.5 * pause
        parts += [*down, move(spot, spot + lift, 0.5, 1.0)]
        time = sum(part.duration for part in parts)
        if k % 2:
            grips.append((held, touch))
        held = touch
    whole = join(*parts)
    return Motion(whole.q, whole.qd, whole.qdd, tuple(grips))


def _series(
    warped: tuple[Array, Array, Array], a: Array, b: Array, omega: float
) -> tuple[Array, Array, Array]:
    """Return the series and its derivatives in time (T, N), at eased time, without its mean pose."""
    s, ds, dds = warped
    k = omega * np.arange(1, len(a) + 1)
    sine, cosine = np.sin(np.outer(s, k)), np.cos(np.outer(s, k))
    q = sine @ a + cosine @ b
    slope = (cosine * k) @ a - (sine * k) @ b
    bend = -(sine * k**2) @ a - (cosine * k**2) @ b
    return q, slope * ds[:, None], bend * ds[:, None] ** 2 + slope * dds[:, None]


def _ease(seconds: float, edge: float = 1.0) -> tuple[Array, Array, Array]:
    """Return time that starts and stops smoothly over `edge` s, and its two derivatives, each (T,)."""
    t = TICK * np.arange(round(seconds / TICK))
    near = np.clip(np.minimum(t, t[-1] - t) / edge, 0.0, 1.0)
    ds = near**3 * (10.0 - 15.0 * near + 6.0 * near**2)
    dds = 30.0 * near**2 * (1.0 - near) ** 2 / edge * np.where(t < 0.5 * t[-1], 1.0, -1.0)
    s = np.concatenate([[0.0], np.cumsum(0.5 * (ds[1:] + ds[:-1]) * TICK)])
    return s, ds, dds


class _Table:
    """Says whether frames 3..N of an arm stay above the table."""

    def __init__(self, robot: Robot) -> None:
        self._model = build_model(robot)
        self._data = mujoco.MjData(self._model)
        self._frames = [(link, link_frame(robot, link)[1]) for link in range(2, len(robot.joint) + 1)]

    def clear(self, poses: Array) -> bool:
        """Say whether all poses (K, N) are clear of it."""
        data = self._data
        for pose in poses:
            data.qpos[:] = pose
            mujoco.mj_kinematics(self._model, data)
            for link, origin in self._frames:
                if data.xpos[link][2] + data.xmat[link][6:] @ origin < TABLE:
                    return False
        return True
