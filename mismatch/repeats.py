"""Where a recording does what the reference did, what the reference's model left there is known as well.

A model of a real arm leaves much that comes back whenever the motion does. On the same path that is no
change, and no noise: it stands in a column of its own, whose coefficient says how much of it came back.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from .columns import REPEAT, Space
from .rows import Rows

Array = NDArray[np.float64]

#: What counts as near: rad, rad/s, and of a joint's Coulomb level, Nm; over all joints so many of these.
ANGLE, SPEED, LOAD = 0.02, 0.05, 0.5
FAR = 1.5
#: Rows of the reference that are looked at, and how fast they count less (in the same units).
_NEAREST, _SOFT = 8, 0.5


def repeated(runs: Sequence[Rows], left: Sequence[Array], friction: Array, rows: Rows) -> Array:
    """Return what a model left of the reference where it did what these rows do (n, N), Nm.

    runs, left: the reference and its residuals (n, N). friction (N,): Coulomb level, Nm. Zero where the
    reference did nothing alike.
    """
    states, errors = np.concatenate([_state(r, friction) for r in runs]), np.concatenate(left)
    if not len(states) or not len(rows):
        return np.zeros(rows.torque.shape)
    count = min(_NEAREST, len(states))
    found = cKDTree(states).query(_state(rows, friction), k=[*range(1, count + 1)])
    far, which = np.asarray(found[0]), np.asarray(found[1])
    near = np.exp(-0.5 * (far**2 - far[:, :1] ** 2) / _SOFT**2) * (far < FAR)
    whole = np.maximum(near.sum(axis=1), 1e-12)
    return np.asarray(np.einsum("nk,nkj->nj", near, errors[which]) / whole[:, None], np.float64)


def coefficients(space: Space) -> list[int]:
    """Return where the parameters stand that say how much came back, one a joint."""
    some = [k for k, c in enumerate(space.own) if c.term == REPEAT]
    return [space.own_index(j, k) for j in range(space.dof) for k in some]


def views(columns: Sequence[Array], space: Space) -> list[Array]:
    """Return each joint's column of what came back (n,), a view into its columns (n, P_j)."""
    at = zip(columns, space.indices, coefficients(space), strict=True)
    return [x[:, np.searchsorted(places, place)] for x, places, place in at]


def share(runs: Sequence[Rows], space: Space) -> float:
    """Return the share of the rows with motion for which the reference did the same."""
    known = [np.any(views(r.columns, space), axis=0)[r.arm_moves] for r in runs]
    return float(np.mean(np.concatenate(known)))


def _state(rows: Rows, friction: Array) -> Array:
    return np.hstack([rows.q / ANGLE, rows.qd / SPEED, rows.load / (LOAD * np.maximum(friction, 1e-3))])
