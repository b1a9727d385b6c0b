"""Which base parameters a physical arm can have: a convex set, and the projection onto it.

Base parameters are linear in the links' masses, first moments and inertias and in the rotors' inertias. A
link is physical exactly when its pseudo-inertia matrix is positive semidefinite (Wensing, Kim, Slotine
2018): positive mass and principal moments that obey the triangle inequality. Base parameters are physical
when some full set of such links gives them (Sousa and Cortesao 2014): that set, not a single link's
numbers, is what motion can contradict.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from ..robots.model import Model
from ..symbolic.base_parameters import base_parameters, link_symbols, rotor_symbols
from ..symbolic.nominal import robot_arm

Array = NDArray[np.float64]

#: The projection is left out when it would move the parameters by less than this many standard deviations.
_NEGLIGIBLE = 1e-2
#: Exact by interior points; where these fail on an ill-conditioned program, slower and coarser by splitting.
#: Never warm: a warm one keeps the scaling of the program before, and fails on one that is scaled otherwise.
_SOLVERS = ("CLARABEL", "SCS")
#: Weight of the full set's own size: what no motion shows would else be free, and the program ill-posed.
_SMALL = 1e-6


@dataclass(frozen=True, eq=False)
class LinkMap:
    """base = links @ full + rotors @ inertias: links (B, 10 N) in turned frames, rotors (B, N)."""

    links: Array
    rotors: Array

    @property
    def dof(self) -> int:
        """N."""
        return int(self.rotors.shape[1])


def link_map(model: Model) -> LinkMap:
    """Return the linear map from the links' own parameters to the model's base parameters."""
    arm = robot_arm(model)
    meaning = sp.Matrix(list(base_parameters(arm).values()))
    links = [x for body in link_symbols(arm) for x in body.parameters]

    def slopes(symbols: Sequence[sp.Symbol]) -> Array:
        return np.array(meaning.jacobian(symbols).xreplace(dict(arm.values)), dtype=float)

    return LinkMap(slopes(links), slopes(rotor_symbols(arm)))


def project(
    estimate: Array, information: Array, mapping: LinkMap | None, positive: Sequence[int]
) -> tuple[Array, float]:
    """Return the nearest parameters (P,) that are physical, and how far they are, in standard deviations.

    Nearest in the metric of `information` (P, P), so it is the constrained least-squares solution. mapping:
    of the first B parameters (None: no claim about them). positive: indices that must not be negative:
    friction dissipates.
    """
    scale = 1 / np.sqrt(np.diag(information))
    program = _program(len(estimate), mapping, tuple(positive))
    root = np.linalg.cholesky(information * np.outer(scale, scale)).T
    program.root.value, program.start.value, program.scale.value = root, estimate, scale
    for solver in _SOLVERS:
        program.problem.solve(solver=solver, warm_start=False)
        if program.step.value is not None:
            break
    else:
        raise RuntimeError("the projection onto physical parameters found no solution")
    distance = float(np.linalg.norm(root @ program.step.value))
    if distance < _NEGLIGIBLE:
        return estimate, 0.0
    projected = estimate + scale * program.step.value
    projected[list(positive)] = np.maximum(projected[list(positive)], 0.0)
    return projected, distance


def unlike_a_body(
    estimate: Array, information: Array, mapping: Array, before: Array, heaviest: float
) -> float:
    """Return by how many nats a change (k,) is likelier than the nearest that a body can have.

    information (k, k): of the estimate; mapping (k, 10): change by a body's parameters; before (10,): the
    body before the change (zeros: there was none), which has to be one after it, too. heaviest: its mass
    then, kg, at most: of a mass without bounds any first moment is possible.
    """
    k = len(estimate)
    root = np.linalg.cholesky(information).T
    scale = max(float(np.linalg.norm(root @ estimate)), 1e-12)
    program = _one_body()
    program.root.value, program.start.value = np.zeros((10, 10)), np.zeros(10)
    program.root.value[:k], program.start.value[:k] = root @ mapping / scale, root @ estimate / scale
    program.before.value, program.heaviest.value = before, heaviest
    program.problem.solve(solver="CLARABEL", warm_start=False)
    if program.change.value is None:
        raise RuntimeError("no body near the change was found")
    missed = program.root.value @ program.change.value - program.start.value
    return float(0.5 * scale**2 * missed @ missed)


@dataclass(frozen=True)
class _OneBody:
    """A cone program: minimise |root @ change - start| where before + change is a body."""

    problem: Any
    change: Any
    root: Any
    start: Any
    before: Any
    heaviest: Any


@lru_cache(maxsize=1)
def _one_body() -> _OneBody:
    import cvxpy

    cp: Any = cvxpy
    change = cp.Variable(10)
    root, start, before = cp.Parameter((10, 10)), cp.Parameter(10), cp.Parameter(10)
    heaviest = cp.Parameter()
    cost = cp.sum_squares(root @ change - start) + _SMALL * cp.sum_squares(change)
    after = before + change
    problem = cp.Problem(cp.Minimize(cost), [_pseudo_inertia(after, cp) >> 0, after[0] <= heaviest])
    return _OneBody(problem, change, root, start, before, heaviest)


@dataclass(frozen=True)
class _Program:
    """A cone program: minimise |root @ step| where start + scale * step is physical."""

    problem: Any
    step: Any
    root: Any
    start: Any
    scale: Any


@lru_cache(maxsize=4)
def _program(size: int, mapping: LinkMap | None, positive: tuple[int, ...]) -> _Program:
    """Write the program with open numbers: compiling it takes far longer than solving it again."""
    import cvxpy

    cp: Any = cvxpy  # its names are made at run time

    step = cp.Variable(size)
    root, start, scale = cp.Parameter((size, size)), cp.Parameter(size), cp.Parameter(size, pos=True)
    found = start + cp.multiply(scale, step)
    limits = [found[list(positive)] >= 0] if positive else []
    cost = cp.sum_squares(root @ step)
    if mapping is not None:
        links, physical = _physical(found[: len(mapping.links)], mapping, cp)
        limits += physical
        cost += _SMALL * cp.sum_squares(links)
    problem = cp.Problem(cp.Minimize(cost), limits)
    return _Program(problem, step, root, start, scale)


def _physical(base: Any, mapping: LinkMap, cp: Any) -> tuple[Any, list[Any]]:
    """Return the full set's variables and what binds them to the base parameters."""
    links = cp.Variable((mapping.dof, 10))
    rotors = cp.Variable(mapping.dof)
    full = cp.reshape(links, (10 * mapping.dof,), order="C")
    limits = [base == mapping.links @ full + mapping.rotors @ rotors, rotors >= 0]
    for i in range(mapping.dof):
        limits.append(_pseudo_inertia(links[i], cp) >> 0)
    return links, limits


def _pseudo_inertia(link: Any, cp: Any) -> Any:
    """[[tr(J)/2 1 - J, h], [h', m]] of m, h, J about the frame's origin (4 x 4)."""
    m, hx, hy, hz, xx, yy, zz, xy, xz, yz = (link[k] for k in range(10))
    rows = [
        [(yy + zz - xx) / 2, -xy, -xz, hx],
        [-xy, (xx + zz - yy) / 2, -yz, hy],
        [-xz, -yz, (xx + yy - zz) / 2, hz],
        [hx, hy, hz, m],
    ]
    return cp.bmat(rows)
