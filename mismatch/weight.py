"""A load that is held for a moment: too short to be told by its times, it comes and goes as a push does.

A push has a force of its own at every instant, a load one mass and one centre for all of them. Where these
explain as much it is a load, or someone who pushes just as one.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .held import WIDTHS
from .load_checks import FORCE, SECOND, by_free_force, unlike_a_load
from .physics import Physics, forces

Array = NDArray[np.float64]

#: s in all; over less than this an arm hardly turns what it holds.
_HELD = 1.0
#: Of the squared residuals while it is held.
_WHOLE = 0.95


@dataclass(frozen=True)
class Weight:
    """A load's parameters (10,) and covariance (10, 10), as of `quantities.payload_numbers`."""

    value: Array
    covariance: Array


@dataclass(frozen=True)
class Touch:
    """n rows in which something is there, step s apart: angles q (n, N), rad; left (n, N): residuals, Nm.

    sigma (n, N): Nm that these are known to; columns (n, N, 10): of a load's parameters; moving (n, N).
    """

    q: Array
    left: Array
    sigma: Array
    columns: Array
    moving: NDArray[np.bool_]
    step: float


def weight_of(physics: Physics, touches: Sequence[Touch]) -> Weight | None:
    """Return the load that explains some stretches, as well as free forces at the flange do, or None."""
    if sum(len(t.q) * t.step for t in touches) < _HELD:
        return None
    target = np.concatenate([t.left / t.sigma for t in touches])
    columns = np.concatenate([t.columns / t.sigma[:, :, None] for t in touches])
    moving = np.concatenate([t.moving for t in touches])
    matrix = np.einsum("tjk,tjl->kl", columns, columns) + np.diag(1 / WIDTHS**2)
    covariance = np.linalg.inv(matrix)
    value = covariance @ np.einsum("tjk,tj->k", columns, target)
    load = columns @ value
    nats = 0.5 * np.sum(load**2 * moving, axis=0)
    if unlike_a_load(value, covariance) or nats.sum() - nats.max() < SECOND:
        return None
    explained = float(np.sum(target**2 - (target - load) ** 2))
    free = np.concatenate([forces(physics, t.q, physics.dof) / t.sigma[:, :, None] for t in touches])
    enough = explained > max(_WHOLE * np.sum(target**2), FORCE * by_free_force(free, target).sum())
    return Weight(value, covariance) if enough else None
