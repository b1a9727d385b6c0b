"""Where the tool is, and which joint angles bring it somewhere. DH chain of the robot file, six joints."""

from math import cos, pi, sin

import numpy as np
import numpy.typing as npt

from ...robots import Robot
from ...urscript.poses import matrix, rotation_vector

Array = npt.NDArray[np.float64]

TOLERANCE = 1e-10
"""m and rad, of the inverse; the default of the controller's get_inverse_kin."""


def transform(pose: tuple[float, ...] | Array) -> Array:
    """Return (4, 4) of a pose: position (m) and rotation vector (rad)."""
    out = np.eye(4)
    out[:3, 3] = pose[:3]
    out[:3, :3] = matrix(np.asarray(pose[3:], dtype=float))
    return out


def pose_of(frame: Array) -> tuple[float, ...]:
    """Return position (m) and rotation vector (rad) of a (4, 4)."""
    return (*frame[:3, 3].tolist(), *rotation_vector(frame[:3, :3]).tolist())


def error(target: Array, frame: Array) -> Array:
    """Return the way (6,) from a frame to a target: metres, and the rotation vector in the base frame."""
    turn = rotation_vector(target[:3, :3] @ frame[:3, :3].T)
    return np.concatenate([target[:3, 3] - frame[:3, 3], turn])


class Kinematics:
    """Forward and inverse kinematics of one robot; frames are (4, 4) in the base frame."""

    def __init__(self, robot: Robot) -> None:
        self._joints = [(j.a, j.d, cos(j.alpha), sin(j.alpha), j.offset) for j in robot.joint]

    def frames(self, q: Array | tuple[float, ...]) -> list[Array]:
        """Return the frames of base, links 1..N for joint angles (N,) rad."""
        out = [np.eye(4)]
        for angle, (a, d, ca, sa, offset) in zip(q, self._joints, strict=True):
            c, s = cos(angle + offset), sin(angle + offset)
            step = np.array(
                [
                    [c, -s * ca, s * sa, a * c],
                    [s, c * ca, -c * sa, a * s],
                    [0.0, sa, ca, d],
                    [0.0, 0.0, 0.0, 1.0],
                ]
            )
            out.append(out[-1] @ step)
        return out

    def forward(self, q: Array | tuple[float, ...], tool: Array) -> Array:
        """Return the tool's frame; tool: its frame (4, 4) at the flange."""
        return np.asarray(self.frames(q)[-1] @ tool)

    def jacobian(self, q: Array | tuple[float, ...], tool: Array) -> Array:
        """Return (6, N): speed of the tool's origin (m) and its angular speed (rad) per joint speed."""
        frames = self.frames(q)
        tip = (frames[-1] @ tool)[:3, 3]
        axes = np.array([frame[:3, 2] for frame in frames[:-1]])
        levers = np.array([tip - frame[:3, 3] for frame in frames[:-1]])
        return np.concatenate([np.cross(axes, levers), axes], axis=1).T

    def inverse(self, target: Array, near: Array, tool: Array, tolerance: float = TOLERANCE) -> Array | None:
        """Return the joint angles (N,) rad closest in kind to `near` that bring the tool to a frame, or None.

        Newton's iteration from `near`; when that fails, from the same arm with flipped wrist, elbow or
        shoulder.
        """
        tolerance = max(tolerance, TOLERANCE)
        for start in _starts(np.asarray(near, dtype=float)):
            found = self._newton(target, start, tool, tolerance)
            if found is not None:
                return found - 2.0 * pi * np.round((found - near) / (2.0 * pi))
        return None

    def follow(self, target: Array, near: Array, tool: Array) -> Array | None:
        """Return the angles for a frame that lies a control cycle's way from `near`, or None."""
        return self._newton(target, near, tool, 1e-9, most=8)

    def _newton(self, target: Array, q: Array, tool: Array, tolerance: float, most: int = 60) -> Array | None:
        for _ in range(most):
            way = error(target, self.forward(q, tool))
            if float(np.abs(way).max()) < tolerance:
                return q
            jacobian = self.jacobian(q, tool)
            damping = 1e-3 * float(way @ way)
            step = jacobian.T @ np.linalg.solve(jacobian @ jacobian.T + damping * np.eye(6), way)
            q = q + step / max(1.0, 2.0 * float(np.abs(step).max()))
        return None


def _starts(near: Array) -> list[Array]:
    """Return places to begin the search: the one asked for, then flipped arms, each bent a little."""
    wrist = near * [1, 1, 1, 1, -1, 1] + [0, 0, 0, pi, 0, pi]
    elbow = near * [1, 1, -1, 1, 1, 1] + [0, near[2], 0, near[2], 0, 0]
    shoulder = near * [1, -1, -1, -1, 1, 1] + [pi, -pi, 0, 0, 0, 0]
    bent = np.array([0.2, -0.4, 0.8, -0.4, 0.5, 0.0])
    return [arm + bend * bent for bend in (0.0, 1.0) for arm in (near, wrist, elbow, shoulder)]
