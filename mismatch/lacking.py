"""What a simplified model lacks by its very form: joints that it holds still, couplings that it drops.

Each is a fuller arm less the simpler one. Both come from their own Lagrangian, so no coupling is written
here.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from types import ModuleType
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ..codegen.generate import observer_text
from ..codegen.load import load_text
from ..codegen.regressors import Regressor
from ..recordings import Recording
from ..robots import Robot
from ..robots.model import Model
from ..symbolic.nominal import nominal_model
from .physics import published

Array = NDArray[np.float64]

#: rad; a joint that stays this close to the angle at which the model locks it does nothing to the others.
_TRAVEL = 0.05
#: Prior width of the share of the column that is there; 1 is what the published links predict.
SHARE = 1.0
#: Names of the columns.
FROZEN, DROPPED = "frozen", "dropped"


class Body(Protocol):
    """An arm's rigid body with numbers in it."""

    @property
    def dof(self) -> int:
        """M."""

    def values(self, part: str, q: Array, qd: Array) -> Array:
        """Return momentum or beta (T, M) of q and qd (T, M), rad and rad/s."""


@dataclass(frozen=True)
class Links:
    """An arm of the full variant: its regressor, and base parameters (B,)."""

    regressor: Regressor
    base: Array

    @property
    def dof(self) -> int:
        """M."""
        return self.regressor.dof

    def values(self, part: str, q: Array, qd: Array) -> Array:
        """Return momentum or beta (T, M)."""
        return self.regressor.combined(part, self.base, q=q, qd=qd)


@dataclass(frozen=True)
class Generated:
    """An arm of any variant, as the text of its generated observer."""

    dof: int
    text: str

    def values(self, part: str, q: Array, qd: Array) -> Array:
        """Return momentum or beta (T, M)."""
        return np.asarray(getattr(_module(self.text), part)(q, qd), np.float64)


@lru_cache(maxsize=2)
def _module(text: str) -> ModuleType:
    return load_text(text)


@dataclass(frozen=True)
class Lacking:
    """A column that acts on all joints: the whole arm less the reduced one.

    nominal: its coefficient in the nominal model. joints: which of joints N + 1..M left the angles at which
    the model locks them.
    """

    name: str
    whole: Body
    reduced: Body
    nominal: float = 0.0
    joints: tuple[int, ...] = ()

    def column(self, q: Array, qd: Array) -> Array:
        """Return the momentum and beta that the reduced arm lacks, side by side (T, 2 N), in Nms and Nm.

        q, qd (T, M): rad, rad/s; zero where only the first joints are given.
        """
        n, m = self.reduced.dof, self.whole.dof
        if q.shape[1] < m:
            return np.zeros((len(q), 2 * n))
        both = [
            self.whole.values(part, q[:, :m], qd[:, :m])[:, :n]
            - self.reduced.values(part, q[:, :n], qd[:, :n])
            for part in ("momentum", "beta")
        ]
        return np.hstack(both)


def widths(names: Sequence[str], others: float) -> Array:
    """Return prior widths (S,) of common columns in a model of what needs no name.

    What the model lacks by its form may show on both sides: that is neither noise nor a change. others: of
    all other columns.
    """
    return np.array([SHARE if name in (FROZEN, DROPPED) else others for name in names])


def frozen_of(model: Model, robot: Robot, recordings: Sequence[Recording]) -> Lacking | None:
    """Return what moves beyond a model's joints; None when nothing does or not all recordings hold it."""
    n, m = model.dof, len(robot.joint)
    if n >= m or any(r.joints < m for r in recordings):
        return None
    locked = np.array(model.locked_angles)
    away = np.max([np.abs(r.q[:, n:m] - locked).max(axis=0, initial=0.0) for r in recordings], axis=0)
    joints = tuple(int(j) + n + 1 for j in np.flatnonzero(away > _TRAVEL))
    if not joints:
        return None
    whole, reduced = nominal_model(robot, "", m), nominal_model(robot, "", n, model.locked_angles)
    return Lacking(FROZEN, Links(*published(whole)), Links(*published(reduced)), joints=joints)


def dropped_of(simplified: Model, full: Model) -> Lacking:
    """Return what a simplified variant of a full model drops; all of it is missing from the nominal model."""
    reduced = Generated(simplified.dof, observer_text(simplified.model_copy(update={"term": ()})))
    return Lacking(DROPPED, Links(*published(full)), reduced, nominal=-1.0)


def full_of(model: Model, robot: Robot, robot_hash: str) -> Model:
    """Return the full Lagrangian of the links that a simplified model has, with its drives and terms."""
    links = nominal_model(robot, robot_hash, model.dof, model.locked_angles, wrist="absent")
    kept = ("joint", "observer_gain", "term", "inputs")
    return links.model_copy(update={name: getattr(model, name) for name in kept})
