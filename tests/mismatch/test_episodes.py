"""What comes and goes is found in time."""

import numpy as np
import pytest
from rows_by_hand import LONG, PUSH, STEP, found_in, quiet, rows, scales

from residuum.mismatch.episodes import episodes, involved


def test_noise_alone_is_no_episode() -> None:
    for seed in range(5):
        assert not found_in(quiet(seed), rows(LONG, 3))


def test_what_comes_and_goes_is_found_where_it_was() -> None:
    left = quiet()
    left[PUSH, 1] += 5.0
    (episode,) = found_in(left, rows(LONG, 3))
    assert episode.span == pytest.approx((PUSH.start * STEP, PUSH.stop * STEP), abs=0.3)
    assert involved([episode]) == [1]


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
    assert not episodes([run], [0], [left], scales(), np.full(3, 6.0))


def test_pauses_belong_to_the_episode() -> None:
    left = quiet()
    for part in (slice(1200, 1300), slice(1320, 1400)):
        left[part, 2] += 4.0
    assert len(found_in(left, rows(LONG, 3))) == 1
