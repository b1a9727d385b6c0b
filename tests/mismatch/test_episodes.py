"""What comes and goes: found in time, one force or none."""

import numpy as np
import pytest
from rows_by_hand import STEP, ar1, rows

from residuum.mismatch.episodes import contact, episodes, involved
from residuum.mismatch.grams import Scales
from residuum.mismatch.physics import forces

LONG = 3600
SCALES = Scales(np.tile([0.3, 0.6, 0.9], (3, 1)), np.full(3, 4.0), np.full(3, np.inf))
PUSH = slice(1200, 1500)


def quiet(seed: int = 1):
    return 0.3 * ar1(LONG, 0.6, np.random.default_rng(seed), 3)


def found_in(left, run):
    return episodes([run], [0], [left], SCALES, np.zeros(3))


def test_noise_alone_is_no_episode() -> None:
    for seed in range(5):
        assert not found_in(quiet(seed), rows(LONG, 3))


def test_a_push_is_found_where_it_was_and_is_one_force(arm) -> None:
    run, left = rows(LONG, 3), quiet()
    left[PUSH] += forces(arm.physics, run.q[PUSH], 3) @ np.array([-20.0, 10.0, 30.0])
    (episode,) = found_in(left, run)
    assert episode.span == pytest.approx((PUSH.start * STEP, PUSH.stop * STEP), abs=0.3)
    force = contact([episode], [run], {0: left}, arm.physics, SCALES.sigma[:, 0])
    assert force is not None
    assert force.pushes == (episode,)
    assert force.force == pytest.approx(np.linalg.norm([20, 10, 30]), rel=0.2)


def test_a_single_joint_is_no_contact(arm) -> None:
    run, left = rows(LONG, 3), quiet()
    left[PUSH, 1] += 5.0
    (episode,) = found_in(left, run)
    assert involved([episode]) == [1]
    assert contact([episode], [run], {0: left}, arm.physics, SCALES.sigma[:, 0]) is None


def test_what_else_comes_and_goes_weakly_does_not_hide_a_push(arm) -> None:
    run, left = rows(LONG, 3), quiet()
    left[PUSH] += forces(arm.physics, run.q[PUSH], 3) @ np.array([-20.0, 10.0, 30.0])
    left[2400:2430, 0] += 1.5
    push, other = found_in(left, run)
    force = contact([push, other], [run], {0: left}, arm.physics, SCALES.sigma[:, 0])
    assert force is not None
    assert push in force.pushes


def test_what_is_always_there_does_not_come_and_go() -> None:
    left = quiet()
    left[: LONG // 2, 0] += 4.0
    assert not found_in(left, rows(LONG, 3))


def test_at_rest_a_joint_holds_its_coulomb_level_without_anything_being_there() -> None:
    moving, left = np.ones((LONG, 3)), quiet()
    moving[1000:1600] = 0.0
    left[1000:1600, 0] += 5.0
    run = rows(LONG, 3, moving=moving)
    assert found_in(left, run)
    assert not episodes([run], [0], [left], SCALES, np.full(3, 6.0))


def test_pauses_belong_to_the_episode() -> None:
    left = quiet()
    for part in (slice(1200, 1300), slice(1320, 1400)):
        left[part, 2] += 4.0
    assert len(found_in(left, rows(LONG, 3))) == 1
