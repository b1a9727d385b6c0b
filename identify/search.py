"""Nonlinear parameters of terms by variable projection: a small bounded search over Gram matrices.

For every candidate value the linear parameters have a closed-form best (Golub and Pereyra 1973), so only
the nonlinear one is searched. All candidates stand in one set of rows; picking one is picking columns.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .estimate import Fitted, sums_at
from .moments import JointMoments
from .requests import TermRequest
from .rows import Recipe
from .schedule import Scheduler
from .solve import Noise, Prior, Problem, solve

Array = NDArray[np.float64]

_CANDIDATES = 7
#: Each round searches between the neighbours of the best of the round before.
_ROUNDS = 3


@dataclass(frozen=True)
class Candidates:
    """Candidate values of the searched parameter of a request on its joint, and their columns' numbers."""

    request: TermRequest
    values: Array
    columns: tuple[tuple[int, ...], ...]


@dataclass(frozen=True)
class Searched:
    """The request with its best value, that value's standard deviation, and whether it is at a bound."""

    request: TermRequest
    std: float
    at_bound: bool


def search(
    requests: Sequence[TermRequest],
    fitted: Fitted,
    make: Callable[[Sequence[TermRequest]], tuple[Recipe, Prior]],
    place: Callable[[Recipe], Sequence[Any]],
    scheduler: Scheduler,
) -> list[Searched]:
    """Return the requests with searched parameters, each on one joint, set to their best values.

    requests: all of the fit's, each on one joint. fitted: a fit without the searched ones, whose noise and
    weights are used. make: recipe and prior of some requests; place: rows of a recipe.
    """
    known = [r for r in requests if r.searched is None]
    open_ones = [r for r in requests if r.searched is not None]
    bounds = [r.searched[1] for r in open_ones if r.searched is not None]
    found: list[Searched] = []
    for _ in range(_ROUNDS):
        grids = [np.geomspace(*b, _CANDIDATES) for b in bounds]
        many = [_set(r, float(v)) for r, grid in zip(open_ones, grids, strict=True) for v in grid]
        recipe, prior = make([*known, *many])
        theta = np.zeros(len(prior.mean))
        settled = fitted.estimate.theta
        theta[: len(settled)] = settled  # the known ones come first, in the same order
        indices = tuple(recipe.indices(i) for i in range(recipe.regressor.dof))
        sums = sums_at(place(recipe), Problem(indices, prior), theta, fitted.noise.sigma, scheduler)
        found = _choose(open_ones, grids, sums, recipe, prior, fitted.noise)
        bounds = [_narrower(grid, _value(s.request)) for grid, s in zip(grids, found, strict=True)]
    return [replace(s, at_bound=_at_bound(s.request, r)) for s, r in zip(found, open_ones, strict=True)]


def _choose(
    requests: Sequence[TermRequest], grids: Sequence[Array], sums: Sequence[JointMoments],
    recipe: Recipe, prior: Prior, noise: Noise,
) -> list[Searched]:  # fmt: skip
    """Go through the terms twice, each at its best value while the others stay."""
    width = len(recipe.regressor.base)
    columns = list(recipe.regressor.terms)
    first = len(columns) - sum(
        len(g) * len(r.columns(r.joints[0])) for r, g in zip(requests, grids, strict=True)
    )
    common = list(range(width + first))
    offsets, at = [], width + first
    for request, grid in zip(requests, grids, strict=True):
        each = len(request.columns(request.joints[0]))
        offsets.append([list(range(at + k * each, at + (k + 1) * each)) for k in range(len(grid))])
        at += each * len(grid)
    best = [len(grid) // 2 for grid in grids]
    costs = [np.zeros(len(grid)) for grid in grids]
    for _ in range(2):
        for j, grid in enumerate(grids):
            for k in range(len(grid)):
                pick = [k if i == j else best[i] for i in range(len(grids))]
                keep = common + [c for i, p in enumerate(pick) for c in offsets[i][p]]
                costs[j][k] = _cost(keep, sums, recipe, prior, noise)
            best[j] = int(np.argmin(costs[j]))
    return [
        Searched(_set(r, float(grid[b])), _deviation(grid, cost, b), False)
        for r, grid, cost, b in zip(requests, grids, costs, best, strict=True)
    ]


def _cost(keep: list[int], sums: Sequence[JointMoments], recipe: Recipe, prior: Prior, noise: Noise) -> float:
    """Weighted squares at the best linear parameters, in units of independent samples' variance."""
    position = {p: k for k, p in enumerate(keep)}
    indices, cut = [], []
    for i, joint in enumerate(sums):
        own = recipe.indices(i)
        stay = [k for k, p in enumerate(own) if int(p) in position]
        indices.append(np.array([position[int(own[k])] for k in stay], dtype=np.int64))
        both = [*stay, len(own)]
        cut.append(replace(joint, fitted=joint.fitted[np.ix_(both, both)]))
    problem = Problem(tuple(indices), Prior(prior.mean[keep], prior.std[keep]))
    theta = solve(cut, noise, problem, constrained=False).theta
    cost = float(np.sum(((theta - problem.prior.mean) / problem.prior.std) ** 2))
    for i, joint in enumerate(cut):
        v = np.append(-theta[indices[i]], 1.0)
        cost += float(v @ joint.fitted @ v) / (noise.sigma[i] ** 2 * noise.inflation[i])
    return cost


def _deviation(grid: Array, cost: Array, best: int) -> float:
    """Return the standard deviation from the curvature of the cost over the logarithm of the value."""
    if best in (0, len(grid) - 1):
        return float("inf")
    h = float(np.log(grid[1] / grid[0]))
    bend = (cost[best - 1] - 2 * cost[best] + cost[best + 1]) / h**2
    return float(grid[best] * np.sqrt(2 / bend)) if bend > 0 else float("inf")


def _set(request: TermRequest, value: float) -> TermRequest:
    assert request.searched is not None
    name = request.searched[0]
    return TermRequest(request.name, request.joints, (*request.values, (name, value)))


def _value(request: TermRequest) -> float:
    return request.values[-1][1]


def _narrower(grid: Array, best: float) -> tuple[float, float]:
    k = int(np.argmin(np.abs(grid - best)))
    return float(grid[max(k - 1, 0)]), float(grid[min(k + 1, len(grid) - 1)])


def _at_bound(found: TermRequest, asked: TermRequest) -> bool:
    assert asked.searched is not None
    low, high = asked.searched[1]
    return not low * 1.02 < _value(found) < high / 1.02
