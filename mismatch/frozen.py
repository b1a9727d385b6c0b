"""What joints that a reduced model holds still do to the others once they move.

The published arm with all its joints less the published one with fewer: both momentum and beta come from
the same Lagrangian, so no coupling is written here.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

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


@dataclass(frozen=True)
class Frozen:
    """The published arm of M joints and its first N with the rest rigid, each with its base parameters (B,).

    joints: which of joints N + 1..M left the angles at which the model locks them.
    """

    whole: tuple[Regressor, Array]
    reduced: tuple[Regressor, Array]
    joints: tuple[int, ...]

    def lacking(self, q: Array, qd: Array) -> Array:
        """Return the momentum and beta that the reduced arm lacks, side by side (T, 2 N), in Nms and Nm.

        q, qd (T, M): rad, rad/s; zero where only the first joints are given.
        """
        n = self.reduced[0].dof
        if q.shape[1] < self.whole[0].dof:
            return np.zeros((len(q), 2 * n))
        parts = [_both(*self.whole, q, qd), _both(*self.reduced, q[:, :n], qd[:, :n])]
        return np.hstack([whole[:, :n] - reduced for whole, reduced in zip(*parts, strict=True)])


def _both(arm: Regressor, base: Array, q: Array, qd: Array) -> list[Array]:
    return [arm.combined(part, base, q=q, qd=qd) for part in ("momentum", "beta")]


def widths(names: Sequence[str], others: float) -> Array:
    """Return prior widths (S,) of common columns in a model of what needs no name.

    Joints beyond may move on both sides: that is neither noise nor a change. others: of all other columns.
    """
    return np.array([SHARE if name == "frozen" else others for name in names])


def frozen_of(model: Model, robot: Robot, recordings: Sequence[Recording]) -> Frozen | None:
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
    return Frozen(published(whole), published(reduced), joints)
