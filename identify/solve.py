"""Weighted least squares from summed moments, with the published values as a prior of stated width."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..robots.model import Model
from .moments import HUBER_CONSISTENCY, JointMoments
from .physical import LinkMap, project
from .rows import Recipe

Array = NDArray[np.float64]

#: Standard deviation of a published value, as a share of itself: sources differ by 13-49 % in gains alone.
PRIOR_SHARE = 0.5
#: And at least this share of the largest value of its kind further out on the arm: zeros are not exact.
PRIOR_FLOOR = 0.1
#: Standard deviation of a friction parameter before the recordings: share of the rated torque at 1 rad/s.
PRIOR_FRICTION = 0.2


@dataclass(frozen=True)
class Prior:
    """Independent normal prior of P parameters: mean and standard deviation."""

    mean: Array
    std: Array


@dataclass(frozen=True)
class Noise:
    """What is left unexplained, a value a joint: sigma (N,) Nm; inflation (N,): samples per independent one.

    inflation is 1 + 2 sum of autocorrelations (in rows); memory: each joint's tapered autocovariance, Nm^2.
    """

    sigma: Array
    inflation: Array
    memory: tuple[Array, ...] = ()


@dataclass(frozen=True)
class Problem:
    """What does not change while a fit iterates.

    indices: each joint's parameters. positive: parameters that must not be negative. mapping: for physical
    links (None: not asked for).
    """

    indices: tuple[NDArray[np.int64], ...]
    prior: Prior
    positive: tuple[int, ...] = ()
    mapping: LinkMap | None = None

    def parameters_of(self, theta: Array) -> list[Array]:
        """Cut (P,) into each joint's own parameters."""
        return [theta[ix] for ix in self.indices]


@dataclass(frozen=True)
class Estimate:
    """theta (P,); information (P, P): inverse covariance if the errors were as `Noise` says, prior included.

    moved: how far physical consistency moved it, in standard deviations.
    """

    theta: Array
    information: Array
    moved: float = 0.0
    data_information: Array = field(default_factory=lambda: np.empty(0))


def prior(model: Model, recipe: Recipe, loose: Mapping[str, float] | None = None) -> Prior:
    """Return published base parameters and no friction, with the widths stated in this file.

    loose: standard deviations by base parameter that replace them.
    """
    names = recipe.regressor.base
    values = np.array([model.base[n].value for n in names])
    std = base_widths(model, names)
    for name, width in (loose or {}).items():
        std[names.index(name)] = width
    friction = [PRIOR_FRICTION * model.joint[c.joint - 1].max_torque for c in recipe.regressor.terms]
    return Prior(np.concatenate([values, np.zeros(len(friction))]), np.concatenate([std, friction]))


def base_widths(model: Model, names: Sequence[str]) -> Array:
    """Return standard deviations (B,) of published base parameters, as stated in this file."""
    values = np.array([model.base[n].value for n in names])
    kinds = ["moment" if model.base[n].unit == "kg m" else "inertia" for n in names]
    links = [int(n.lstrip("ABCDEFGHIJKLMNOPQRSTUVWXYZ")) for n in names]
    std = np.empty(len(names))
    for k in range(len(names)):
        alike = [abs(values[j]) for j in range(len(names)) if kinds[j] == kinds[k] and links[j] >= links[k]]
        std[k] = max(PRIOR_SHARE * abs(values[k]), PRIOR_FLOOR * max(alike), 1e-3)
    return std


def solve(sums: Sequence[JointMoments], noise: Noise, problem: Problem, constrained: bool = True) -> Estimate:
    """Minimise the weighted squares plus the prior's, subject to the problem's constraints."""
    size = len(problem.prior.mean)
    data, right = np.zeros((size, size)), np.zeros(size)
    for i, ix in enumerate(problem.indices):
        weight = 1 / (noise.sigma[i] ** 2 * noise.inflation[i])
        gram = sums[i].fitted
        data[np.ix_(ix, ix)] += weight * gram[:-1, :-1]
        right[ix] += weight * gram[:-1, -1]
    precision = 1 / problem.prior.std**2
    information = data + np.diag(precision)
    scale = problem.prior.std
    theta = scale * np.linalg.solve(
        information * np.outer(scale, scale), scale * (right + precision * problem.prior.mean)
    )
    moved = 0.0
    if constrained and (problem.mapping is not None or np.any(theta[list(problem.positive)] < 0)):
        theta, moved = project(theta, information, problem.mapping, problem.positive)
    return Estimate(theta, information, moved, data)


