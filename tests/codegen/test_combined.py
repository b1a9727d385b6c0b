"""A regressor's part at some parameters is its matrix times them."""

import numpy as np
import pytest

from residuum.codegen.regressors import linear_columns, regressor
from residuum.robots import load_robot
from residuum.symbolic.nominal import nominal_model, robot_arm

ROBOT, DIGEST = load_robot("ur5e")


@pytest.mark.parametrize("part", ["momentum", "beta", "terms"])
def test_a_part_at_parameters_is_its_matrix_times_them(part) -> None:
    terms = linear_columns("coulomb", 1, {}) + linear_columns("viscous", 3, {})
    arm = regressor(robot_arm(nominal_model(ROBOT, DIGEST, 3)), terms)
    rng = np.random.default_rng(1)
    motion = {"q": rng.uniform(-2, 2, (50, 3)), "qd": rng.uniform(-2, 2, (50, 3))}
    parameters = rng.normal(size=len(arm.terms) if part == "terms" else len(arm.base))
    expected = arm.matrix(part, **motion) @ parameters
    np.testing.assert_allclose(arm.combined(part, parameters, **motion), expected, rtol=1e-12, atol=1e-12)
