"""Columns are derivatives of the one Lagrangian and of the catalogue: generated code says the same twice."""

import numpy as np
import pytest

from residuum.codegen.regressors import linear_columns, regressor
from residuum.identify.rows import Recipe, make_rows
from residuum.symbolic.nominal import robot_arm
from residuum.symbolic.terms import CATALOGUE


@pytest.fixture(scope="module")
def case(tools):
    twin = tools.make_twin(tools.ur5e()[0])
    columns = [c for t in twin.model.term for c in linear_columns(t.name, t.joint, {})]
    return twin, regressor(robot_arm(twin.model), columns)


def test_columns_times_parameters_are_the_generated_dynamics(case):
    twin, found = case
    rng = np.random.default_rng(0)
    q, qd, qdd = rng.normal(size=(3, 50, 6))
    theta = np.array([twin.model.base[n].value for n in found.base])
    observer = twin.observer
    for part, right in (
        ("momentum", observer.momentum(q, qd)), ("beta", observer.beta(q, qd)),
        ("torque", observer.inverse_dynamics(q, qd, qdd)),
    ):  # fmt: skip
        np.testing.assert_allclose(found.matrix(part, q=q, qd=qd, qdd=qdd) @ theta, right, atol=1e-11)
    friction = [
        t.parameters[c.parameter] for t in twin.model.term for c in linear_columns(t.name, t.joint, {})
    ]
    columns = found.matrix("terms", q=q, qd=qd, load=q, temperature=q)
    np.testing.assert_allclose(columns @ friction, observer.friction(q, qd), atol=1e-12)


@pytest.mark.parametrize("name", sorted(n for n, t in CATALOGUE.items() if not t.state))
def test_every_term_without_state_has_columns(case, name):
    twin, _ = case
    columns = linear_columns(name, 2, {})
    found = regressor(robot_arm(twin.model), columns)
    inputs = {k: np.full((3, 6), 0.3) for k in ("q", "qd", "load", "temperature")}
    assert found.matrix("terms", **inputs).shape == (3, 6, len(CATALOGUE[name].linear_in))
    assert np.isfinite(found.matrix("terms", **inputs)).all()


@pytest.mark.parametrize("form", ["momentum", "inverse-dynamics"])
@pytest.mark.parametrize("zero_phase", [True, False])
def test_both_forms_see_no_error_without_noise(case, form, zero_phase):
    """Rows at the true parameters: what is left is discretisation.

    The inverse form also smooths positions before a nonlinear function, which is not the same as after it.
    """
    twin, found = case
    gains = tuple(j.drive_gain for j in twin.model.joint)
    recipe = Recipe(found, gains, form=form, zero_phase=zero_phase)
    recording = twin.recording(20.0, seed=1, rate=125.0, noise=0.0, jitter=0.1)
    rows = make_rows(recording, recipe)
    theta = np.array([twin.model.base[n].value for n in found.base])
    theta = np.append(
        theta,
        [t.parameters[c.parameter] for t in twin.model.term for c in linear_columns(t.name, t.joint, {})],
    )
    limit = 0.02 if form == "momentum" else 0.03
    for i in range(6):
        error = rows.torque[:, i] - rows.columns[i] @ theta[recipe.indices(i)]
        moving = rows.moving[:, i]
        assert np.linalg.norm(error[moving]) < limit * np.linalg.norm(rows.torque[moving, i])


def test_rows_stop_at_gaps(case):
    twin, found = case
    recording = twin.recording(20.0, seed=1)
    keep = (recording.timestamp < 18.0) | (recording.timestamp > 22.0)
    rows = make_rows(recording.take(keep), Recipe(found, (1.0,) * 6))
    assert len(rows.starts) == 2
    assert not ((rows.time > 17.8) & (rows.time < 22.2)).any()
