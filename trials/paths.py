"""The motions of a case: a random mixture of what laboratories and cells do."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from ..robots import Robot
from ..virtual import TICK, Motion, motions

Array = npt.NDArray[np.float64]
Part = Callable[[Robot, np.random.Generator], Motion]
LINK_SPEED = 0.8  # rad/s, of moves between parts


def recording(robot: Robot, rng: np.random.Generator, seconds: tuple[float, float]) -> Motion:
    """Return one recording's motion, of a length drawn between two bounds (s).

    Its first part excites all joints; what follows is drawn from all kinds until the time is up.
    """
    length = rng.uniform(*seconds)
    parts = [_first(rng)(robot, rng)]
    while sum(part.duration for part in parts) < length:
        following = PARTS[rng.choice(len(PARTS), p=WEIGHTS)](robot, rng)
        parts += [motions.move(parts[-1].q[-1], following.q[0], LINK_SPEED), following]
    return cut(motions.join(*parts), length)


def cut(motion: Motion, seconds: float) -> Motion:
    """Return the beginning of a motion."""
    rows = min(round(seconds / TICK), len(motion.q))
    grips = tuple((a, min(b, rows * TICK)) for a, b in motion.grips if a < rows * TICK - 0.1)
    return Motion(motion.q[:rows], motion.qd[:rows], motion.qdd[:rows], grips)


def _seed(rng: np.random.Generator) -> int:
    return int(rng.integers(2**31))


def _fourier(robot: Robot, rng: np.random.Generator) -> Motion:
    for _ in range(20):
        speed, period = rng.uniform(0.3, 1.5), rng.uniform(8.0, 20.0)
        seconds = rng.uniform(14.0, 30.0)
        try:
            return motions.fourier(
                robot, seconds, _seed(rng), int(rng.integers(2, 6)), period, speed, rng.uniform(1.0, 4.0)
            )
        except ValueError:
            continue
    return _points(robot, rng)


def _points(robot: Robot, rng: np.random.Generator) -> Motion:
    poses = motions.random_poses(robot, int(rng.integers(3, 8)), _seed(rng))
    return motions.point_to_point(poses, rng.uniform(0.3, 1.5), rng.uniform(0.4, 1.8), rng.uniform(0.8, 3.0))


def _pick(robot: Robot, rng: np.random.Generator) -> Motion:
    return motions.pick_and_place(robot, int(rng.integers(1, 3)), rng.uniform(0.3, 0.8), _seed(rng))


def _pose(robot: Robot, rng: np.random.Generator) -> tuple[float, ...]:
    return tuple(float(x) for x in motions.random_poses(robot, 1, _seed(rng), reach=0.8)[0])


def _sweep(robot: Robot, rng: np.random.Generator) -> Motion:
    pose, joint = _pose(robot, rng), int(rng.integers(1, len(robot.joint) + 1))
    speeds = np.exp(rng.uniform(np.log(0.02), np.log(0.5), int(rng.integers(1, 4))))
    width = float(np.clip(speeds.min() * rng.uniform(4.0, 8.0), 0.1, 1.0))
    low = pose[joint - 1] - 0.5 * width
    return motions.sweep(joint, pose, low, low + width, tuple(float(v) for v in speeds))


def _reversals(robot: Robot, rng: np.random.Generator) -> Motion:
    pose, joint = _pose(robot, rng), int(rng.integers(1, len(robot.joint) + 1))
    widths = tuple(float(w) for w in np.exp(rng.uniform(np.log(0.002), np.log(0.06), 4)))
    return motions.small_reversals(joint, pose, widths, rng.uniform(0.015, 0.05), int(rng.integers(1, 3)))


PARTS: tuple[Part, ...] = (_fourier, _points, _pick, _sweep, _reversals)
WEIGHTS = (0.35, 0.25, 0.15, 0.15, 0.1)


def _first(rng: np.random.Generator) -> Part:
    return (_fourier, _fourier, _points)[int(rng.integers(3))]
