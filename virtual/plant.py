"""The plant: what this particular robot and its surroundings do beside the robot file.

A plant is data: `load_plant("arm.toml")`, or the same as Python values. Fields carry the names of the
effect catalogue; a field left out is switched off. Lists hold one entry per joint that is affected.
"""

from pathlib import Path
from typing import Literal

from pydantic import Field, model_validator

from ..robots.schema import Frozen, Vector6
from ..robots.toml import read
from .effects import (
    ZERO6,
    Backlash,
    BaseTilt,
    CableSpring,
    CoulombFriction,
    CurrentOffset,
    DataFault,
    DriveGain,
    EncoderOffset,
    FrictionAsymmetry,
    JointElasticity,
    LinkInertial,
    LoadDependentFriction,
    NonlinearViscous,
    Outside,
    Payload,
    PositionDependentFriction,
    PreslidingHysteresis,
    RotorInertia,
    Stribeck,
    TemperatureDependentFriction,
    TimeDelay,
    TorqueRipple,
    VelocityLag,
    ViscousFriction,
)
from .surroundings import Contact, Obstacle


class BaseFriction(Frozen):
    """The friction of the healthy joint. factory: the UR5e's sheet; none: a joint without any.

    travel: presliding before the Coulomb level is reached, rad. speed and torque give another curve:
    rad/s rising from negative to positive, and one row of joint-side Nm per joint; stiction: (-, +) rows.
    """

    kind: Literal["factory", "none", "curve"] = "factory"
    travel: float = Field(default=3.0e-4, gt=0)
    speed: tuple[float, ...] = ()
    torque: tuple[tuple[float, ...], ...] = ()
    stiction: tuple[tuple[float, float], ...] = ()

    @model_validator(mode="after")
    def _curve_is_complete(self) -> "BaseFriction":
        if self.kind != "curve":
            return self
        if not self.speed or not self.torque or len(self.torque) != len(self.stiction):
            raise ValueError("a curve needs speed, and one row of torque and of stiction per joint")
        if any(len(row) != len(self.speed) for row in self.torque):
            raise ValueError("every row of torque needs one value per speed")
        if list(self.speed) != sorted(set(self.speed)) or 0.0 in self.speed:
            raise ValueError("speed must rise, without 0 (stiction says what happens there)")
        if not self.speed[0] < 0.0 < self.speed[-1]:
            raise ValueError("speed needs negative and positive values")
        if any(low > 0.0 or high < 0.0 for low, high in self.stiction):
            raise ValueError("stiction needs a value <= 0 and a value >= 0 per joint")
        return self


class Thermal(Frozen):
    """Heat of a joint: C dT/dt = friction loss + copper loss + idle - (T - ambient) / R.

    start: deg C per joint. The factory sheet's curves hold at about 43 deg C.
    """

    start: Vector6 = (43.0, 43.0, 43.0, 43.0, 43.0, 43.0)
    ambient: float = 25.0
    resistance: float = Field(default=0.6, gt=0)  # K/W
    capacity: float = Field(default=3000.0, gt=0)  # J/K, so the time constant is 30 min
    winding: float = Field(default=0.5, ge=0)  # ohm
    idle: float = Field(default=25.0, ge=0)  # W of electronics


class Sensing(Frozen):
    """Noise (one sigma per 2 ms sample) and resolution of what RTDE reports; docs/virtual.md has the sources.

    current_growth: current noise is multiplied by 1 + growth |qd|. standstill: slower reads as 0.
    """

    current_noise: Vector6 = (0.045, 0.045, 0.03, 0.014, 0.013, 0.013)  # A
    current_growth: float = Field(default=1.0, ge=0)  # s/rad
    current_resolution: float = Field(default=0.001, ge=0)  # A
    position_noise: float = Field(default=5.0e-6, ge=0)  # rad
    position_resolution: float = Field(default=1.1984225e-5, ge=0)  # rad, 2 pi / 2^19
    speed_noise: float = Field(default=8.0e-4, ge=0)  # rad/s
    speed_growth: float = Field(default=2.0e-3, ge=0)  # rad/s per rad/s
    standstill: float = Field(default=5.0e-4, ge=0)  # rad/s
    temperature_resolution: float = Field(default=0.0625, ge=0)  # K
    force_noise: float = Field(default=0.15, ge=0)  # N
    moment_noise: float = Field(default=0.005, ge=0)  # Nm
    force_bias: Vector6 = ZERO6  # N, Nm


