"""The effects as data: what may be wrong with a robot, each with its physical parameters (SI units).

The names follow the effect catalogue; those at the end are outside it.
"""

from typing import Annotated, Literal

from pydantic import Field, field_validator

from ..robots.schema import Frozen, Vector3, Vector6
from .model import impossible, symmetric

ZERO3: Vector3 = (0.0, 0.0, 0.0)
ZERO6: Vector6 = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


class OnJoint(Frozen):
    """An effect that sits on one joint, 1..6."""

    joint: int = Field(ge=1, le=6)


class Payload(Frozen):
    """A body at the flange. intervals: (from, to) in s when it is held; empty = always.

    declared: the controller was told (feed-forward, target_moment and the wrist sensor then allow for it).
    """

    mass: float = Field(gt=0)
    centre_of_mass: Vector3 = ZERO3
    inertia: Vector6 = ZERO6
    intervals: tuple[tuple[float, float], ...] = ()
    declared: bool = False

    @field_validator("inertia")
    @classmethod
    def _physical(cls, value: Vector6) -> Vector6:
        if problem := impossible(symmetric(value)):
            raise ValueError(problem)
        return value


class LinkInertial(Frozen):
    """Added to a link of the robot file: mass (kg), centre of mass (m), inertia about it (kg m^2)."""

    link: int = Field(ge=1, le=6)
    mass: float = 0.0
    centre_of_mass: Vector3 = ZERO3
    inertia: Vector6 = ZERO6


class BaseTilt(Frozen):
    """The base is turned by roll about its x, then pitch about y (rad); the controller was not told."""

    roll: float = 0.0
    pitch: float = 0.0


class RotorInertia(OnJoint):
    """share: the rotor has (1 + share) times the inertia of the robot file."""

    share: float = Field(gt=-1)


class DriveGain(OnJoint):
    """error: torque = (1 + error) K i with the robot file's K."""

    error: float = Field(gt=-1)


class CoulombFriction(OnJoint):
    """torque: added to the Coulomb level, Nm."""

    torque: float


class ViscousFriction(OnJoint):
    """damping: added linear drag, Nm s/rad."""

    damping: float


class FrictionAsymmetry(OnJoint):
    """torque: added to the Coulomb level in the positive, taken from it in the negative direction, Nm."""

    torque: float


class CurrentOffset(OnJoint):
    """offset of the measured current, A."""

    offset: float


class Stribeck(OnJoint):
    """Stiction above the Coulomb level: torque exp(-(|qd| / speed)^exponent), Nm and rad/s."""

    torque: float = Field(gt=0)
    speed: float = Field(gt=0)
    exponent: float = Field(default=2.0, gt=0)


class NonlinearViscous(OnJoint):
    """Drag odd in qd: quadratic c qd|qd|, cubic c qd^3, power c |qd|^exponent sgn, tanh c tanh(qd / speed).

    coefficient: Nm per (rad/s)^n, Nm for tanh.
    """

    shape: Literal["quadratic", "cubic", "power", "tanh"]
    coefficient: float
    exponent: float = Field(default=0.65, gt=0)
    speed: float = Field(default=1.0, gt=0)


class LoadDependentFriction(OnJoint):
    """Coulomb level grows by coefficient |torque that the gear transmits|."""

    coefficient: float = Field(ge=0)


class TemperatureDependentFriction(OnJoint):
    """Factors on the Coulomb and the viscous part, per K above reference (deg C).

    linear: 1 + c (T - reference); exponential: exp(c (T - reference)).
    """

    coulomb: float = 0.0
    viscous: float = 0.0
    reference: float = 43.0
    shape: Literal["linear", "exponential"] = "linear"


class PreslidingHysteresis(OnJoint):
    """How friction builds up with travel after a reversal. travel: rad.

    dahl: Dahl 1976, dz = qd (1 - z sgn qd) / travel; maxwell: four elasto-plastic elements in parallel
    (Al-Bender, Lampaert, Swevers 2005) whose last one slides at `travel`.
    """

    travel: float = Field(gt=0)
    law: Literal["dahl", "maxwell"] = "dahl"


class JointElasticity(OnJoint):
    """Gear between motor (with the encoder) and link: stiffness Nm/rad, damping Nm s/rad."""

    stiffness: float = Field(gt=0)
    damping: float = Field(default=10.0, ge=0)


