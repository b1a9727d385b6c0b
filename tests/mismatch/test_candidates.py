"""Hypotheses: which columns each has."""

import numpy as np
import pytest

from residuum.mismatch.candidates import candidates
from residuum.mismatch.columns import STIFFNESSES


def offered(arm, swings, changed):
    """Hypotheses of an arm whose gears swing slowly enough up to some stiffnesses, Nm/rad."""
    space, n = arm.setup.space, arm.setup.space.dof
    widths = dict.fromkeys(("encoder", "elasticity", "tilt", "delay", "lacking"), 1.0)
    own, base, load = np.ones((n, len(space.own))), np.ones(len(space.base)), np.tile([-1.0, 1.0], (n, 1))
    return candidates(space, arm.physics, own, widths, base, load, np.array(swings), np.ones(n), changed).each


@pytest.mark.parametrize("changed", [True, False])
def test_friction_came_to_depend_on_temperature_from_an_unknown_one_on(arm, changed) -> None:
    found = offered(arm, [np.inf] * 3, changed)
    hot = next(c for c in found if c.effect == "temperature_dependent_friction" and c.joint == 1)
    levels = {
        c.columns for c in found if c.effect in ("coulomb_friction", "viscous_friction") and c.joint == 1
    }
    assert all(set(columns) <= set(hot.columns) for columns in levels) == changed


def test_a_gear_swings_only_where_rows_are_fast_enough_for_it(arm) -> None:
    found = offered(arm, [0.0, 1e4, np.inf], False)
    soft = [c for c in found if c.effect == "joint_elasticity"]
    assert {c.joint for c in soft if not c.values} == {0, 1, 2}  # all of them may lag
    stiffest = [
        max((dict(c.values)["stiffer"] for c in soft if c.joint == j and c.values), default=0)
        for j in range(3)
    ]
    assert stiffest[0] == 0 and 5e3 < stiffest[1] <= 1e4 and stiffest[2] == max(STIFFNESSES)
