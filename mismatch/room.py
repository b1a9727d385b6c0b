"""Where a new motion may go: what the recordings covered, poses that they held, and how low the arm came."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .evidence import Evidence
from .physics import Physics

Array = NDArray[np.float64]

#: rad/s; 60 % of the slowest joint of UR's e-series (UR10e data sheet, joints 1 and 2: 120 deg/s).
TOP_SPEED = 0.6 * 2.0944
#: rad that the exercised joint may leave home by, whatever was recorded, and where it ends in any case.
_REACH, _END = 1.0, 3.0
#: m below the lowest recorded place of a frame that a path may bring it.
_MARGIN = 0.01
#: Recorded poses that are looked at, and that are kept as far apart as can be.
_LOOKED_AT, _KEPT = 1000, 4
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(24)


@dataclass(frozen=True)
class Room:
    """What the recordings say about the cell, N joints.

    home (N,): the recorded pose nearest to their median, rad; poses (K, N): recorded ones far apart;
    stretched (N,): that with most gravity on joint 2; low, high (N,): rad that a joint alone may reach from
    home; top (N,): rad/s; floor (F,): lowest height of each frame's origin from the elbow to the flange above
    its height at home, m; temperature (N,): mean, deg C.
    """

    physics: Physics
    home: Array
    poses: Array
    stretched: Array
    low: Array
    high: Array
    top: Array
    floor: Array
    temperature: Array

    @property
    def dof(self) -> int:
        """N."""
        return len(self.home)

    def clear(self, path: Array) -> bool:
        """Say whether elbow, wrist and flange stay as high on a path (T, N), rad, as in the recordings."""
        return bool(np.all(heights(self.physics, self.home, path) >= self.floor - _MARGIN))


def room_of(evidence: Evidence, max_speed: Array | None = None) -> Room:
    """Return the room of the observed recordings; max_speed (N,): rad/s of the joints (None: TOP_SPEED)."""
    physics = evidence.setup.physics
    runs = [r for r, seen in zip(evidence.runs, evidence.observed, strict=True) if seen and len(r)]
    q, load, hot = (np.concatenate([getattr(r, k) for r in runs]) for k in ("q", "load", "temperature"))
    some = np.unique(np.linspace(0, len(q) - 1, min(len(q), _LOOKED_AT)).astype(int))
    spread = np.maximum(np.std(q[some], axis=0), 0.01)
    home = q[some][np.argmin(np.sum(((q[some] - np.median(q, axis=0)) / spread) ** 2, axis=1))]
    end = np.maximum(_END, np.abs(q).max(axis=0))
    top = np.full(physics.dof, TOP_SPEED) if max_speed is None else 0.6 * np.asarray(max_speed, np.float64)
    return Room(
        physics,
        home,
        _far_apart(q[some], home),
        q[some][np.argmax(np.abs(load[some, min(1, physics.dof - 1)]))],
        np.maximum(np.minimum(q.min(axis=0), home - _REACH), -end),
        np.minimum(np.maximum(q.max(axis=0), home + _REACH), end),
        top,
        heights(physics, home, q[some]).min(axis=0),
        hot.mean(axis=0),
    )


def heights(physics: Physics, home: Array, q: Array) -> Array:
    """Return how much higher (T, F), m, along the base's z, frames are at poses (T, N) than at home (N,).

    Frames 2..N: elbow to flange. Under gravity along z a point mass's beta is the slope of its height, which
    is integrated on the straight line from home (Gauss and Legendre), so that no kinematics is written anew.
    """
    upward = physics.axes[2]
    points = upward.points[:, min(1, physics.dof - 1) :, 0] / physics.strength  # (B, F)
    way = q - home
    share = 0.5 * (_NODES + 1)
    line = (home + share[:, None, None] * way).reshape(-1, len(home))  # (24 T, N)
    beta = upward.regressor.matrix("beta", q=line, qd=np.zeros_like(line)) @ points
    slope = beta.reshape(len(share), *q.shape, -1)  # (24, T, N, F)
    return np.asarray(0.5 * np.einsum("s,stjf,tj->tf", _WEIGHTS, slope, way), np.float64)


def _far_apart(q: Array, home: Array) -> Array:
    """Choose poses one after the other, each as far as can be from those before; home is the first."""
    chosen: Sequence[Array] = [home]
    for _ in range(_KEPT - 1):
        nearest = np.min([np.max(np.abs(q - c), axis=1) for c in chosen], axis=0)
        chosen = [*chosen, q[int(np.argmax(nearest))]]
    return np.stack(chosen)
