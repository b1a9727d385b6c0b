"""Smoothed speeds: no delay, no noise at the sign, and derived where none were recorded."""

import numpy as np
import pytest

from residuum.mismatch.speed import smooth_speeds
from residuum.mismatch.track import BRISTLE, calm_speeds, moves
from residuum.recordings import Recording


def moved(
    rate: float, noise: float = 0.0, speed: bool = True, jitter: float = 0.0
) -> tuple[Recording, np.ndarray]:
    """A joint that swings at 1 Hz, and its true speed (T, 1)."""
    rng = np.random.default_rng(2)
    time = np.arange(0.0, 6.0, 1 / rate)
    time = time + jitter / rate * rng.uniform(-1, 1, len(time))
    q, qd = np.sin(2 * np.pi * time)[:, None], 2 * np.pi * np.cos(2 * np.pi * time)[:, None]
    recorded = qd + noise * rng.standard_normal(qd.shape)
    return Recording("swing", time, q, 0 * q, qd=recorded if speed else None), qd


@pytest.mark.parametrize("rate", [125.0, 500.0])
@pytest.mark.parametrize("speed", [True, False], ids=["recorded", "derived"])
@pytest.mark.parametrize("jitter", [0.0, 0.2])
def test_a_slow_swing_passes_whole_and_without_delay(rate, speed, jitter) -> None:
    recording, true = moved(rate, speed=speed, jitter=jitter)
    found = calm_speeds(recording)
    inside = slice(int(0.3 * rate), -int(0.3 * rate))
    assert np.abs(found - true)[inside].max() < 0.01 * np.abs(true).max()


def test_noise_is_taken_off() -> None:
    recording, true = moved(500.0, noise=0.01)
    error = (smooth_speeds(recording, 30.0) - true)[150:-150]
    assert error.std() < 0.45 * 0.01  # white noise over 30 of 250 Hz: sqrt(0.12) = 0.35


def test_nothing_is_carried_across_a_gap() -> None:
    time = np.r_[np.arange(0.0, 2.0, 0.008), np.arange(5.0, 7.0, 0.008)]
    speed = np.where(time < 3, 1.0, -1.0)[:, None]
    found = smooth_speeds(Recording("gap", time, 0 * speed, 0 * speed, qd=speed), 30.0)
    np.testing.assert_allclose(found, speed, atol=1e-9)


@pytest.mark.parametrize("rate", [125.0, 500.0])
def test_a_stop_that_bounces_is_a_rest_and_a_turn_is_none(rate) -> None:
    """A joint comes to rest at 1 s, springs back by a third of a bristle's travel, starts at 2 s and turns at 3 s."""
    time = np.arange(0.0, 4.0, 1 / rate)
    stop, start = np.minimum(time - 1.0, 0.0), np.maximum(time - 2.0, 0.0)
    bounce = BRISTLE / 3 * np.exp(-(((time - 1.1) / 0.02) ** 2))
    q = (-0.5 * stop**2 + start - 0.5 * start**2 + bounce)[:, None]
    found = moves(q, rate)[:, 0]
    assert not found[(time > 1.0) & (time < 1.95)].any()
    assert found[(time > 2.1) & (time < 4.0)].all()
    assert found[time < 0.9].all()
