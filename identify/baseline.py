"""The baseline model: rigid body, rotors and friction of an arm from its recordings, start to end."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..codegen.regressors import regressor
from ..errors import InputError
from ..robots import Robot
from ..robots.model import Model
from ..symbolic.nominal import nominal_model, robot_arm
from .estimate import Fitted, HeldOut, fit, fold_rows, held_out
from .physical import LinkMap, link_map
from .pieces import Piece, Placed, place
from .requests import DISSIPATING, TermRequest, default_requests, merged
from .rows import Form, Recipe
from .schedule import Scheduler
from .search import Searched, search
from .solve import Prior, Problem, determined, prior

Array = NDArray[np.float64]

#: Blocks that a single recording is cut into for held-out errors.
_BLOCKS = 10
#: Times that a load-dependent term's load is recomputed from the fitted gravity.
_LOAD_ROUNDS = 2
#: rad; a joint left out of the model that turns by more than this moves.
_HELD_STILL = 0.05


@dataclass(frozen=True)
class Options:
    """What a fit can be told. cutoff: Hz; terms: besides the default ones; prior_std: by base parameter."""

    terms: tuple[TermRequest, ...] = ()
    form: Form = "momentum"
    cutoff: float = 10.0
    order: int = 4
    zero_phase: bool = True
    gains: tuple[float, ...] | None = None
    prior_std: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Baseline:
    """A fitted baseline. nominal: the published model, its prior; share (P,): information from data."""

    nominal: Model
    recipe: Recipe
    problem: Problem
    fitted: Fitted
    held_out: HeldOut
    searched: tuple[Searched, ...]
    share: Array
    directions: int
    placed: tuple[Placed, ...]
    step: float
    notes: tuple[str, ...]

    @property
    def names(self) -> list[str]:
        """Names of the P parameters: base parameters, then terms' symbols."""
        return [*self.recipe.regressor.base, *(c.name for c in self.recipe.regressor.terms)]

    @property
    def std(self) -> Array:
        """Standard deviations (P,)."""
        return np.sqrt(np.diag(self.fitted.covariance))


def fit_files(
    paths: Sequence[Path], robot: Robot, robot_hash: str, dof: int, options: Options, scheduler: Scheduler
) -> Baseline:
    """Fit the baseline to recordings; see `fit_placed`. Raises InputError for files that cannot be used."""
    return fit_placed(place(paths, scheduler), robot, robot_hash, dof, options, scheduler)


def fit_placed(
    placed: Sequence[Placed], robot: Robot, robot_hash: str, dof: int, options: Options, scheduler: Scheduler
) -> Baseline:
    """Fit the baseline to placed recordings.

    Raises InputError when nothing moves long enough, or the recordings lack joints or temperatures.
    """
    handles = [h for p in placed for h in p.handles]
    locked, notes = _left_out_joints(handles, robot, dof, scheduler)
    nominal = nominal_model(robot, robot_hash, dof, locked)
    if options.gains is not None:
        pairs = zip(nominal.joint, options.gains, strict=True)
        nominal = nominal.model_copy(
            update={"joint": tuple(j.model_copy(update={"drive_gain": g}) for j, g in pairs)}
        )
    requests = merged([*default_requests(dof), *options.terms])
    session = _Session(nominal, options, handles, _edges(placed), scheduler, link_map(nominal))
    fitted, recipe, problem, rows = session.run([r for r in requests if r.searched is None])
    searched: list[Searched] = []
    if any(r.searched for r in requests):
        known = [r for r in requests if r.searched is None]
        base = tuple(fitted.estimate.theta[: len(recipe.regressor.base)])
        searched = search(requests, fitted, partial(session.recipe, base=base), session.rows, scheduler)
        fitted, recipe, problem, rows = session.run([*known, *(s.request for s in searched)])
    share, directions = determined(fitted.estimate, problem)
    return Baseline(
        nominal, recipe, problem, fitted, held_out(fitted, problem), tuple(searched), share, directions,
        tuple(placed), session.step(rows), tuple(notes),
    )  # fmt: skip


