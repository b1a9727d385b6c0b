"""What the tests of effects share: one motion, run with an effect and without, and what differs."""

from dataclasses import dataclass

import numpy as np

from residuum.robots import load_robot
from residuum.virtual import NOISELESS, Plant, simulate
from residuum.virtual.motions import fourier
from residuum.virtual.plant import BaseFriction

ROBOT, _ = load_robot("ur5e")
GAIN = np.array([joint.drive_gain for joint in ROBOT.joint])
POSE = (0.3, -1.2, 1.4, -1.5, -1.4, 0.3)
FREE = {"sensing": NOISELESS, "friction": BaseFriction(kind="none")}
QUIET = {"sensing": NOISELESS}
MOTION = fourier(ROBOT, 4.0, seed=2, period=6.0)


@dataclass
class Change:
    """What an effect changes along MOTION: motor torque (T, 6) Nm, with the motion's own columns."""

    torque: np.ndarray
    q: np.ndarray
    qd: np.ndarray
    qdd: np.ndarray


def change(base=FREE, **effect) -> Change:
    """Run with and without; the servo holds both to the same path."""
    base_run, run = (simulate(ROBOT, Plant(**base, **extra), MOTION) for extra in ({}, effect))
    torque = (run.recording["actual_current"] - base_run.recording["actual_current"]) * GAIN
    return Change(torque, MOTION.q, MOTION.qd, MOTION.qdd)


def rms(values) -> np.ndarray:
    return np.sqrt(np.mean(np.square(values), axis=0))


def only(torque, joints, share=0.02):
    """The other joints feel next to nothing."""
    size = rms(torque)
    others = [k for k in range(6) if k + 1 not in joints]
    assert size[others].max() < share * max(size[[j - 1 for j in joints]].max(), 1e-9), size
