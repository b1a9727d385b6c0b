"""Smoothed speeds: no delay, no noise at the sign, and derived where none were recorded."""

import numpy as np
import pytest

from residuum.mismatch.speed import calm_speeds
from residuum.mismatch.track import BRISTLE, moves
from residuum.recordings import Recording


def moved(
    rate: float, noise: float = 0.0, speed: bool = True, jitter: float = 0.0, stamps: float = 0.0,
    angle: float = 0.0, swings: float = 1.0,
) -> tuple[Recording, np.ndarray]:  # fmt: skip
    """A joint that swings (1 Hz), and its true speed (T, 1).

    noise, angle: of speed and angle, rad/s and rad; stamps: error of the recorded times, s.
    """
    rng, way = np.random.default_rng(2), 2 * np.pi * swings
    time = np.arange(0.0, 6.0, 1 / rate)
    time = time + jitter / rate * rng.uniform(-1, 1, len(time))
    q, qd = np.sin(way * time)[:, None], way * np.cos(way * time)[:, None]
    recorded = qd + noise * rng.standard_normal(qd.shape)
    q = q + angle * rng.standard_normal(q.shape)
    stamped = time + stamps * rng.uniform(-1, 1, len(time))
    return Recording("swing", stamped, q, 0 * q, qd=recorded if speed else None), qd


@pytest.mark.parametrize("rate", [125.0, 500.0])
@pytest.mark.parametrize("speed", [True, False], ids=["recorded", "derived"])
@pytest.mark.parametrize("jitter", [0.0, 0.2])
def test_a_slow_swing_passes_whole_and_without_delay(rate, speed, jitter) -> None:
    recording, true = moved(rate, speed=speed, jitter=jitter)
    found = calm_speeds(recording)
    inside = slice(int(0.3 * rate), -int(0.3 * rate))
    assert np.abs(found - true)[inside].max() < 0.01 * np.abs(true).max()


def left(recording: Recording, true: np.ndarray) -> float:
    """Standard deviation of what smoothed speeds are off, rad/s."""
    return float((calm_speeds(recording) - true)[150:-150].std())


def test_noise_is_taken_off() -> None:
    """Of angles that say nothing: white noise over 30 of 250 Hz leaves sqrt(0.12) = 0.35."""
    assert left(*moved(500.0, noise=0.01, angle=0.1)) < 0.45 * 0.01


@pytest.mark.parametrize("rate", [125.0, 500.0])
def test_angles_and_speeds_know_it_better_together(rate) -> None:
    """Of angles whose slope is as noisy as the speeds at 10 Hz, and of nearly exact ones."""
    alone = left(*moved(rate, noise=2e-3, angle=1.0, swings=0.2))
    both, exact = (left(*moved(rate, noise=2e-3, angle=a, swings=0.2)) for a in (3e-5, 1e-6))
    assert exact < both < 0.8 * alone


def test_angles_alone_know_it_worse_than_with_speeds() -> None:
    both, derived = (left(*moved(500.0, noise=2e-3, angle=3e-5, swings=0.2, speed=x)) for x in (True, False))
    assert both < 0.5 * derived


def test_imprecise_stamps_are_noise_of_the_angles() -> None:
    """Of 0.5 ms: a slope is off by much and a speed by little, which is as good alone."""
    alone, both = (left(*moved(125.0, noise=2e-3, stamps=5e-4, angle=a, swings=0.2)) for a in (1.0, 0.0))
    assert both < 1.1 * alone


def test_nothing_is_carried_across_a_gap() -> None:
    time = np.r_[np.arange(0.0, 2.0, 0.008), np.arange(5.0, 7.0, 0.008)]
    speed = np.where(time < 3, 1.0, -1.0)[:, None]
    found = calm_speeds(Recording("gap", time, -np.abs(time[:, None] - 3.0), 0 * speed, qd=speed))
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
