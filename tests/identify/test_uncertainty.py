"""The stated uncertainty is true: simulated runs with known parameters, noise with the real logs' memory."""

import numpy as np
import pytest

from residuum.codegen.regressors import regressor
from residuum.identify.estimate import fit, fold_rows
from residuum.identify.physical import link_map
from residuum.identify.pieces import Piece
from residuum.identify.requests import DISSIPATING, default_requests
from residuum.identify.rows import Recipe
from residuum.identify.schedule import scheduler
from residuum.identify.solve import Problem, determined, prior
from residuum.symbolic.nominal import nominal_model, robot_arm


def study(twins, robot, runs: int, seconds: float):
    """Errors of all parameters in their own stated standard deviations (runs, P), and shares from data."""
    nominal = nominal_model(robot, "", 6)
    columns = [c for r in default_requests(6) for j in r.joints for c in r.columns(j)]
    found = regressor(robot_arm(nominal), columns)
    recipe = Recipe(found, tuple(j.drive_gain for j in nominal.joint))
    width = len(found.base)
    positive = tuple(width + k for k, c in enumerate(columns) if (c.term, c.parameter) in DISSIPATING)
    problem = Problem(
        tuple(recipe.indices(i) for i in range(6)), prior(nominal, recipe), positive, link_map(nominal)
    )
    errors, shares, moved = [], [], []
    with scheduler(workers=1) as at:
        for k in range(runs):
            twin = twins[k % len(twins)]
            rows = at.place(
                lambda item: fold_rows(Piece(0, item, ()), recipe, ()), [twin.recording(seconds, seed=k)]
            )
            fitted = fit(rows, problem, at)
            truth = [twin.model.base[n].value for n in found.base]
            friction = {(t.name, t.joint): next(iter(t.parameters.values())) for t in twin.model.term}
            truth += [friction[c.term, c.joint] for c in columns]
            errors.append((fitted.estimate.theta - truth) / np.sqrt(np.diag(fitted.covariance)))
            shares.append(determined(fitted.estimate, problem)[0])
            moved.append(fitted.estimate.moved)
    return np.array(errors), np.array(shares), [*found.base, *(c.name for c in columns)], np.array(moved)


@pytest.fixture(scope="module")
def twins(tools):
    robot, _ = tools.ur5e()
    rng = np.random.default_rng(5)
    return [tools.make_twin(tools.perturbed(robot, rng)) for _ in range(4)]


def inside(errors, shares, names, capsys, least: float):
    """Share of runs within three standard deviations, by parameter that all runs show."""
    identified = shares.min(axis=0) > 0.5
    within = (np.abs(errors) < 3).mean(axis=0)
    spread = errors.std(axis=0)
    with capsys.disabled():
        print(
            f"\n{len(errors)} runs, {identified.sum()} of {len(names)} parameters identified in all of them"
        )
        print(
            f"within 3 std: least {100 * within[identified].min():.1f} %, mean {100 * within[identified].mean():.2f} %"
        )
        print(f"scatter over stated std: {spread[identified].min():.2f} to {spread[identified].max():.2f}")
        for k in np.argsort(within)[:3]:
            print(
                f"  {names[k]:14} {100 * within[k]:.1f} %  scatter {spread[k]:.2f}  share from data {shares[:, k].min():.2f}"
            )
    assert identified.sum() > 40
    assert (within[identified] >= least).all(), [
        n for n, w, i in zip(names, within, identified, strict=True) if i and w < least
    ]


@pytest.mark.slow
def test_true_parameters_lie_within_three_stated_deviations(twins, tools, capsys):
    errors, shares, names, _ = study(twins, tools.ur5e()[0], 200, 120.0)
    inside(errors, shares, names, capsys, 0.95)


def test_stated_deviations_are_of_the_right_size(twins, tools, capsys):
    errors, shares, names, _ = study(twins, tools.ur5e()[0], 8, 120.0)
    inside(errors, shares, names, capsys, 0.75)
    identified = shares.min(axis=0) > 0.5
    assert 0.6 < np.sqrt(np.mean(errors[:, identified] ** 2)) < 1.5