def noise_of(sums: Sequence[JointMoments], parameters: Sequence[float] | Array) -> Noise:
    """Estimate scale and memory of each joint's errors.

    parameters: how many parameters each joint's rows have determined (degrees of freedom, (N,)). They are
    taken off the effective number of samples, not off the number of rows. A joint that never moved keeps
    a scale of 1 Nm and says nothing.
    """
    sigma, inflation, memory = [], [], []
    for joint, used in zip(sums, parameters, strict=True):
        if joint.count < 2 or joint.squares == 0:
            sigma.append(1.0)
            inflation.append(1.0)
            memory.append(np.array([1.0]))
            continue
        variance = joint.squares / joint.count / HUBER_CONSISTENCY
        correlation = _correlation(joint)
        factor, last = _inflation(correlation)
        effective = joint.count / factor
        lost = 1 / (1 - min(used / effective, 0.5))
        sigma.append(float(np.sqrt(variance * lost)))
        inflation.append(factor)
        taper = np.clip(1 - np.arange(len(correlation)) / (last + 1), 0, None)
        memory.append((variance * lost * correlation * taper)[: last + 1])
    return Noise(np.array(sigma), np.array(inflation), tuple(memory))


def _correlation(joint: JointMoments) -> Array:
    """Autocorrelation by lag, up to the lag at which half of the pairs are left."""
    enough = joint.pairs > 0.5 * joint.pairs[0]
    last = len(enough) if enough.all() else int(np.argmin(enough))
    products: Array = joint.products[:last] / joint.pairs[:last]
    return np.asarray(products / products[0], np.float64)


def _inflation(correlation: Array) -> tuple[float, int]:
    """1 + 2 sum of correlations up to a self-consistent window (Sokal 1989), and eight times that window.

    The window is the first lag that is five times the sum so far: long enough for the memory, short enough
    for its noise.
    """
    sums = 1 + 2 * np.cumsum(correlation[1:])
    if not len(sums):
        return 1.0, 0
    inside = np.arange(1, len(sums) + 1) >= 2.5 * sums
    window = int(np.argmax(inside)) if inside.any() else len(sums) - 1
    factor = max(1.0, float(sums[window]))
    return factor, min(len(correlation) - 1, max(1, int(4 * factor)))


def covariance(estimate: Estimate, scatter: Sequence[Array], noise: Noise, problem: Problem) -> Array:
    """Return the covariance (P, P) of the parameters with the errors' memory (a sandwich).

    scatter: sums over rows of moments.score_scatter. The prior's own part is its information.
    """
    middle = np.diag(1 / problem.prior.std**2)
    for i, ix in enumerate(problem.indices):
        weight = 1 / (noise.sigma[i] ** 2 * noise.inflation[i])
        middle[np.ix_(ix, ix)] += weight**2 * scatter[i]
    scale = problem.prior.std
    inverse = np.linalg.inv(estimate.information * np.outer(scale, scale)) * np.outer(scale, scale)
    found: Array = inverse @ middle @ inverse
    return (found + found.T) / 2


def determined(estimate: Estimate, problem: Problem) -> tuple[Array, int]:
    """Say what the motion has shown: (each parameter's share of information from data (P,), directions).

    The share is 1 - posterior variance / prior variance. directions: eigenvalues above one of the data's
    information in units of the prior: combinations on which the recordings say more than the prior.
    """
    scale = problem.prior.std
    inverse = np.linalg.inv(estimate.information * np.outer(scale, scale))
    eigenvalues = np.linalg.eigvalsh(estimate.data_information * np.outer(scale, scale))
    return 1 - np.diag(inverse), int((eigenvalues > 1).sum())
