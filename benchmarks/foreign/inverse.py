"""A foreign robot without a simulation: inverse dynamics along a path, and friction added to it.

So most quick generators make recordings: the motion is given, friction is a hyperbolic tangent of speed, noise is
white and slow together. At rest there is none of it.
"""

from dataclasses import replace

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, lfilter, sosfiltfilt

from residuum.recordings import Recording
from residuum.robots import Robot

from .arm import Change, Healthy, dry_level, heated, inverse, models, sensed
from .changes import LARGE
from .paths import STEP

Array = NDArray[np.float64]

#: Hz; the motion has an acceleration everywhere. Slack closes over this part of a torque that matters.
SMOOTH, CLOSES = 8.0, 0.3
#: Of the current's noise: its slow part, and what the next sample keeps of that (0.4 s).
SLOW, KEEPS = 0.7, 0.995


def along(
    robot: Robot, healthy: Healthy, change: Change, path: Array, rate: int, seed: int, warmer: float
) -> Recording:
    """Return the recording of a motion along a path (T, 6); see `arm.record`. healthy.soft: rad/s of the tangent."""
    model, _ = models(robot, healthy, change)
    model.dof_frictionloss[:], model.dof_damping[:] = 0.0, 0.0
    time = np.arange(len(path)) * STEP
    q = sosfiltfilt(butter(3, SMOOTH, fs=1 / STEP, output="sos"), path, axis=0)
    hot = heated(healthy, warmer, time)
    real = q + change.encoder
    torque = _held(robot, healthy, change, real, inverse(model, real, *_slopes(q)))
    torque = torque - _pushes(model, change, real)
    load = torque - model.dof_armature * _slopes(q)[1]
    q = q + _given(change, load)  # the encoder sits on the motor
    qd, qdd = _slopes(q)
    sign = _signs(change, time, qd, healthy.soft)
    states = list(zip(q, qd, load, hot, strict=True))
    dry = dry_level(healthy, qd) + np.array([change.dry(*x) for x in states])
    drag = healthy.damping * qd + np.array([change.drag(*x) for x in states])
    torque = load + model.dof_armature * qdd + dry * sign + drag + healthy.offset
    if change.later is not None:
        torque = torque + change.later(time, q, sign)
    gains = np.array([x.drive_gain for x in robot.joint])
    current = torque / gains / change.gain
    white = np.random.default_rng([seed, 1]).standard_normal(q.shape)
    slow = lfilter([np.sqrt(1 - KEEPS**2)], [1, -KEEPS], white, axis=0)
    current = current + SLOW * healthy.noise * slow
    fast = replace(healthy, noise=np.sqrt(1 - SLOW**2) * healthy.noise)
    return sensed(time, q, qd, current, hot, fast, change, rate, seed)


def _slopes(q: Array) -> tuple[Array, Array]:
    speed = np.gradient(q, STEP, axis=0)
    return speed, np.gradient(speed, STEP, axis=0)


def _held(robot: Robot, healthy: Healthy, change: Change, q: Array, torque: Array) -> Array:
    """Return the torque (T, 6) of an arm that holds its load only in some spans."""
    if change.held is None:
        return torque
    bare, _ = models(robot, healthy, replace(change, load=None))
    bare.dof_frictionloss[:], bare.dof_damping[:] = 0.0, 0.0
    share = np.arange(len(q)) / len(q)
    holds = np.any([(a <= share) & (share < b) for a, b in change.held], axis=0)
    return np.where(holds[:, None], torque, inverse(bare, q, *_slopes(q)))


def _pushes(model: mujoco.MjModel, change: Change, q: Array) -> Array:
    """Return what a push takes off the drives, (T, 6) Nm."""
    data, (link, place), found = mujoco.MjData(model), change.push, np.zeros_like(q)
    turns = np.zeros((3, model.nv))
    for i in range(len(q)):
        if (force := change.force(i / len(q))) is not None:
            data.qpos[:] = q[i]
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            at = data.xpos[link] + data.xmat[link].reshape(3, 3) @ place
            mujoco.mj_jac(model, data, turns, None, at, link)
            found[i] = turns.T @ force
    return found


def _given(change: Change, load: Array) -> Array:
    """Return by how much the motor is ahead of its link, (T, 6) rad: wound up, or on the other flank."""
    found = np.zeros_like(load)
    for j in (k - 1 for k in change.joints):
        if change.gear.stiffness:
            found[:, j] = load[:, j] / change.gear.stiffness
        if change.gear.gap:
            found[:, j] = change.gear.gap * np.tanh(load[:, j] / (CLOSES * LARGE[j]))
    return found


def _signs(change: Change, time: Array, qd: Array, soft: float) -> Array:
    """Return the sign of friction (T, 6)."""
    found = np.tanh(qd / soft)
    for j in (k - 1 for k in change.joints):
        if change.gear.late:
            found[:, j] = np.tanh(np.interp(time - change.gear.late, time, qd[:, j]) / soft)
        if change.gear.bristle:
            kept, z = np.exp(-np.abs(qd[:, j]) * STEP / change.gear.bristle), 0.0
            for i, way in enumerate(np.sign(qd[:, j])):
                z = way + (z - way) * kept[i]
                found[i, j] = z
    return found
