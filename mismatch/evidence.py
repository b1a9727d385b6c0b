"""Everything that naming works on: rows of all recordings, their noise, and the hypotheses."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve

from ..identify.solve import base_widths
from ..recordings import Recording
from ..robots import Robot
from ..robots.model import Model
from .candidates import Candidates, candidates, curve_columns, own_columns
from .columns import (
    BASELINE,
    BY_NAME,
    LATE,
    LATE_FRICTION,
    REPEAT,
    SLACK,
    WIDTH,
    WINDUP,
    Column,
    Space,
    space_of,
)
from .flexible import ranges
from .grams import Fold, Scales, equal_scales, evenly, folds_of, scales_of, whole
from .lacking import SHARE, dropped_of, frozen_of, widths
from .physics import of_links, physics_of
from .pool import each
from .repeats import repeated, views
from .rows import Rows, common_names, make_rows
from .selection import Sums
from .track import Setup
from .windup import seen

Array = NDArray[np.float64]


#: Prior width of a column that a model is to be without.
_NONE = 1e-12


@dataclass(frozen=True)
class Evidence:
    """Rows a run, folds, noise, hypotheses. observed: whether a run is not of the reference.

    base_std (B,): wide prior of the base parameters; torque (N,): rms of the measured torque, Nm.
    """

    setup: Setup
    runs: tuple[Rows, ...]
    observed: tuple[bool, ...]
    scales: Scales
    folds: tuple[Fold, ...]
    found: Candidates
    base_std: Array
    torque: Array
    own_std: Array
    observed_scales: Scales | None = None

    @property
    def has_reference(self) -> bool:
        """Whether there are recordings to compare with."""
        return not all(self.observed)

    @property
    def noise(self) -> Scales:
        """Scales of the observed rows."""
        return self.observed_scales or self.scales

    @cached_property
    def mean(self) -> Array:
        """Prior mean (P,) of all parameters: those of the nominal model, without friction."""
        found = _lifted(self.setup.physics.published, self.setup.space)
        for x in self.setup.lacking:
            found[self.setup.space.common_index(x.name)] = x.nominal
        return found

    @cached_property
    def sums(self) -> Sums:
        """Gram matrices of both sides about the prior mean."""
        return Sums(self.folds, self.setup.space, self.mean)


def gather(
    recordings: Sequence[Recording], observed: Sequence[bool], model: Model, robot: Robot,
    progress: Callable[[str], None] = lambda _: None, simplified: Model | None = None,
) -> Evidence:  # fmt: skip
    """Make rows, first with a plain model for loads and slopes, then with every hypothesis.

    simplified: the nominal model, where it drops couplings of `model`, the full one.
    """
    physics = physics_of(model, robot)
    gains = np.array([j.drive_gain for j in model.joint])
    gear = float(robot.joint[0].gear)
    base_std = base_widths(model, physics.regressor.base)
    plain_own = (Column("coulomb", "Fc", (("width", WIDTH),)), Column("viscous", "Fv"), Column("offset", "c"))
    still = np.zeros((physics.dof, 2))
    known = tuple(t for t in model.term if t.name not in BASELINE)
    space = space_of(physics.regressor, plain_own, ())
    plain = Setup(physics, space, gains, physics.published, still, known=known)
    progress("first fit")
    first = each(lambda r: make_rows(r, plain), recordings)
    sides = list(observed)
    healthy = [r for r, o in zip(first, sides, strict=True) if not o] or first
    base, friction = _plain_fit(healthy, plain.space, physics.published, base_std)
    q, qd, load, heat = _states(first)
    frozen = frozen_of(model, robot, recordings)
    lacking = ((frozen,) if frozen else ()) + ((dropped_of(simplified, model),) if simplified else ())
    own = (*own_columns(gear), *curve_columns())
    limits = ranges(q, qd, load, heat)
    setup = Setup(
        physics, space_of(physics.regressor, own, common_names(physics.dof, lacking)),
        gains, base, friction, limits, known, lacking,
    )  # fmt: skip
    progress("columns of every hypothesis")
    runs = each(lambda r: make_rows(r, setup), recordings)
    torque = np.sqrt(np.mean(np.concatenate([r.torque for r in runs]) ** 2, axis=0))
    own_std = 0.2 * _own_std(runs, setup.space, torque)
    own_std[:, [c.term in (SLACK, WINDUP, REPEAT) for c in setup.space.own]] = 1.0  # columns of the whole
    common_std = {
        "encoder": 0.05, "elasticity": 1e-3, "tilt": 0.2, "delay": 0.05, "lacking": SHARE,
    }  # fmt: skip
    own_std[:, [c.term in (LATE, LATE_FRICTION) for c in setup.space.own]] = common_std["delay"]
    changed = not all(sides)
    swings = seen(of_links(physics, base, q[::50]))
    found = candidates(
        setup.space, physics, own_std, common_std, base_std, limits.load, swings, friction[:, 0], changed
    )
    progress("noise")
    none = equal_scales(physics.dof)
    return renewed(Evidence(setup, (), tuple(sides), none, (), found, base_std, torque, own_std), runs)


def renewed(evidence: Evidence, runs: Sequence[Rows]) -> Evidence:
    """Return the evidence of other rows of the same recordings: their noise and folds anew."""
    space, sides = evidence.setup.space, evidence.observed
    healthy = [r for r, o in zip(runs, sides, strict=True) if not o] or runs
    # noise is what the richest model leaves, without what only a finding frees
    own = np.where([c.term in BY_NAME for c in space.own], _NONE, evidence.own_std)
    std = np.concatenate([evidence.base_std, own.ravel(), widths(space.common, _NONE)])
    theta, scales = _fitted(healthy, space, evidence.setup.physics.published, std)
    if evidence.has_reference:
        runs = _repeating(evidence.setup, runs, sides, theta)
    folds = folds_of(runs, sides, scales, space)
    return replace(evidence, runs=tuple(runs), scales=scales, folds=tuple(folds), observed_scales=None)


def _repeating(setup: Setup, runs: Sequence[Rows], observed: Sequence[bool], theta: Array) -> list[Rows]:
    """Return rows whose column of repeats holds what parameters (P,) leave of the reference."""
    space, level = setup.space, setup.friction[:, 0]
    healthy = [r for r, o in zip(runs, observed, strict=True) if not o]
    left, found = [residual(r, space, theta) for r in healthy], list[Rows]()
    for rows, mine in zip(runs, observed, strict=True):
        columns = rows.columns
        if mine:
            known = repeated(healthy, left, level, rows)
            columns = tuple(x.copy() for x in columns)
            for j, view in enumerate(views(columns, space)):
                view[:] = known[:, j]
        found.append(replace(rows, columns=columns))
    return found


def _states(runs: Sequence[Rows]) -> tuple[Array, Array, Array, Array]:
    return tuple(np.concatenate([getattr(r, k) for r in runs]) for k in ("q", "qd", "load", "temperature"))  # type: ignore[return-value]


def weighed(evidence: Evidence, scales: Scales) -> Evidence:
    """Weigh the observed rows by other scales."""
    mine = folds_of(evidence.runs, evidence.observed, scales, evidence.setup.space, sides=[True])
    theirs = [f for f in evidence.folds if not f.observed]
    return replace(evidence, folds=(*mine, *theirs), observed_scales=scales)


def evenly_weighed(evidence: Evidence) -> Evidence:
    """Weigh the rows of both sides so that slow and fast residuals count alike."""
    scales, mine = evenly(evidence.scales), evenly(evidence.noise)
    folds = folds_of(evidence.runs, evidence.observed, scales, evidence.setup.space, observed_scales=mine)
    return replace(evidence, folds=tuple(folds), scales=scales, observed_scales=mine)


def _lifted(base: Array, space: Space) -> Array:
    return np.concatenate([base, np.zeros(space.size - len(base))])


def _plain_fit(runs: Sequence[Rows], space: Space, published: Array, base_std: Array) -> tuple[Array, Array]:
    """Fit base parameters, Coulomb, viscous and offset; return base (B,) and (N, 2) of friction."""
    torque = np.sqrt(np.mean(np.concatenate([r.torque for r in runs]) ** 2, axis=0))
    std = np.concatenate([base_std, np.repeat(torque, len(space.own))])
    theta, _ = _fitted(runs, space, published, std)
    b, k = len(space.base), len(space.own)
    return theta[:b], theta[b:].reshape(space.dof, k)[:, :2]


def _fitted(runs: Sequence[Rows], space: Space, published: Array, std: Array) -> tuple[Array, Scales]:
    """Fit parameters (P,) of prior widths std (P,) and the noise that they leave, in two passes."""
    mean, scales = _lifted(published, space), equal_scales(space.dof)
    theta = mean
    for _ in range(2):
        folds = folds_of(runs, [True] * len(runs), scales, space)
        theta = _ridge(np.sum([whole(f.grams, space) for f in folds], axis=0), mean, std)
        scales = scales_of(runs, [residual(r, space, theta) for r in runs])
    return theta, scales


def _ridge(gram: Array, mean: Array, std: Array) -> Array:
    a = gram[:-1, :-1] * np.outer(std, std) + np.eye(len(std))
    right = std * (gram[:-1, -1] - gram[:-1, :-1] @ mean)
    return np.asarray(mean + std * cho_solve(cho_factor(a), right), np.float64)


def residual(rows: Rows, space: Space, theta: Array, part: slice = slice(None)) -> Array:
    """Return torque less columns @ theta (n, N) of some rows."""
    joints = range(space.dof)
    left = [rows.torque[part, j] - rows.columns[j][part] @ theta[space.indices[j]] for j in joints]
    return np.stack(left, axis=1)


def _own_std(runs: Sequence[Rows], space: Space, torque: Array) -> Array:
    """Prior width of each own column: such that it could make half of the joint's torque."""
    k = len(space.own)
    std = np.ones((space.dof, k))
    for j in range(space.dof):
        start = len(space.seen[j])
        power = np.mean(
            [np.mean(r.columns[j][:, start : start + k] ** 2, axis=0) for r in runs if len(r)], axis=0
        )
        std[j] = 0.5 * torque[j] / np.maximum(np.sqrt(power), 1e-9)
        std[j] = np.minimum(std[j], 1e6)
    return std
