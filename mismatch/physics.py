"""What the rigid body contributes to the columns: everything by differentiating the one Lagrangian.

A turned base, an offset encoder, a soft or slack gear, a force at the flange: each is a slope of the same
momentum and beta that generate the observer, so no formula stands here.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ..codegen.regressors import Regressor, regressor
from ..identify.physical import LinkMap, link_map
from ..robots import Robot
from ..robots.model import Model
from ..symbolic.nominal import nominal_model, robot_arm, with_wrist_locked

Array = NDArray[np.float64]

#: rad, rad/s; steps of central differences: round-off and curvature both stay below 1e-8 of the slope.
_STEP = 1e-4


@dataclass(frozen=True)
class Gravity:
    """The arm under gravity along one axis: its regressor and the published base parameters (B,) there.

    points (B, N, 4): base parameters of 1 kg at the origin of each frame 1..N, and of 1 kg m along its axes.
    """

    regressor: Regressor
    base: Array
    points: Array


@dataclass(frozen=True)
class Physics:
    """An arm's regressor, published base parameters (B,), the map from links, and gravity by axis.

    reflected (N,): the published rotors' inertias on the side of the joint, kg m^2; links (N, 10): the
    published links' own parameters, in the map's order.
    """

    regressor: Regressor
    published: Array
    map: LinkMap
    reflected: Array
    links: Array
    axes: tuple[Gravity, ...]
    strength: float  # m/s^2

    @property
    def dof(self) -> int:
        """N."""
        return self.regressor.dof

    @property
    def rotors(self) -> Array:
        """What the published rotors alone amount to, (B,)."""
        return np.asarray(self.map.rotors @ self.reflected, np.float64)


def physics_of(model: Model, robot: Robot) -> Physics:
    """Return what a model's arm contributes; robot: published links, for gravity in other directions.

    Kept between calls: deriving it takes seconds, and many recordings are of one robot.
    """
    lean = model.model_copy(
        update={"inputs": (), "term": (), "fit": None, "covariance": None, "thresholds": None}
    )
    return _physics(lean.model_dump_json(), robot.model_dump_json())


def published(model: Model) -> tuple[Regressor, Array]:
    """Return the regressor of a model's arm and its base parameters (B,)."""
    found = regressor(robot_arm(model))
    return found, np.array([model.base[n].value for n in found.base])


@lru_cache(maxsize=4)
def _physics(model_json: str, robot_json: str) -> Physics:
    model, robot = Model.model_validate_json(model_json), Robot.model_validate_json(robot_json)
    found, own = published(model)
    strength = float(np.linalg.norm(model.gravity))
    axes = []
    for axis in np.eye(3):
        turned = robot.model_copy(update={"gravity": tuple(strength * axis)})
        nominal = nominal_model(turned, "", model.dof, model.locked_angles)
        axes.append(Gravity(*published(nominal), _masses(nominal)))
    mapping = link_map(model)
    reflected = np.array([j.reflected_inertia for j in robot.joint[: model.dof]])
    bodies = with_wrist_locked(
        robot, model.dof, model.locked_angles or (0.0,) * (len(robot.joint) - model.dof)
    )
    links = np.array([b.parameters for b in bodies], np.float64)
    return Physics(found, own, mapping, reflected, links, tuple(axes), strength)


def _masses(model: Model) -> Array:
    """Return the base parameters (B, N, 4) of 1 kg at the origin of each frame, and of 1 kg m along its axes.

    Axes are those of the link's turned frame, in which its parameters stand.
    """
    links, found = link_map(model).links, []
    for k, joint in enumerate(model.joint):  # m, mx, my, mz of link k in its turned frame stand at 10 k
        m, mx, my, mz = links[:, 10 * k : 10 * k + 4].T
        found.append(np.stack([m + joint.a * mx + joint.d * mz, mx, my, mz], axis=1))
    return np.stack(found, axis=1)


def slopes(physics: Physics, base: Array, q: Array, qd: Array) -> Mapping[str, Array]:
    """Return d(momentum, beta)/d(q, qd) along a motion: each (T, N, N), [.., r, j] of row r by joint j.

    base (B,): parameters at which they are taken. Keys: "pq", "pv", "bq", "bv".
    """
    n = physics.dof
    found = {name: np.empty((len(q), n, n)) for name in ("pq", "pv", "bq", "bv")}
    for j in range(n):
        step = np.zeros(n)
        step[j] = _STEP
        for part, letter in (("momentum", "p"), ("beta", "b")):
            for moved, end in (((step, 0 * step), "q"), ((0 * step, step), "v")):
                up = physics.regressor.combined(part, base, q=q + moved[0], qd=qd + moved[1])
                down = physics.regressor.combined(part, base, q=q - moved[0], qd=qd - moved[1])
                found[letter + end][:, :, j] = (up - down) / (2 * _STEP)
    return found


def of_links(physics: Physics, base: Array, q: Array) -> Array:
    """Return the inertia (N,) about each joint without its rotor, kg m^2, the mean over poses q (T, N)."""
    columns, found = physics.regressor, np.empty(physics.dof)
    for j, unit in enumerate(np.eye(physics.dof)):
        turning = np.broadcast_to(unit, q.shape)
        found[j] = columns.combined("momentum", base - physics.rotors, q=q, qd=turning)[:, j].mean()
    return found


def tilts(physics: Physics, q: Array) -> Array:
    """Return the torque (T, N, 2), Nm/rad, of a base turned about its x and y axis.

    Gravity then gets a component along -y, +x of the base (small angles); published links.
    """
    still = np.zeros_like(q)
    along = [-g.regressor.combined("beta", g.base, q=q, qd=still) for g in physics.axes[:2]]
    return np.stack([-along[1], along[0]], axis=2)


def forces(physics: Physics, q: Array, frame: int) -> Array:
    """Return the torque (T, N, 3), Nm/N, that a unit force at a frame's origin (1..N) needs of the drives.

    A point mass there under gravity along an axis weighs just that; the drive holds against it.
    """
    return _weights(physics, q, frame, 0)


def levers(physics: Physics, q: Array, frame: int) -> Array:
    """Return by how much `forces` change, (T, N, 3, 3), Nm/N/m, further along the link's axes."""
    return np.stack([_weights(physics, q, frame, k) for k in (1, 2, 3)], axis=3)


def _weights(physics: Physics, q: Array, frame: int, moment: int) -> Array:
    still = np.zeros_like(q)
    along = [
        -g.regressor.combined("beta", g.points[:, frame - 1, moment] / physics.strength, q=q, qd=still)
        for g in physics.axes
    ]
    return np.stack(along, axis=2)


def fitted_force(columns: Array, target: Array) -> Array:
    """Return the force (T, 3), N, that fits torques (T, N) best, instant by instant; columns (T, N, 3).

    In units of the noise: a weak prior of 100 N keeps directions that no joint feels near zero.
    """
    gram = np.einsum("tji,tjk->tik", columns, columns) + 1e-4 * np.eye(3)
    right = np.einsum("tji,tj->ti", columns, target)
    return np.asarray(np.linalg.solve(gram, right[:, :, None])[:, :, 0], np.float64)
