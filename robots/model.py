"""What model.toml holds: the one currency between the commands.

A model is kinematics, drive gains, rigid-body base parameters and a list of terms; everything that
was measured carries its standard deviation and source, and the inputs are named by hash.
"""

from typing import Literal

from pydantic import Field, model_validator

from .schema import Angle, Frozen, Vector3


class ModelJoint(Frozen):
    """Geometry (standard DH: m, rad) and drive of one moving joint; gain in Nm/A, joint side."""

    a: float
    d: float
    alpha: Angle
    offset: Angle = 0.0
    drive_gain: float = Field(gt=0)
    drive_gain_std: float | None = Field(default=None, ge=0)
    max_torque: float = Field(gt=0)
    max_speed: float = Field(gt=0)


class Value(Frozen):
    """A number with its unit, standard deviation (None: not measured) and source."""

    value: float
    unit: str
    std: float | None = Field(default=None, ge=0)
    source: str = ""


class TermData(Frozen):
    """A term of the catalogue on one joint (1..6) with its parameters' values."""

    name: str
    joint: int = Field(ge=1, le=6)
    parameters: dict[str, float] = {}
    std: dict[str, float] = {}
    source: str = ""


class Thresholds(Frozen):
    """Detection thresholds (Nm, one a joint) at a stated rate of false alarms per hour.

    The limit grows with speed: static + per_speed * |qd| (per_speed in Nm s/rad).
    """

    static: tuple[float, ...]
    per_speed: tuple[float, ...] = ()
    false_alarms_per_hour: float | None = Field(default=None, gt=0)
    source: str = ""


class Input(Frozen):
    """An input that the model was made from."""

    name: str
    sha256: str


class Model(Frozen):
    """A robot model that can be generated, fitted and explained; see the contract's model.toml."""

    format: Literal[1] = 1
    robot: str = Field(pattern=r"^[a-z][a-z0-9_]{0,15}$")
    title: str
    variant: Literal["full", "thesis"] = "full"
    gravity: Vector3
    locked_angles: tuple[float, ...] = ()
    observer_gain: float = Field(default=25.0, gt=0)
    joint: tuple[ModelJoint, ...] = Field(min_length=1, max_length=6)
    base: dict[str, Value]
    term: tuple[TermData, ...] = ()
    thresholds: Thresholds | None = None
    source: dict[str, str] = {}
    inputs: tuple[Input, ...] = ()

    @model_validator(mode="after")
    def _sizes_agree(self) -> "Model":
        for i, term in enumerate(self.term):
            if term.joint > self.dof:
                raise ValueError(
                    f"term[{i}] {term.name} sits on joint {term.joint}, the model has {self.dof}"
                )
        if self.thresholds and len(self.thresholds.static) != self.dof:
            raise ValueError(f"thresholds: static needs {self.dof} values, one a joint")
        if self.thresholds and self.thresholds.per_speed and len(self.thresholds.per_speed) != self.dof:
            raise ValueError(f"thresholds: per_speed needs {self.dof} values, one a joint")
        return self

    @property
    def name(self) -> str:
        """ROBOT_dofN: the generated folder and the prefix of the C functions."""
        return f"{self.robot}_dof{self.dof}"

    @property
    def dof(self) -> int:
        """Number of moving joints."""
        return len(self.joint)
