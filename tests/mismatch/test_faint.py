"""A push below the noise is found by the time it lasts; what is no force, or nothing, is not."""

import numpy as np
import pytest

from residuum.mismatch.evidence import gather
from residuum.mismatch.faint import Stretch, believed, faint
from residuum.mismatch.naming import nuisance, reweighed
from residuum.mismatch.physics import forces
from residuum.mismatch.refit import residuals

START, END = 31.0, 34.0
FORCE = np.array([0.6, -0.4, 0.9])


def friction(qd):
    return np.array([5.0, 6.0, 4.0]) * np.tanh(qd / 1e-3) + 2.0 * qd


def found(evidence, busy=None):
    weighed = reweighed(evidence, model := nuisance(evidence))
    return faint(weighed, residuals(weighed, model), busy or {})


def during(time):
    return ((time > START) & (time < END))[:, None]


def test_a_push_below_the_noise_is_found(arm, moved) -> None:
    """1.2 N for 3 s: 0.2-0.3 Nm, about the noise of a row, of which loud ones are six times as much."""
    pushed = moved(
        friction, 0.5, 3, beside=lambda time, q: during(time) * (forces(arm.physics, q, 3) @ FORCE)
    )
    stretches = found(pushed)
    time = pushed.runs[0].time
    assert stretches and all(s.lead() > 5 for s in stretches)
    assert time[min(s.rows.start for s in stretches)] == pytest.approx(START, abs=0.4)
    assert time[max(s.rows.stop for s in stretches) - 1] == pytest.approx(END, abs=0.4)
    assert np.linalg.norm(stretches[0].force - FORCE) < 0.5 * np.linalg.norm(FORCE)


def test_a_push_while_a_load_is_handed_over_is_part_of_that(arm, moved) -> None:
    pushed = moved(
        friction, 0.5, 3, beside=lambda time, q: during(time) * (forces(arm.physics, q, 3) @ FORCE)
    )
    (rows,) = pushed.runs
    assert found(pushed, {0: np.abs(rows.time - 32.5) < 1.6}) == []
    elsewhere = found(pushed, {0: np.abs(rows.time - 20.0) < 1.6})
    assert [s.rows for s in elsewhere] == [s.rows for s in found(pushed)]


def stretch(nats, start, by_joint=(8.0, 9.0, 7.0)):
    gain = np.array(by_joint) * nats / sum(by_joint)
    return Stretch(0, slice(start, start + 50), nats, FORCE, gain, 0.0, gain)


def test_two_pushes_tell_together_what_neither_tells_alone() -> None:
    """Each pays for its place, 9 nats here; what they have beyond that adds up to 10 or does not."""
    one, other, less = stretch(16.0, 0), stretch(14.5, 100), stretch(12.0, 100)
    assert believed([one], 9.0, 10.0) == believed([other], 9.0, 10.0) == []
    assert believed([one, less], 9.0, 10.0) == believed([one, stretch(14.5, 20)], 9.0, 10.0) == []
    assert believed([other, one], 9.0, 10.0) == [one, other]


def test_what_a_soft_gear_leaves_on_its_own_joint_is_no_push() -> None:
    mostly = stretch(85.0, 0, (1.0, 93.0, 8.0))
    assert believed([mostly], 9.0, 10.0) == [mostly]
    assert believed([mostly], 9.0, 10.0, soft={1}) == []
    assert believed([mostly], 9.0, 10.0, soft={0}) == [mostly]


@pytest.mark.parametrize("seed", range(3))
def test_noise_is_no_push(moved, seed) -> None:
    assert found(moved(friction, 0.5, seed)) == []


def test_what_drags_on_one_joint_is_no_push(moved) -> None:
    drag = np.array([0.0, 0.0, 0.6])
    assert found(moved(friction, 0.5, 3, beside=lambda time, q: during(time) * drag)) == []


def test_a_push_beside_what_drags_more_is_not_believed(arm, moved) -> None:
    """What comes and goes is then mostly something else."""

    def both(time, q):
        later = ((time > 45.0) & (time < 48.0))[:, None]
        drag = later * np.array([0.0, 0.0, 1.2])
        return during(time) * (forces(arm.physics, q, 3) @ FORCE) + drag

    assert found(moved(friction, 0.5, 3, beside=both)) == []


@pytest.mark.parametrize("healthy_too", [False, True])
def test_what_comes_and_goes_in_the_reference_as_well_is_no_push(arm, recorded_arm, healthy_too) -> None:
    def push(time, q):
        return during(time) * (forces(arm.physics, q, 3) @ (4 * FORCE))

    seen = recorded_arm(friction, 0.5, 3, beside=push)
    reference = recorded_arm(friction, 0.5, 4, **({"beside": push} if healthy_too else {}))
    evidence = gather([seen, reference], [True, False], arm.model, arm.robot)
    assert (found(evidence) == []) == healthy_too