class TorqueRipple(OnJoint):
    """torque cos(order gear q_motor + phase), order per motor turn; several entries may share a joint."""

    torque: float
    order: float = Field(default=2.0, gt=0)
    phase: float = 0.0


class Backlash(OnJoint):
    """Dead zone of +-gap (rad) between motor and link, with the gear's stiffness outside it."""

    gap: float = Field(gt=0)
    stiffness: float = Field(default=2.0e4, gt=0)
    damping: float = Field(default=20.0, ge=0)


class PositionDependentFriction(OnJoint):
    """Coulomb level grows by sine sin(order q) + cosine cos(order q), Nm; never below zero in sum."""

    sine: float = 0.0
    cosine: float = 0.0
    order: float = Field(default=1.0, gt=0)


class CableSpring(OnJoint):
    """Torque on the link -stiffness (q - rest) + constant, Nm/rad, rad, Nm."""

    stiffness: float
    rest: float = 0.0
    constant: float = 0.0


class EncoderOffset(OnJoint):
    """actual_q = q + offset, rad."""

    offset: float


class TimeDelay(Frozen):
    """delay (s) of measured channels behind the clock. channels: currents, or q, qd and currents.

    joints: numbers from 1; empty = all.
    """

    delay: float = Field(ge=0, le=0.2)
    channels: Literal["current", "all"] = "current"
    joints: tuple[Annotated[int, Field(ge=1, le=6)], ...] = ()


class VelocityLag(OnJoint):
    """Friction keeps its old direction for about `lag` s after a reversal (Hess and Soom 1990)."""

    lag: float = Field(gt=0, le=0.1)


class StuckChannel(Frozen):
    """A column that keeps its value from start to end (s), e.g. "actual_current_2"."""

    column: str
    start: float
    end: float


class DataFault(Frozen):
    """Faults of the recording, not of the robot.

    late: mean extra time between samples, s (in steps of 2 ms; stamps stay true, as in public UR10e logs).
    stamp_noise: error of the stamps, s. gaps: (from, to) in s without rows. absurd: rows that carry values
    such as 1e293. cut: rows that end in the middle of a line.
    """

    late: float = Field(default=0.0, ge=0)
    stamp_noise: float = Field(default=0.0, ge=0)
    gaps: tuple[tuple[float, float], ...] = ()
    stuck: tuple[StuckChannel, ...] = ()
    absurd: tuple[int, ...] = ()
    cut: tuple[int, ...] = ()


class ToothDefect(OnJoint):
    """One bad tooth: Coulomb level grows by torque in a window of `width` rad at `at` rad of the output."""

    torque: float = Field(gt=0)
    at: float = 0.0
    width: float = Field(default=0.02, gt=0)


class LooseCable(OnJoint):
    """Torque noise (rms Nm, about 30 Hz wide) while q is within `width` of `at`."""

    torque: float = Field(gt=0)
    at: float = 0.0
    width: float = Field(default=0.3, gt=0)


class Amplifier(OnJoint):
    """deadband: |current| that is measured but gives no torque; limit: largest current. A."""

    deadband: float = Field(default=0.0, ge=0)
    limit: float | None = Field(default=None, gt=0)


class LoadedCogging(OnJoint):
    """Cogging that grows with load: coefficient |gear torque| cos(order gear q + phase)."""

    coefficient: float = Field(gt=0)
    order: float = Field(default=4.0, gt=0)
    phase: float = 0.0


class SlippingBrake(OnJoint):
    """A brake that drags during intervals (s): between half and all of torque (Nm), at `judder` Hz."""

    torque: float = Field(gt=0)
    intervals: tuple[tuple[float, float], ...]
    judder: float = Field(default=7.0, ge=0)


class Outside(Frozen):
    """Physics that the catalogue has no name for: the honest answer there is "unknown"."""

    tooth_defect: tuple[ToothDefect, ...] = ()
    loose_cable: tuple[LooseCable, ...] = ()
    amplifier: tuple[Amplifier, ...] = ()
    loaded_cogging: tuple[LoadedCogging, ...] = ()
    slipping_brake: tuple[SlippingBrake, ...] = ()
