"""Poses as rotation vector and position; script manual 5.11, ch. 14.

Rotations are handled as 3x3 NumPy matrices inside and leave as rotation vectors in rad.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from .errors import Fault
from .values import Array, Pose, Value, spoken

Matrix = npt.NDArray[np.float64]


def pose_trans(p_from: Value, p_from_to: Value) -> Pose:
    """Give the second pose, given in the frame of the first, in the frame of the first's reference."""
    first, second = vector(p_from, 6), vector(p_from_to, 6)
    rotation = matrix(first[3:])
    return _pose(first[:3] + rotation @ second[:3], rotation @ matrix(second[3:]))


def pose_inv(p_from: Value) -> Pose:
    """Give the inverse transformation."""
    pose = vector(p_from, 6)
    back = matrix(pose[3:]).T
    return _pose(-back @ pose[:3], back)


def pose_add(p_1: Value, p_2: Value) -> Pose:
    """Positions add, rotations compose in the base frame."""
    a, b = vector(p_1, 6), vector(p_2, 6)
    return _pose(a[:3] + b[:3], matrix(a[3:]) @ matrix(b[3:]))


def pose_sub(p_to: Value, p_from: Value) -> Pose:
    """Give what `pose_add` adds to the second to get the first."""
    a, b = vector(p_to, 6), vector(p_from, 6)
    return _pose(a[:3] - b[:3], matrix(a[3:]) @ matrix(b[3:]).T)


def pose_dist(p_from: Value, p_to: Value) -> float:
    """Length of `pose_sub` with metres and radians side by side."""
    return float(np.linalg.norm(vector(pose_sub(p_to, p_from), 6)))


def point_dist(p_from: Value, p_to: Value) -> float:
    """Distance of the positions in m."""
    return float(np.linalg.norm(vector(p_to, 6)[:3] - vector(p_from, 6)[:3]))


def interpolate_pose(p_from: Value, p_to: Value, alpha: Value) -> Pose:
    """Between the two: alpha 0 is the first, 1 the second."""
    a, b, share = vector(p_from, 6), vector(p_to, 6), number(alpha)
    turn = rotation_vector(matrix(a[3:]).T @ matrix(b[3:]))
    return _pose(a[:3] + share * (b[:3] - a[:3]), matrix(a[3:]) @ matrix(share * turn))


def rotvec2rpy(rotation_vector_: Value) -> Array:
    """Rotation vector to roll, pitch, yaw in rad (R = Rz(yaw) Ry(pitch) Rx(roll))."""
    r = matrix(vector(rotation_vector_, 3))
    pitch = math.atan2(-r[2, 0], math.hypot(r[0, 0], r[1, 0]))
    roll, yaw = math.atan2(r[2, 1], r[2, 2]), math.atan2(r[1, 0], r[0, 0])
    return Array((roll, pitch, yaw))


def rpy2rotvec(rpy: Value) -> Array:
    """Roll, pitch, yaw in rad to a rotation vector."""
    roll, pitch, yaw = vector(rpy, 3)
    axes = np.eye(3)
    turned = matrix(yaw * axes[2]) @ matrix(pitch * axes[1]) @ matrix(roll * axes[0])
    return Array(rotation_vector(turned).tolist())


def matrix(rotation: Matrix) -> Matrix:
    """Turn a rotation vector (3,) in rad into a matrix (3, 3) by Rodrigues' formula."""
    angle = float(np.linalg.norm(rotation))
    x, y, z = rotation
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    if angle < 1e-12:
        return np.asarray(np.eye(3) + cross)
    k = cross / angle
    return np.asarray(np.eye(3) + math.sin(angle) * k + (1.0 - math.cos(angle)) * (k @ k))


def rotation_vector(r: Matrix) -> Matrix:
    """Give the inverse of `matrix`, with an angle of 0 to pi."""
    skew = np.array([r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]])
    sine, cosine = 0.5 * float(np.linalg.norm(skew)), 0.5 * (float(np.trace(r)) - 1.0)
    angle = math.atan2(sine, cosine)
    if angle < 1e-9:
        return 0.5 * skew
    if sine > 1e-6 or cosine > 0.0:
        return angle * skew / (2.0 * sine)
    # Near half a turn the skew part vanishes; the axis is the dominant column of (R + 1).
    column = (r + np.eye(3))[:, int(np.argmax(np.diag(r)))]
    return np.asarray(angle * column / np.linalg.norm(column))


def vector(value: Value, length: int) -> Matrix:
    """Give a list or pose of `length` numbers.

    Raises:
        Fault: anything else.

    """
    if not isinstance(value, Array | Pose) or len(value) != length:
        raise Fault(f"expected {length} numbers, got {spoken(value)}", "type")
    return np.array([number(item) for item in value])


def number(value: Value) -> float:
    """Give a number as float.

    Raises:
        Fault: anything else, True and False included.

    """
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise Fault(f"expected a number, got {spoken(value)}", "type")
    return float(value)


def _pose(position: Matrix, rotation: Matrix) -> Pose:
    return Pose([*position.tolist(), *rotation_vector(rotation).tolist()])