@dataclass(frozen=True)
class _Session:
    """What stays the same while terms come and go."""

    nominal: Model
    options: Options
    handles: Sequence[Any]
    edges: tuple[float, ...]
    scheduler: Scheduler
    mapping: LinkMap

    def recipe(self, requests: Sequence[TermRequest], base: tuple[float, ...] = ()) -> tuple[Recipe, Prior]:
        """Return how rows with these terms are made, and the prior of their parameters."""
        columns = [c for r in requests for joint in r.joints for c in r.columns(joint)]
        found = regressor(robot_arm(self.nominal), columns)
        published = tuple(self.nominal.base[n].value for n in found.base)
        o = self.options
        gains = tuple(j.drive_gain for j in self.nominal.joint)
        recipe = Recipe(found, gains, o.cutoff, o.order, o.zero_phase, o.form, base or published)
        return recipe, prior(self.nominal, recipe, o.prior_std)

    def rows(self, recipe: Recipe) -> list[Any]:
        """Make rows where the pieces are."""
        return self.scheduler.transform(fold_rows, self.handles, recipe, self.edges)

    def step(self, rows: Sequence[Any]) -> float:
        """Return the shortest time between rows, s."""
        return float(min(self.scheduler.map(_step, rows)))

    def run(self, requests: Sequence[TermRequest]) -> tuple[Fitted, Recipe, Problem, list[Any]]:
        """Fit these terms; where some depend on the load, until the load is that of the fitted gravity."""
        recipe, prior = self.recipe(requests)
        for _ in range(_LOAD_ROUNDS if recipe.needs_load else 1):
            rows = self.rows(recipe)
            problem = self._problem(recipe, prior)
            fitted = fit(rows, problem, self.scheduler)
            _require_motion(fitted)
            used, recipe = recipe, replace(recipe, base=tuple(fitted.estimate.theta[: len(recipe.base)]))
        return fitted, used, problem, rows

    def _problem(self, recipe: Recipe, prior: Prior) -> Problem:
        positive = tuple(
            len(recipe.regressor.base) + k
            for k, c in enumerate(recipe.regressor.terms)
            if (c.term, c.parameter) in DISSIPATING
        )
        indices = tuple(recipe.indices(i) for i in range(recipe.regressor.dof))
        return Problem(indices, prior, positive, self.mapping)


def _step(rows: Any) -> float:
    return float(rows.step)


def _require_motion(fitted: Fitted) -> None:
    if all(joint.count == 0 for joint in fitted.sums):
        raise InputError(
            "fit: no joint moves for long enough in these recordings; give some in which the arm moves"
        )


def _edges(placed: Sequence[Placed]) -> tuple[float, ...]:
    """Block borders (s) of a single recording; none when there are several, which are left out one by one."""
    if len(placed) > 1:
        return ()
    only = placed[0]
    return tuple(np.linspace(only.first, only.last, _BLOCKS + 1)[1:-1].tolist())


def _left_out_joints(
    handles: Sequence[Any], robot: Robot, dof: int, scheduler: Scheduler
) -> tuple[tuple[float, ...], list[str]]:
    """Angles (rad) at which the joints beyond `dof` stood, and a note when they did not stand still."""
    beyond = len(robot.joint) - dof
    if beyond <= 0:
        return (), []
    found = [x for x in scheduler.map(_wrist, handles, dof) if x is not None]
    if not found:
        return (0.0,) * beyond, [
            f"joints {dof + 1}-{len(robot.joint)} are not recorded: taken as rigid at 0 deg"
        ]
    middle = np.median([x[0] for x in found], axis=0)
    low, high = np.min([x[1] for x in found], axis=0), np.max([x[2] for x in found], axis=0)
    angles = tuple(float(x) for x in np.resize(middle, beyond)) if len(middle) == beyond else (0.0,) * beyond
    moved = [dof + 1 + k for k in range(len(low)) if high[k] - low[k] > _HELD_STILL]
    if moved:
        text = ", ".join(map(str, moved))
        return angles, [
            f"joints left out moved ({text}): what they do stays in the error; fit with more --dof"
        ]
    return angles, []


def _wrist(piece: Piece, dof: int) -> tuple[Array, Array, Array] | None:
    rest = piece.recording.q[:, dof:]
    return (np.median(rest, axis=0), rest.min(axis=0), rest.max(axis=0)) if rest.shape[1] else None
