"""A change is one when recordings do not differ by as much anyway."""

import numpy as np
import pytest
from rows_by_hand import random_fold, small_space
from scipy import sparse

from residuum.mismatch.selection import Directions, Sums, eliminated, fit
from residuum.mismatch.yardstick import LIKELIER, Shares


def shares(reference, observed, std: float = 0.1) -> Shares:
    value = np.array([*reference, *observed], float)
    return Shares(value, np.full(len(value), std), np.arange(len(value)) >= len(reference))


SPREAD = [0.5, -0.7, 0.9, -0.4, 0.6, -0.8]
EVEN = [0.05, -0.1, 0.1, 0.0, -0.05, 0.08]


@pytest.mark.parametrize(
    ("reference", "observed", "changed"),
    [
        (EVEN, [1.0], True),
        (EVEN[:4], [1.0], True),
        (SPREAD, [1.0], False),
        ([*EVEN[:5], 1.1], [1.0], False),
        (SPREAD, [0.9, 1.1, 1.0, 1.2, 0.8, 1.0, 0.9, 1.1], True),
        (SPREAD, [4.0, 3.8, 0.1, -0.2, 0.1, -0.1], False),
    ],
    ids=["one", "beside four", "of many sizes", "one like it", "all of many", "two of many"],
)
def test_a_change_is_more_than_the_reference_recordings_differ(reference, observed, changed) -> None:
    assert (shares(reference, observed).likelier >= LIKELIER) == changed


def test_where_recordings_agree_their_spread_costs_little() -> None:
    """Never more nats than a normal error would give; most of them, where the change is seen often."""
    once, often = shares([0.0] * 6, [1.0], std=0.2), shares([0.0] * 12, [1.0] * 6, std=0.5)
    normal = 0.5 / 0.2**2, 6 * 0.5 / 0.5**2
    assert LIKELIER < once.likelier < normal[0]
    assert 0.7 * normal[1] < often.likelier < normal[1]


def test_the_largest_of_the_reference_is_told() -> None:
    assert shares([0.1, -0.6, 0.3], [1.0]).largest == -0.6


def test_each_recording_by_itself_adds_up_to_the_side() -> None:
    """Folds of a single reference recording count one by one."""
    space, rng = small_space(), np.random.default_rng(2)
    folds = [random_fold(space, rng, observed)[0] for observed in (False, False, False, True, True)]
    sums = Sums(folds, space, np.zeros(space.size))
    theirs, mine = sums.apart(2)
    assert len(theirs) == 3 and len(mine) == 2
    assert [len(x) for x in sums.apart(1)] == [1, 1]
    assert np.allclose(np.sum(theirs, axis=0), sums.reference)
    assert np.allclose(np.sum(mine, axis=0), sums.total)


def test_a_model_without_candidates_keeps_its_fit() -> None:
    space, rng = small_space(), np.random.default_rng(3)
    folds = [random_fold(space, rng, observed)[0] for observed in (False, True)]
    sums = Sums(folds, space, np.zeros(space.size))
    eye = Directions(sparse.eye(space.size, format="csc"), np.ones(space.size), np.ones(space.size, bool))
    both = sums.reference + sums.total
    exact = np.linalg.solve(both[:-1, :-1] + np.eye(space.size), both[:-1, -1])
    found = eliminated(fit(sums, eye, sums.total), sums.total, eye.take([0]))
    assert np.allclose(found.own, exact)


def test_a_recording_that_shows_nothing_of_a_change_says_nothing_against_it() -> None:
    """As one that is no colder than the reference, of friction that depends on temperature."""
    value, std = np.array([0.0, 0.01, 0.02, 0.98, 1.0, 1.01, 0.3]), np.array([0.05] * 6 + [10.0])
    observed = np.arange(7) >= 3
    assert Shares(value, std, observed).likelier == pytest.approx(
        Shares(value[:-1], std[:-1], observed[:-1]).likelier, abs=0.3
    )
