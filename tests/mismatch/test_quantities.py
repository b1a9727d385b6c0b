"""Numbers of a finding: the peak of the evidence between grid points, and how numbers are written."""

import numpy as np
import pytest

from residuum.mismatch.candidates import Candidate
from residuum.mismatch.grid import peak, size_at_peak
from residuum.mismatch.naming import Scored
from residuum.mismatch.quantities import MIXING, parameters_of, quantity


@pytest.mark.parametrize("true", [0.006, 0.0105, 0.02])
def test_peak_of_a_parabola_over_the_logarithm_is_exact(true) -> None:
    grid = [0.003, 0.006, 0.012, 0.03]
    heights = [-0.5 * (np.log(x / true) / 0.3) ** 2 for x in grid]
    value, std = peak(grid, heights)
    if 0.0045 < true < 0.02:
        assert value == pytest.approx(true, rel=1e-9)
        assert std == pytest.approx(0.3 * true, rel=1e-9)
    else:
        assert grid[1] * 0.99 <= value <= grid[-1]


@pytest.mark.parametrize(("heights", "best"), [([5, 3, 1, 0], 0.01), ([0, 1, 3, 5], 0.08)])
def test_at_the_border_nothing_is_claimed(heights, best) -> None:
    assert peak([0.01, 0.02, 0.04, 0.08], heights) == (best, None)


def test_two_points_have_no_peak() -> None:
    assert peak([0.3, 1.0], [4.0, 7.0]) == (1.0, None)


@pytest.mark.parametrize("std", [None, np.nan, np.inf])
def test_an_unknown_deviation_is_null(std) -> None:
    assert quantity(1.23456789, std, "kg") == {"value": 1.23457, "std": None, "unit": "kg"}


def test_deviations_keep_three_digits() -> None:
    assert quantity(2.0, 0.0123456, "kg")["std"] == 0.0123


def test_a_gear_between_two_stiffnesses_has_one_between_them() -> None:
    """In the proportion of their coefficients, and never beyond them."""
    values = ("stiffness", 9e3), ("stiffer", 1.2e4)
    soft = Candidate("joint_elasticity", 0, (0, 1), values, whole=True)
    for parts, expected in (((0.4, 0.4), 1.05e4), ((0.9, -0.1), 9e3)):
        found = Scored(soft, np.ones(4), 50.0, np.array(parts), np.full(2, 0.01))
        stiffness = parameters_of(None, None, found, None)["stiffness"]
        assert stiffness["value"] == pytest.approx(expected)
        assert stiffness["unit"] == "Nm/rad" and stiffness["std"] >= MIXING * expected


def test_a_size_between_two_values_follows_their_powers() -> None:
    """Evidence that is a parabola over the logarithm, sizes that fall with the square of the value."""
    values = np.array([0.005, 0.01, 0.02, 0.04])
    heights = 100.0 - 8.0 * np.log(values / 0.013) ** 2
    assert peak(values, heights)[0] == pytest.approx(0.013)
    assert size_at_peak(values, heights, -3.0 * values**-2.0) == pytest.approx(3.0 * 0.013**-2.0)


def test_a_late_level_is_that_of_its_lag_between_two_of_the_grid() -> None:
    late = Candidate("velocity_lag", 0, (0,), (("lag", 0.018),), ("lag",))
    found = Scored(late, np.ones(2), 50.0, np.array([1.9]), np.array([0.1]), between=2.85)
    level = parameters_of(None, None, found, None)["A"]
    assert level["value"] == pytest.approx(2.85) and level["std"] == pytest.approx(0.15)
