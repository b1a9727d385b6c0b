"""How large an effect is: rms of what it changes over rms of what a plain model leaves on the healthy robot.

Both in Nm, after a zero-phase low-pass at 10 Hz, over samples that move, per joint.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.signal import butter, sosfiltfilt

from ..robots import Robot
from ..virtual import Run

Array = npt.NDArray[np.float64]
CUTOFF = 10.0  # Hz
MOVING = 0.01  # rad/s


@dataclass(frozen=True)
class Scale:
    """The yardstick of a healthy robot on its motions: residual rms (N,) Nm, split into noise and misfit."""

    noise: Array
    misfit: Array

    @property
    def residual(self) -> Array:
        """Residual rms (N,) Nm."""
        return np.asarray(np.hypot(self.noise, self.misfit))


def gains(robot: Robot) -> Array:
    """Return the robot file's drive gains (N,) in Nm/A."""
    return np.array([joint.drive_gain for joint in robot.joint])


def low_pass(values: Array, rate: float) -> Array:
    """Return values (T, N) without what is faster than 10 Hz."""
    return np.asarray(sosfiltfilt(butter(2, CUTOFF, fs=rate, output="sos"), values, axis=0))


def scale_of(robot: Robot, runs: Sequence[Run], rate: float) -> Scale:
    """Return the yardstick from healthy runs: sensor noise, and misfit of Coulomb and viscous friction."""
    noise = [
        low_pass(gains(robot) * (run.recording["actual_current"] - run.truth.rows.current), rate)
        for run in runs
    ]
    moving = [_moving(run) for run in runs]
    return Scale(_rms(noise, moving), _rms(_misfits(runs, rate), moving))


def changes(robot: Robot, affected: Sequence[Run], healthy: Sequence[Run], rate: float) -> list[Array]:
    """Return what the effect changes of the measured torque (T, N) Nm; both with the same sensor noise.

    Affected runs may be shorter than the healthy ones.
    """
    found = []
    for ill, well in zip(affected, healthy, strict=True):
        current = ill.recording["actual_current"]
        found.append(
            low_pass(gains(robot) * (current - well.recording["actual_current"][: len(current)]), rate)
        )
    return found


def ratios(robot: Robot, scale: Scale, affected: Sequence[Run], healthy: Sequence[Run], rate: float) -> Array:
    """Return effect rms over residual rms (N,)."""
    moving = [_moving(run) for run in affected]
    return np.asarray(_rms(changes(robot, affected, healthy, rate), moving) / scale.residual)


def survives(robot: Robot, affected: Sequence[Run], healthy: Sequence[Run], rate: float) -> Array:
    """Return the share (N,) of the change's rms that an offset, Coulomb and viscous friction do not take."""
    moving = [_moving(run) for run in affected]
    change = changes(robot, affected, healthy, rate)
    left = np.ones(moving[0].shape[1])
    for j in range(len(left)):
        speed = np.concatenate([r.truth.rows.qd[m[:, j], j] for r, m in zip(affected, moving, strict=True)])
        y = np.concatenate([c[m[:, j], j] for c, m in zip(change, moving, strict=True)])
        if len(y) < 10 or not y.any():
            continue
        left[j] = beside_friction(speed, y)
    return left


def beside_friction(speed: Array, torque: Array) -> float:
    """Return the share of a torque's rms (T,) that an offset, Coulomb and viscous friction do not take."""
    x = np.column_stack([np.ones_like(speed), np.sign(speed), speed])
    rest = torque - x @ np.linalg.lstsq(x, torque, rcond=None)[0]
    return float(np.linalg.norm(rest) / np.linalg.norm(torque))


def _misfits(runs: Sequence[Run], rate: float) -> list[Array]:
    """Return true friction less its best Coulomb and viscous fit (T, N) Nm, zero where the joint stands."""
    found = [np.zeros_like(run.truth.rows.friction) for run in runs]
    moving = [_moving(run) for run in runs]
    for j in range(found[0].shape[1]):
        speed = np.concatenate([r.truth.rows.qd[m[:, j], j] for r, m in zip(runs, moving, strict=True)])
        y = np.concatenate([r.truth.rows.friction[m[:, j], j] for r, m in zip(runs, moving, strict=True)])
        if len(y) < 10:
            continue
        x = np.column_stack([np.sign(speed), speed])
        rest, at = y - x @ np.linalg.lstsq(x, y, rcond=None)[0], 0
        for out, m in zip(found, moving, strict=True):
            count = int(m[:, j].sum())
            out[m[:, j], j] = rest[at : at + count]
            at += count
    return [low_pass(out, rate) for out in found]


def _moving(run: Run) -> npt.NDArray[np.bool_]:
    return np.asarray(np.abs(run.truth.rows.qd) > MOVING)


def _rms(values: Sequence[Array], chosen: Sequence[npt.NDArray[np.bool_]]) -> Array:
    """Return root mean squares (N,) over chosen samples of all runs."""
    total = sum((np.where(c, v, 0.0) ** 2).sum(0) for v, c in zip(values, chosen, strict=True))
    return np.asarray(np.sqrt(total / np.maximum(sum(c.sum(0) for c in chosen), 1)))
