"""What model.toml holds: the one currency between the commands.

A model is kinematics, drive gains, rigid-body base parameters and a list of terms; everything that
was measured carries its standard deviation and source, and the inputs are named by hash.
"""

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, SerializerFunctionWrapHandler, model_serializer, model_validator

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

    The limit grows with speed: static + per_speed * |qd| (per_speed in Nm s/rad). static_only: limits of
    the same rate that do not. std: standard deviation of the limit at rest and at static_only. hours: of
    collision-free motion that they are from; above 1 / false_alarms_per_hour nothing was extrapolated.
    """

    static: tuple[float, ...]
    per_speed: tuple[float, ...] = ()
    false_alarms_per_hour: float | None = Field(default=None, gt=0)
    static_only: tuple[float, ...] | None = None
    std: tuple[float, ...] | None = None
    static_only_std: tuple[float, ...] | None = None
    hours: float | None = Field(default=None, gt=0)
    source: str = ""

    @model_serializer(mode="wrap")
    def _without_nothing(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Leave out what was not measured, so that a model's hash does not depend on keys it lacks."""
        return {k: v for k, v in handler(self).items() if v is not None or k == "false_alarms_per_hour"}


class Covariance(Frozen):
    """Covariance of fitted parameters: names, and a row of numbers a parameter (lower triangle), as text.

    Names are base parameters and terms' symbols, such as MX2 and coulomb2_Fc.
    """

    names: tuple[str, ...]
    rows: tuple[str, ...]

    @model_validator(mode="after")
    def _is_a_triangle(self) -> "Covariance":
        if [len(row.split()) for row in self.rows] != list(range(1, len(self.names) + 1)):
            raise ValueError("covariance: rows must be a lower triangle, one row a name")
        self.matrix()
        return self

    def matrix(self) -> NDArray[np.float64]:
        """Return the matrix (P, P)."""
        lower = np.zeros((len(self.names), len(self.names)))
        for i, row in enumerate(self.rows):
            lower[i, : i + 1] = [float(x) for x in row.split()]
        return lower + np.tril(lower, -1).T


class FitRecord(Frozen):
    """How a model was fitted and how well it predicts; lists have one value a joint.

    held_out_percent: error norm over torque norm on what was left out, where the arm moves; held_out_rms in
    Nm; residual_memory: integrated autocorrelation time of the residual, s. directions: how many of
    `parameters` combinations the recordings determine better than the prior did.
    """

    scheme: str
    form: str
    cutoff: float = Field(gt=0)
    order: int = Field(gt=0)
    zero_phase: bool
    folds: int
    left_out: str
    held_out_percent: tuple[float, ...]
    held_out_rms: tuple[float, ...]
    noise: tuple[float, ...]
    residual_memory: tuple[float, ...]
    parameters: int
    directions: int
    gains: str
    notes: tuple[str, ...] = ()


class Input(Frozen):
    """An input that the model was made from."""

    name: str
    sha256: str


class ThesisFriction(Frozen):
    """Friction of Gylling 2019, eq. 3.2.8, one value a joint (1-3); generated code does not use it.

    noise_band: rad/s; coulomb, stiction in Nm; viscous b1, b2, b3 in Nm (s/rad)^k; position: Nm/rad on joints
    2 and 3; reach_gain: (a, b) of a exp(b |A + B|) on joint 1, |A + B| in m.
    """

    noise_band: tuple[float, ...]
    coulomb: tuple[float, ...]
    stiction: tuple[float, ...]
    b1: tuple[float, ...]
    b2: tuple[float, ...]
    b3: tuple[float, ...]
    position: tuple[float, ...]
    reach_gain: tuple[float, float]


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
    fit: FitRecord | None = None
    covariance: Covariance | None = None
    thesis: ThesisFriction | None = None
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

    @model_serializer(mode="wrap")
    def _without_fit(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Leave out what only a fitted model has, so that another's hash is that of its numbers."""
        fitted = ("fit", "covariance", "thesis")
        return {k: v for k, v in handler(self).items() if v is not None or k not in fitted}

    @property
    def name(self) -> str:
        """ROBOT_dofN: the generated folder and the prefix of the C functions."""
        return f"{self.robot}_dof{self.dof}"

    @property
    def dof(self) -> int:
        """Number of moving joints."""
        return len(self.joint)
