"""Hypotheses: which columns each has."""

import numpy as np
import pytest

from residuum.mismatch.candidates import candidates


@pytest.mark.parametrize("changed", [True, False])
def test_friction_came_to_depend_on_temperature_from_an_unknown_one_on(arm, changed) -> None:
    space, n = arm.setup.space, arm.setup.space.dof
    widths = dict.fromkeys(("encoder", "elasticity", "tilt", "delay", "lacking"), 1.0)
    own, base, load = np.ones((n, len(space.own))), np.ones(len(space.base)), np.tile([-1.0, 1.0], (n, 1))
    found = candidates(space, arm.physics, own, widths, base, load, changed).each
    hot = next(c for c in found if c.effect == "temperature_dependent_friction" and c.joint == 1)
    levels = {
        c.columns for c in found if c.effect in ("coulomb_friction", "viscous_friction") and c.joint == 1
    }
    assert all(set(columns) <= set(hot.columns) for columns in levels) == changed
