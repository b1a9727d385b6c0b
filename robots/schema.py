"""What a robot file holds. Everything is data with a source; nothing is computed here."""

import math
from decimal import Decimal
from fractions import Fraction
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, field_validator, model_validator

Vector3 = tuple[float, float, float]
Vector6 = tuple[float, float, float, float, float, float]


class Frozen(BaseModel):
    """Frozen, strict about unknown keys, finite numbers only."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


def _angle(value: Any) -> Any:
    """Accept rad as a number, or a multiple of pi as text: "pi/2", "-pi/2", "0"."""
    if not isinstance(value, str):
        return value
    text = value.replace(" ", "").replace("*", "")
    try:
        turns = Fraction(
            text.replace("pi", "1", 1) if text.strip("-+").startswith("pi") else text.replace("pi", "", 1)
        )
    except (ValueError, ZeroDivisionError):
        raise ValueError('give rad as a number, or a multiple of pi as text such as "pi/2"') from None
    if "pi" not in text and turns != 0:
        raise ValueError('text must be a multiple of pi such as "pi/2"; give other angles as a number in rad')
    return float(turns) * np.pi


Angle = Annotated[float, BeforeValidator(_angle)]


class Joint(Frozen):
    """One joint, the link that it moves, and its drive; standard (distal) DH, SI units.

    `centre_of_mass` and `inertia` (xx, yy, zz, xy, xz, yz about the centre of mass) are in the link's
    DH frame; `gear`, `torque_constant` (Nm/A) and `rotor_inertia` (kg m^2) are the motor's side.
    """

    a: float
    d: float
    alpha: Angle
    offset: Angle = 0.0
    mass: float = Field(gt=0)
    centre_of_mass: Vector3
    inertia: Vector6
    gear: float = Field(gt=0)
    torque_constant: float = Field(gt=0)
    rotor_inertia: float = Field(ge=0)
    max_torque: float = Field(gt=0)
    max_speed: float = Field(gt=0)

    @field_validator("inertia")
    @classmethod
    def _physical(cls, value: Vector6) -> Vector6:
        """Principal moments are not negative and obey the triangle inequality (a body has no other)."""
        xx, yy, zz, xy, xz, yz = value
        low, middle, high = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        slack = 1e-9 * max(abs(high), 1e-12)
        if low < -slack:
            raise ValueError(f"a principal moment is negative ({low:.4g} kg m^2)")
        if low + middle < high - slack:
            raise ValueError(
                f"principal moments {low:.4g}, {middle:.4g}, {high:.4g} kg m^2 break the triangle inequality"
            )
        return value

    @property
    def drive_gain(self) -> float:
        """Joint torque per motor current, Nm/A."""
        return _decimal_product(self.gear, self.torque_constant)

    @property
    def reflected_inertia(self) -> float:
        """Rotor inertia seen at the joint, kg m^2."""
        return _decimal_product(self.gear, self.gear, self.rotor_inertia)


def _decimal_product(*numbers: float) -> float:
    """Multiply the decimals that were written: 101 * 0.1005 is 10.1505, not 10.150500000000001."""
    return float(math.prod(Decimal(repr(x)) for x in numbers))


class Robot(Frozen):
    """A serial arm of 1..6 revolute joints as data.

    gravity: acceleration of free fall in the base frame, m/s^2. source: quantity -> citation.
    """

    name: str = Field(pattern=r"^[a-z][a-z0-9_]{0,15}$")
    title: str
    gravity: Vector3
    source: dict[str, str]
    joint: tuple[Joint, ...] = Field(min_length=1, max_length=6)

    @model_validator(mode="after")
    def _sources_are_named(self) -> "Robot":
        needed = {
            "kinematics",
            "mass",
            "centre_of_mass",
            "inertia",
            "gear",
            "torque_constant",
            "rotor_inertia",
        }
        if missing := sorted(needed - set(self.source)):
            raise ValueError(f"[source] says nothing of {', '.join(missing)}")
        return self
