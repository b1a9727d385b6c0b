"""The fast band: ripple is found in it, slow torque is not, and its noise is the samples' own."""

import numpy as np
import pytest

from residuum.mismatch.fast import fast_band, gram, noise

RATE, ORDER, CUTOFF = 500.0, 101.0, 15.0
TIME = np.arange(0, 20, 1 / RATE)


def band(torque, columns, qd=None, since=None):
    qd = np.full((len(TIME), 1), 0.8) if qd is None else qd
    since = np.full((len(TIME), 1), 5.0) if since is None else since
    return fast_band(TIME, torque[:, None], [c[:, None] for c in columns], qd, since, CUTOFF)


def ripples():
    angle = ORDER * 0.8 * TIME
    return np.cos(angle), np.sin(angle)


def test_ripple_is_found_beside_slow_torque_and_noise() -> None:
    rng, (a, b) = np.random.default_rng(1), ripples()
    torque = 0.3 * a - 0.2 * b + 20 * np.sin(0.7 * TIME) + 0.4 * rng.normal(size=len(TIME))
    found = band(torque, (a, b))
    g = gram(found, 0, (0.0, 20.0), noise([found], 0))
    size = np.linalg.solve(g[:2, :2], g[:2, 2])
    std = np.sqrt(np.diag(np.linalg.inv(g[:2, :2])))
    assert np.all(np.abs(size - [0.3, -0.2]) < 4 * std)
    assert std.max() < 0.02


def test_noise_is_that_of_the_samples() -> None:
    """White noise stays nearly white in the band: its density is that before the filter."""
    rng = np.random.default_rng(2)
    found = band(0.4 * rng.normal(size=len(TIME)), ripples())
    assert 0.1 < noise([found], 0) / 0.4**2 < 1.5


def test_reversals_and_creeping_say_nothing() -> None:
    since = np.where(TIME < 10, 0.05, 5.0)[:, None]
    qd = np.where(TIME < 15, 0.8, 0.01)[:, None]
    found = band(np.ones(len(TIME)), ripples(), qd, since)
    assert found.time[0].min() >= 10 and found.time[0].max() < 15


def test_spans_add_up() -> None:
    found = band(np.random.default_rng(3).normal(size=len(TIME)), ripples())
    parts = [gram(found, 0, (a, a + 5.0), 1.0) for a in (0.0, 5.0, 10.0, 15.0)]
    np.testing.assert_allclose(np.sum(parts, axis=0), gram(found, 0, (0.0, 20.0), 1.0), rtol=1e-6)


def test_too_few_samples_have_no_known_noise() -> None:
    found = band(np.zeros(len(TIME)), ripples(), qd=np.zeros((len(TIME), 1)))
    assert noise([found], 0) == pytest.approx(np.inf)
