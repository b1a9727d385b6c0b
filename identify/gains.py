"""Drive gains (Nm/A): a scale that free motion does not show, and what does.

Twice the masses and twice the gains give the same currents. A known load breaks the tie (Gautier and
Briot 2014), and so do masses that are trusted. Currents are then fitted, not torques: measured torque at
the assumed gain is s_i columns @ (parameters + load), s = assumed over true gain, so that noise stays on
the left-hand side and does not pull the gains down.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from ..errors import InputError
from ..robots.model import Model
from ..symbolic.nominal import robot_arm
from .baseline import Baseline
from .estimate import fold_rows, sums_at
from .model_file import GainFit
from .moments import JointMoments
from .physical import link_map
from .pieces import Placed
from .schedule import Scheduler

Array = NDArray[np.float64]

#: Prior of a gain: as assumed, give or take this share (sources differ by 13-49 %).
_GAIN_PRIOR = 0.5
#: m; where the load's centre of mass is, from the flange: this far out, give or take the same.
_REACH = 0.1
#: Mass of a rotor and friction are not what "trusted masses" means; they keep their prior.
_ROTOR = "IA"


def unseen_gains(model: Model) -> GainFit:
    """Return the robot file's gains: nothing has shown them."""
    return GainFit(
        tuple(j.drive_gain for j in model.joint),
        (None,) * model.dof,
        "drive gains are the robot file's, not fitted: without a known load only torque over gain is seen",
    )


@dataclass(frozen=True)
class _Case:
    """Sums compressed to triangles: R'R = gram / (sigma^2 inflation). loaded: whether the load is on."""

    triangles: tuple[Array, ...]
    loaded: bool


def fit_gains(
    found: Baseline, loaded: Sequence[Placed], mass: float | None, trusted: float | None, at: Scheduler
) -> GainFit:
    """Estimate all gains with base parameters, friction and the load's other nine parameters at once.

    found: a fit of the unloaded recordings. loaded: recordings with a load of `mass` kg at the flange.
    trusted: percent by which the published rigid-body values may be wrong (None: as the prior has it).
    Raises InputError when the loaded recordings do not move.
    """
    cases = [_Case(_triangles(found.fitted.sums, found), False)]
    if loaded:
        handles = [h for p in loaded for h in p.handles]
        rows: list[Any] = at.transform(fold_rows, handles, found.recipe, ())
        still = np.full(found.nominal.dof, np.inf)
        sums = sums_at(rows, found.problem, found.fitted.estimate.theta, still, at)
        if all(joint.count == 0 for joint in sums):
            raise InputError("--loaded: no joint moves for long enough in these recordings")
        cases.append(_Case(_triangles(sums, found), True))
    mean, std = _prior(found, mass if loaded else None, trusted)
    body = link_map(found.nominal).links[:, -10:]

    def errors(z: Array) -> Array:
        return _errors(mean + std * z, cases, found, body, z)

    solved = least_squares(errors, np.zeros(len(mean)))
    slope = np.asarray(solved.jac, dtype=np.float64)
    n = found.nominal.dof
    scale = (mean + std * solved.x)[-n:]
    spread = std[-n:] * np.sqrt(np.diag(np.linalg.inv(slope.T @ slope)))[-n:]
    old = np.array([j.drive_gain for j in found.nominal.joint])
    source = _source(loaded, mass, trusted)
    return GainFit(tuple((old / scale).tolist()), tuple((old / scale**2 * spread).tolist()), source)


def _source(loaded: Sequence[Placed], mass: float | None, trusted: float | None) -> str:
    parts = []
    if loaded:
        parts.append(f"a known load of {mass:g} kg ({', '.join(p.source.name for p in loaded)})")
    if trusted:
        parts.append(f"published masses trusted to {trusted:g} %")
    shown = " and ".join(parts)
    return (
        f"drive gains fitted: shown by {shown}; standard deviations of other parameters are for these gains"
    )


def _prior(found: Baseline, mass: float | None, trusted: float | None) -> tuple[Array, Array]:
    """Mean and width of [theta (P), load (10), s (N)]."""
    mean, std = found.problem.prior.mean.copy(), found.problem.prior.std.copy()
    if trusted is not None:
        for k, name in enumerate(found.recipe.regressor.base):
            if not name.startswith(_ROTOR):
                std[k] = max(trusted / 100 * abs(mean[k]), trusted / 100 * std[k])
    load_mean, load_std = _load_prior(found.nominal, mass)
    n = found.nominal.dof
    return np.concatenate([mean, load_mean, np.ones(n)]), np.concatenate(
        [std, load_std, np.full(n, _GAIN_PRIOR)]
    )


def _load_prior(model: Model, mass: float | None) -> tuple[Array, Array]:
    """Ten parameters of a body of known mass somewhere near the flange, in the last turned frame."""
    if mass is None:
        return np.zeros(10), np.full(10, 1e-9)
    link = robot_arm(model).links[-1]
    flange = np.array(link.translation.xreplace(dict(robot_arm(model).values)), dtype=float).ravel()
    twist = np.array(link.twist.xreplace(dict(robot_arm(model).values)), dtype=float)
    centre = flange + twist @ np.array([0.0, 0.0, _REACH])
    inertia = mass * (centre @ centre * np.eye(3) - np.outer(centre, centre)) + mass * _REACH**2 / 4 * np.eye(
        3
    )
    J = inertia
    mean = np.array([mass, *(mass * centre), J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2]])
    width = mass * _REACH * (np.linalg.norm(centre) + _REACH)
    return mean, np.array([1e-6 * mass, *[mass * _REACH] * 3, *[width] * 6])


def _triangles(sums: Sequence[JointMoments], found: Baseline) -> tuple[Array, ...]:
    noise, triangles = found.fitted.noise, []
    for i, joint in enumerate(sums):
        values, vectors = np.linalg.eigh(joint.fitted / (noise.sigma[i] ** 2 * noise.inflation[i]))
        triangles.append(np.sqrt(np.clip(values, 0, None))[:, None] * vectors.T)
    return tuple(triangles)


def _errors(x: Array, cases: Sequence[_Case], found: Baseline, body: Array, from_prior: Array) -> Array:
    """Errors of all rows and of the prior, each in standard deviations."""
    n, p = found.nominal.dof, len(found.names)
    theta, load, scale = x[:p], x[p : p + 10], x[-n:]
    with_load = theta.copy()
    width = len(found.recipe.regressor.base)
    with_load[:width] += body @ load
    errors = [from_prior]
    for case in cases:
        used = with_load if case.loaded else theta
        for i, triangle in enumerate(case.triangles):
            own = found.problem.indices[i]
            errors.append(triangle @ np.append(-scale[i] * used[own], 1.0))
    return np.concatenate(errors)