NOISELESS = Sensing(
    current_noise=ZERO6, current_resolution=0.0, position_noise=0.0, position_resolution=0.0, speed_noise=0.0,
    speed_growth=0.0, standstill=0.0, temperature_resolution=0.0, force_noise=0.0, moment_noise=0.0,
)  # fmt: skip


class Plant(Frozen):
    """One robot, its friction, its sensors, its surroundings, and what is wrong with it."""

    friction: BaseFriction = BaseFriction()
    thermal: Thermal = Thermal()
    sensing: Sensing = Sensing()
    substeps: int | None = Field(default=None, ge=1, le=100)  # per 2 ms; None: 2, or 8 with an elastic joint
    payload: Payload | None = None
    link_inertial: tuple[LinkInertial, ...] = ()
    base_tilt: BaseTilt | None = None
    rotor_inertia: tuple[RotorInertia, ...] = ()
    drive_gain: tuple[DriveGain, ...] = ()
    coulomb_friction: tuple[CoulombFriction, ...] = ()
    viscous_friction: tuple[ViscousFriction, ...] = ()
    friction_asymmetry: tuple[FrictionAsymmetry, ...] = ()
    current_offset: tuple[CurrentOffset, ...] = ()
    stribeck: tuple[Stribeck, ...] = ()
    nonlinear_viscous: tuple[NonlinearViscous, ...] = ()
    load_dependent_friction: tuple[LoadDependentFriction, ...] = ()
    temperature_dependent_friction: tuple[TemperatureDependentFriction, ...] = ()
    presliding_hysteresis: tuple[PreslidingHysteresis, ...] = ()
    joint_elasticity: tuple[JointElasticity, ...] = ()
    torque_ripple: tuple[TorqueRipple, ...] = ()
    backlash: tuple[Backlash, ...] = ()
    position_dependent_friction: tuple[PositionDependentFriction, ...] = ()
    cable_spring: tuple[CableSpring, ...] = ()
    encoder_offset: tuple[EncoderOffset, ...] = ()
    time_delay: tuple[TimeDelay, ...] = ()
    velocity_lag: tuple[VelocityLag, ...] = ()
    external_contact: tuple[Contact, ...] = ()
    obstacle: tuple[Obstacle, ...] = ()
    data_fault: DataFault | None = None
    outside: Outside = Outside()

    @model_validator(mode="after")
    def _one_gear_a_joint(self) -> "Plant":
        soft = [e.joint for e in self.joint_elasticity] + [e.joint for e in self.backlash]
        if len(soft) != len(set(soft)):
            raise ValueError(
                "a joint takes one entry of joint_elasticity or backlash (backlash has a stiffness too)"
            )
        return self

    def effects(self) -> dict[str, object]:
        """Return what is switched on, name -> parameters; outside the catalogue as "outside.name"."""
        settings = {"friction", "thermal", "sensing", "substeps", "obstacle", "outside"}
        on = {name: value for name, value in self.model_dump().items() if name not in settings and value}
        return on | {f"outside.{name}": value for name, value in self.outside.model_dump().items() if value}


def load_plant(path: Path | str) -> Plant:
    """Return the plant of a TOML file.

    Raises InputError with one line that names file, line and key: not readable, unknown key, bad value.
    """
    return read(Plant, Path(path))[0]
