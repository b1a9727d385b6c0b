"""Noise, memory, weights and folds on synthetic rows."""

from dataclasses import replace

import numpy as np
import pytest
from rows_by_hand import ar1, rows, small_space

from residuum.mismatch.grams import (
    Scales,
    blocks,
    equal_scales,
    folds_of,
    regime,
    roots,
    scales_of,
    weights,
    whole,
)

LONG = 6000


@pytest.mark.parametrize(("keep", "low", "high"), [(0.0, 1.0, 2.0), (0.8, 6.0, 13.0), (0.95, 25.0, 60.0)])
def test_memory_of_noise(keep, low, high) -> None:
    """1 + 2 sum of keep^k: 1, 9, 39."""
    noise = ar1(LONG, keep, np.random.default_rng(4))
    found = scales_of([rows(LONG)], [2.0 * noise])
    assert np.all((found.inflation >= low) & (found.inflation <= high))
    np.testing.assert_allclose(found.sigma[:, 0], 2.0, rtol=0.15)


def test_outliers_do_not_set_the_scale() -> None:
    noise = ar1(LONG, 0.0, np.random.default_rng(5))
    noise[::100] = 50.0
    assert scales_of([rows(LONG)], [noise]).sigma[0, 0] == pytest.approx(1.0, rel=0.1)


def test_rest_and_reversals_count_as_no_surer_than_motion() -> None:
    moving, sliding = np.ones((LONG, 2)), np.ones((LONG, 2))
    moving[:2000], sliding[2000:4000] = 0.0, 0.7
    which = rows(LONG, moving=moving, sliding=sliding)
    noise = ar1(LONG, 0.0, np.random.default_rng(6))
    noise[2000:4000] *= 0.2
    found = scales_of([which], [noise])
    assert np.all(found.sigma[:, 1] >= found.sigma[:, 0])
    assert np.all(found.sigma[:, 2] >= 3 * found.sigma[:, 0])


def test_regimes_reach_two_rows_beyond_what_is_mixed() -> None:
    moving, sliding = np.ones((24, 1)), np.ones((24, 1))
    moving[5], sliding[5], sliding[13], moving[20] = 0.9, 0.9, 0.9, 0.96
    found = regime(rows(24, 1, moving=moving, sliding=sliding))
    assert found[:, 0].tolist() == [0] * 3 + [2] * 5 + [0] * 3 + [1] * 5 + [0] * 8


def test_long_tails_at_zero_speed_are_noise_there() -> None:
    sliding, noise = np.ones((LONG, 2)), ar1(LONG, 0.0, np.random.default_rng(8))
    sliding[:2000] = 0.5
    noise[:2000:20] = 20.0
    found = scales_of([rows(LONG, sliding=sliding)], [noise]).sigma
    assert np.all(found[:, 1] == pytest.approx(np.sqrt(0.95 + 0.05 * 400), rel=0.05))


def test_a_rest_counts_once_however_long_it_is() -> None:
    moving = np.ones((400, 1))
    moving[52:148] = moving[202:388] = 0.0  # and two rows to each side
    scales = Scales(np.array([[0.5, 1.0, 2.0]]), np.array([4.0]), np.array([np.inf]))
    found = weights(rows(400, 1, moving=moving), scales)[:, 0]
    assert found[50:150].sum() == pytest.approx(1 / 2.0**2)
    assert found[200:390].sum() == pytest.approx(1 / 2.0**2)
    np.testing.assert_allclose(found[:50], 1 / (0.5**2 * 4.0))
    assert sum(r.count_nonzero() for r in roots(rows(400, 1, moving=moving), scales)) == 400


def test_a_passage_through_zero_counts_once_however_long_the_memory() -> None:
    sliding = np.ones((400, 1))
    for start in (60, 200, 300):
        sliding[start + 2 : start + 3] = 0.5  # and two rows to each side
    scales = Scales(np.array([[0.5, 1.0, 2.0]]), np.array([20.0]), np.array([np.inf]))
    found = weights(rows(400, 1, sliding=sliding), scales)[:, 0]
    assert found[200:205].sum() == pytest.approx(1 / 1.0**2)
    short = Scales(scales.sigma, np.array([2.0]), scales.fast)
    assert weights(rows(400, 1, sliding=sliding), short)[200:205, 0].sum() == pytest.approx(5 / 2)


def test_blocks_cover_every_row_once_and_keep_sides_apart() -> None:
    runs, sides = [rows(n) for n in (3000, 1900, 40, 2500)], [True, True, True, False]
    for side in (True, False):
        for r, seen in enumerate(sides):
            parts = [p for run, p in blocks(runs, sides, side) if run == r]
            rows_in = np.concatenate([np.arange(len(runs[r]))[p] for p in parts]) if parts else np.empty(0)
            assert rows_in.tolist() == (list(range(len(runs[r]))) if seen == side else [])


def test_folds_sum_to_the_whole_and_do_not_grow_in_number() -> None:
    space, rng = small_space(), np.random.default_rng(7)
    columns = tuple(rng.normal(size=(90_000, len(ix))) for ix in space.indices)
    long = replace(rows(90_000), columns=columns, torque=rng.normal(size=(90_000, 2)))
    folds = folds_of([long], [True], equal_scales(2), space)
    assert len(folds) <= 20
    total = np.sum([whole(f.grams, space) for f in folds], axis=0)
    stacked = np.zeros((180_000, space.size + 1))
    for j, ix in enumerate(space.indices):
        stacked[j * 90_000 : (j + 1) * 90_000, ix] = columns[j]
        stacked[j * 90_000 : (j + 1) * 90_000, -1] = long.torque[:, j]
    np.testing.assert_allclose(total, stacked.T @ stacked, rtol=1e-9, atol=1e-6)
