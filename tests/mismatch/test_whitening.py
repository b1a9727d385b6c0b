"""Rows that remember, made independent: against the exact covariance of a process whose memory is known."""

import numpy as np
import pytest
from rows_by_hand import STEP, ar1, rows

from residuum.mismatch.grams import Scales, regime, roots, scales_of
from residuum.mismatch.whitening import FLOOR, ORDER, REST, ZERO, correlation_of, predictors, root

KEEP = 0.9


def known(order: int = 8):
    """The autocorrelation of a process of which each row keeps 0.9 of the one before, floor included."""
    found = KEEP ** np.arange(order + 1.0)
    found[0] += FLOOR
    return found


def dense(correlation, count: int):
    """Covariance (count, count) of rows of such an autocorrelation, as long as it is no longer than its order."""
    lag = np.abs(np.subtract.outer(np.arange(count), np.arange(count)))
    return correlation[lag]


def test_rows_within_the_order_are_whitened_exactly() -> None:
    n, sigma = 9, np.linspace(0.5, 2.0, 9)
    found = root(STEP * np.arange(n), sigma, np.zeros(n, int), known(), STEP).toarray()
    covariance = sigma[:, None] * dense(known(), n) * sigma
    np.testing.assert_allclose(found @ covariance @ found.T, np.eye(n), atol=1e-12)


def test_nothing_is_predicted_over_a_gap_or_a_rest() -> None:
    time = STEP * np.arange(12.0)
    time[6:] += 5 * STEP
    kind = np.zeros(12, int)
    kind[9:11] = REST
    found = root(time, np.ones(12), kind, known(), STEP).toarray()
    assert not found[6:, :6].any()  # the gap
    assert not found[9:11, :9].any() and not found[11, :11].any()
    assert found[9, 9] ** 2 + found[10, 10] ** 2 == pytest.approx(1.0)  # a rest counts once


def test_motion_goes_on_after_a_passage_as_it_was_before() -> None:
    """Its first row is predicted from the last one before, and no row from the passage, whose error is its own."""
    kind = np.zeros(12, int)
    kind[5:8] = ZERO
    found = root(STEP * np.arange(12.0), np.ones(12), kind, known(), STEP).toarray()
    part = KEEP**4 / (1 + FLOOR)
    assert not found[8:, 5:8].any() and not found[5:8, :5].any()
    assert not found[9:, :8].any()
    assert found[8, 4] / found[8, 8] == pytest.approx(-part)
    assert found[8, 8] == pytest.approx(1 / np.sqrt((1 + FLOOR) * (1 - part**2)))


def test_prediction_of_one_row_is_its_correlation() -> None:
    table, rms = predictors(known(1))
    part = KEEP / (1 + FLOOR)
    assert table[1, 0] == pytest.approx(part)
    assert rms == pytest.approx([np.sqrt(1 + FLOOR), np.sqrt((1 + FLOOR) * (1 - part**2))])


def test_slow_noise_says_much_about_what_is_fast_and_little_about_what_is_as_slow() -> None:
    """An offset's information is that of 1 - keep over 1 + keep as many rows, and what alternates has more."""
    n = 4000
    which = rows(n, 1)
    scales = scales_of([which], [ar1(n, KEEP, np.random.default_rng(2), joints=1)])
    (whiten,) = roots(which, scales)
    slow, fast = np.ones(n), np.where(np.arange(n) % 2, 1.0, -1.0)
    told = [float(np.sum((whiten @ x) ** 2)) / n for x in (slow, fast)]
    assert told[0] == pytest.approx((1 - KEEP) / (1 + KEEP), rel=0.35)
    assert told[1] > 5.0


def test_sizes_have_the_spread_that_their_information_says() -> None:
    """A hundred draws of noise: coefficients of a wave over their standard deviations have unit variance."""
    n, rng = 2000, np.random.default_rng(3)
    which, wave = rows(n, 1), np.sin(np.arange(n) / 25)
    found = []
    for _ in range(100):
        noise = ar1(n, KEEP, rng, joints=1)
        (whiten,) = roots(which, scales_of([which], [noise]))
        column, error = whiten @ wave, whiten @ noise[:, 0]
        found.append(column @ error / np.sqrt(column @ column))
    assert np.std(found) == pytest.approx(1.0, abs=0.2)


def test_few_rows_tell_no_long_memory() -> None:
    noise = ar1(120, KEEP, np.random.default_rng(4), joints=1)[:, 0]
    assert len(correlation_of([noise])) - 1 < ORDER
    assert len(correlation_of([np.zeros(5)])) == 1


def test_without_a_correlation_memory_is_spread_evenly() -> None:
    which = rows(50, 1)
    scales = Scales(np.array([[0.5, 1.0, 2.0]]), np.array([4.0]), np.array([np.inf]))
    (found,) = roots(which, scales)
    assert not regime(which).any()
    np.testing.assert_allclose(found.toarray(), np.eye(50) / (0.5 * 2.0))
