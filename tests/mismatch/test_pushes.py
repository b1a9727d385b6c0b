"""Pushes: one force on all joints, told from what is none, and kept out of every fit."""

import numpy as np
import pytest
from rows_by_hand import LONG, PUSH, STEP, found_in, quiet, rows, scales

from residuum.mismatch import Task, explain
from residuum.mismatch.physics import forces, levers, physics_of
from residuum.mismatch.pushes import contact
from residuum.mismatch.rows import kept
from residuum.robots import load_robot
from residuum.symbolic.nominal import nominal_model


def known(left):
    """What residuals are known to, by run."""
    return {0: np.broadcast_to(scales(left.shape[1]).sigma[:, 0], left.shape)}


def test_a_push_is_one_force(arm) -> None:
    run, left = rows(LONG, 3), quiet()
    left[PUSH] += forces(arm.physics, run.q[PUSH], 3) @ np.array([-20.0, 10.0, 30.0])
    (episode,) = found_in(left, run)
    assert episode.span == pytest.approx((PUSH.start * STEP, PUSH.stop * STEP), abs=0.3)
    force = contact([episode], [run], {0: left}, arm.physics, known(left))
    assert force is not None
    assert force.pushes == (episode,)
    assert force.force == pytest.approx(np.linalg.norm([20, 10, 30]), rel=0.2)


def test_a_push_far_from_any_frame_is_one_force() -> None:
    """At a tool's tip the same force has moments that none at the flange has."""
    robot, digest = load_robot("ur5e")
    physics = physics_of(nominal_model(robot, digest, 6), robot)
    waves = np.outer(STEP * np.arange(LONG), np.ones(6))
    home = np.array([0.0, -1.4, 1.3, -1.5, -1.5, 0.0])
    run = rows(LONG, 6, q=home + 0.5 * np.sin(waves + np.arange(6)))
    left = quiet(joints=6)
    tip = forces(physics, run.q[PUSH], 6) + levers(physics, run.q[PUSH], 6) @ np.array([0.1, 0.2, -0.1])
    left[PUSH] += tip @ np.array([-20.0, 10.0, 30.0])
    force = contact(found_in(left, run), [run], {0: left}, physics, known(left))
    assert force is not None
    assert force.force == pytest.approx(np.linalg.norm([20, 10, 30]), rel=0.1)


def test_a_single_joint_is_no_contact(arm) -> None:
    run, left = rows(LONG, 3), quiet()
    left[PUSH, 1] += 5.0
    (episode,) = found_in(left, run)
    assert contact([episode], [run], {0: left}, arm.physics, known(left)) is None


def test_what_changes_its_direction_is_no_push(arm) -> None:
    """As a wrong delay leaves it at jerks: one force fits every instant, but it turns round."""
    run, left = rows(LONG, 3), quiet()
    swing = np.sin(np.linspace(0, 4 * np.pi, PUSH.stop - PUSH.start))
    left[PUSH] += swing[:, None] * (forces(arm.physics, run.q[PUSH], 3) @ np.array([-20.0, 10.0, 30.0]))
    some = found_in(left, run)
    assert some
    assert contact(some, [run], {0: left}, arm.physics, known(left)) is None


def test_what_else_comes_and_goes_weakly_does_not_hide_a_push(arm) -> None:
    run, left = rows(LONG, 3), quiet()
    left[PUSH] += forces(arm.physics, run.q[PUSH], 3) @ np.array([-20.0, 10.0, 30.0])
    left[2400:2430, 0] += 1.5
    push, other = found_in(left, run)
    force = contact([push, other], [run], {0: left}, arm.physics, known(left))
    assert force is not None
    assert push in force.pushes


def test_rows_that_are_kept_stay_as_they_were() -> None:
    run, keep = rows(LONG, 3), np.ones(LONG, bool)
    keep[PUSH] = False
    some = kept(run, keep)
    assert len(some) == LONG - (PUSH.stop - PUSH.start) and some.step == STEP
    np.testing.assert_array_equal(some.time, run.time[keep])
    np.testing.assert_array_equal(some.q, run.q[keep])
    assert all(len(x) == len(some) for x in some.columns)


@pytest.mark.slow
@pytest.mark.parametrize("reference", [True, False])
def test_long_strong_pushes_bend_no_fit(simulated, reference: bool) -> None:
    """A tenth of the time pushed by 35 N: far more than all else in the recording."""
    robot, digest = load_robot("ur5e")
    healthy = (simulated("clean", 11), simulated("clean", 12)) if reference else ()
    task = Task((simulated("pushed", 3),), healthy, robot, digest, 6, propose=False, thresholds=False)
    answer = explain(task)
    found, *others = answer.findings["findings"]
    assert found["effect"] == "external_contact"
    assert found["parameters"]["force"]["value"] == pytest.approx(35.0, rel=0.1)
    first, second = found["intervals"]
    assert first == pytest.approx([8.0, 9.5], abs=0.3) and second == pytest.approx([20.0, 21.5], abs=0.3)
    # without a reference the gears' own curves are findings, but no body and nothing unknown
    bent = {"payload", "link_inertial", "base_tilt", "encoder_offset", "unknown"}
    assert not others if reference else bent.isdisjoint(f["effect"] for f in others)
    # the page shows the pushes, the error that the model leaves is without them
    assert max(float(np.abs(t.after).max()) for t in answer.traces) > 15.0
    assert max(answer.findings["fit"]["after"]) < 1.0
