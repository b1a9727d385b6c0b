"""The healthy robot of a case: what varies from unit to unit and is no finding."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..robots import Robot
from ..virtual import Plant
from ..virtual.effects import DriveGain, LinkInertial, RotorInertia
from ..virtual.friction import SHEET_SPEED, curves
from ..virtual.plant import BaseFriction, Thermal

Array = npt.NDArray[np.float64]
LEVEL_SPREAD = 0.3  # friction between units, share
LINK_SPREAD = 0.04  # of mass, centre of mass and inertia
ROTOR_SPREAD = 0.1
GAIN_SPREAD = 0.03
COLD, WARM = 28.0, 42.0  # deg C


@dataclass(frozen=True)
class Friction:
    """Factory friction in short: Coulomb level (N,) Nm and slope (N,) Nm s/rad, joint side."""

    level: Array
    slope: Array


def factory(robot: Robot) -> Friction:
    """Return level and slope of a line through the factory's points at 0.5 and 1.5 rad/s."""
    points = [curve.drag(np.array([0.5, 1.5])) + curve.high for curve in curves(robot, BaseFriction())]
    half, fast = np.array(points).T
    slope = fast - half
    return Friction(half - 0.5 * slope, slope)


def rich(robot: Robot, rng: np.random.Generator) -> Plant:
    """Return a healthy unit with its own friction, links, rotors and gains: richer than any model."""
    factors = rng.uniform(1.0 - LEVEL_SPREAD, 1.0 + LEVEL_SPREAD, len(robot.joint))
    rotors = rng.uniform(-ROTOR_SPREAD, ROTOR_SPREAD, len(robot.joint))
    gains = rng.uniform(-GAIN_SPREAD, GAIN_SPREAD, len(robot.joint))
    return Plant(
        friction=_sheet_times(robot, factors),
        link_inertial=tuple(_link(robot, k, rng) for k in range(1, len(robot.joint) + 1)),
        rotor_inertia=tuple(RotorInertia(joint=k, share=float(s)) for k, s in enumerate(rotors, 1)),
        drive_gain=tuple(DriveGain(joint=k, error=float(e)) for k, e in enumerate(gains, 1)),
    )


def plain(robot: Robot, rng: np.random.Generator) -> Plant:
    """Return a unit that the published model with Coulomb and linear viscous friction describes."""
    low, high = 1.0 - LEVEL_SPREAD, 1.0 + LEVEL_SPREAD
    usual = factory(robot)
    level = usual.level * rng.uniform(low, high, len(usual.level))
    slope = usual.slope * rng.uniform(low, high, len(usual.level))
    top = 3.0  # rad/s; the curve goes straight on
    rows = tuple((-float(a + top * b), float(a + top * b)) for a, b in zip(level, slope, strict=True))
    still = tuple((-float(a), float(a)) for a in level)
    return Plant(friction=BaseFriction(kind="curve", speed=(-top, top), torque=rows, stiction=still))


def temperatures(rng: np.random.Generator, recordings: int) -> list[Thermal]:
    """Return the heat at the start of each recording: a day's spread of 1-14 K, joints a little apart."""
    joints = rng.uniform(-1.5, 1.5, 6)
    spread = rng.uniform(1.0, WARM - COLD)
    lowest = rng.uniform(COLD, WARM - spread)
    starts = lowest + spread * np.linspace(0.0, 1.0, recordings)
    rng.shuffle(starts)
    return [Thermal(start=_six(start + joints)) for start in starts]


def _sheet_times(robot: Robot, factors: Array) -> BaseFriction:
    """Return the factory's curves, each joint's times a factor."""
    speed = np.array(SHEET_SPEED)
    sheet = curves(robot, BaseFriction())
    torque = [
        f * (np.where(speed < 0, c.low, c.high) + c.drag(speed)) for f, c in zip(factors, sheet, strict=True)
    ]
    still = tuple((float(f * c.low), float(f * c.high)) for f, c in zip(factors, sheet, strict=True))
    rows = tuple(tuple(float(x) for x in row) for row in torque)
    return BaseFriction(kind="curve", speed=SHEET_SPEED, torque=rows, stiction=still)


def _link(robot: Robot, number: int, rng: np.random.Generator) -> LinkInertial:
    """Return a link's deviation from the published numbers; its inertia keeps its shape."""
    joint = robot.joint[number - 1]
    mass, tensor = rng.uniform(-LINK_SPREAD, LINK_SPREAD, 2)
    reach = LINK_SPREAD * float(np.linalg.norm(joint.centre_of_mass))
    x, y, z = (float(v) for v in rng.uniform(-reach, reach, 3))
    inertia = _six(tensor * np.array(joint.inertia))
    return LinkInertial(link=number, mass=float(mass * joint.mass), centre_of_mass=(x, y, z), inertia=inertia)


def _six(values: Array) -> tuple[float, float, float, float, float, float]:
    a, b, c, d, e, f = (float(v) for v in values)
    return a, b, c, d, e, f
