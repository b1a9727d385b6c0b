"""Hypotheses: which columns each has."""

import numpy as np
import pytest

from residuum.mismatch.candidates import candidates
from residuum.mismatch.columns import STIFFNESSES


def offered(arm, swings, changed, load=(-1.0, 1.0)):
    """Hypotheses of an arm whose gears swing slowly enough up to some stiffnesses, Nm/rad; load: range, Nm."""
    space, n = arm.setup.space, arm.setup.space.dof
    widths = dict.fromkeys(("encoder", "elasticity", "tilt", "delay", "lacking"), 1.0)
    own, base, loads = np.ones((n, len(space.own))), np.ones(len(space.base)), np.tile(load, (n, 1))
    return candidates(space, arm.physics, own, widths, base, loads, np.array(swings), np.ones(n), changed)


@pytest.mark.parametrize("changed", [True, False])
def test_friction_came_to_depend_on_temperature_from_an_unknown_one_on(arm, changed) -> None:
    found = offered(arm, [np.inf] * 3, changed).each
    hot = next(c for c in found if c.effect == "temperature_dependent_friction" and c.joint == 1)
    levels = {
        c.columns for c in found if c.effect in ("coulomb_friction", "viscous_friction") and c.joint == 1
    }
    assert all(set(columns) <= set(hot.columns) for columns in levels) == changed


def test_a_gear_swings_only_where_rows_are_fast_enough_for_it(arm) -> None:
    found = offered(arm, [0.0, 1e4, np.inf], False).each
    soft = [c for c in found if c.effect == "joint_elasticity"]
    assert {c.joint for c in soft if not c.values} == {0, 1, 2}  # all of them may lag
    stiffest = [
        max((dict(c.values)["stiffer"] for c in soft if c.joint == j and c.values), default=0)
        for j in range(3)
    ]
    assert stiffest[0] == 0 and 5e3 < stiffest[1] <= 1e4 and stiffest[2] == max(STIFFNESSES)


@pytest.mark.parametrize(("load", "towards"), [((2.0, 9.0), -1.0), ((-9.0, -2.0), 1.0)])
def test_slack_under_a_load_that_keeps_its_sign_is_an_encoders_offset(arm, load, towards) -> None:
    found = offered(arm, [np.inf] * 3, True, load)
    assert not [c for c in found.each if c.effect == "backlash"]
    for slack in found.unshown:
        encoder = next(c for c in found.each if c.key == ("encoder_offset", slack.joint))
        of_slack, of_encoder = (found.directions.take(c.columns).vectors.toarray() for c in (slack, encoder))
        np.testing.assert_array_equal(of_slack, towards * of_encoder)  # the link hangs behind its motor
        assert slack.conceivable(np.array([0.01]))
        assert not slack.conceivable(np.array([-0.01])) and not slack.conceivable(np.array([0.1]))
    assert {c.key for c in found.unshown} == {("backlash", j) for j in range(3)}


def test_since_a_reference_a_body_may_change_by_little_or_by_much(arm) -> None:
    (_,) = (c for c in offered(arm, [np.inf] * 3, False).each if c.key == ("link_inertial", 1))
    found = offered(arm, [np.inf] * 3, True)
    little, much = (c for c in found.each if c.key == ("link_inertial", 1))
    first, second = (found.directions.take(c.columns) for c in (little, much))
    np.testing.assert_array_equal(first.vectors.toarray(), second.vectors.toarray())
    assert np.all(first.std < second.std)
