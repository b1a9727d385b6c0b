"""Thresholds: the false-alarm rate seen on further collision-free hours is the one asked for."""

import numpy as np
import pytest
from scipy.stats import genpareto

from residuum.identify.thresholds import Residual, _exceeded, _pareto, _peaks, fit_thresholds


def hours_of(rng, hours: float, growth: float = 0.6, memory: float = 0.4, rate: float = 10.0):
    """Residuals of an AR(1) process whose size grows with speed, as Coulomb and viscous errors do."""
    from scipy.signal import lfilter

    count = round(hours * 3600 * rate)
    time = np.arange(count) / rate
    speed = np.abs(1.2 * np.sin(0.8 * time + rng.uniform(0, 6)))[:, None] * np.ones(6)
    keep = np.exp(-1 / rate / memory)
    noise = rng.normal(size=(count, 6)) * np.sqrt(1 - keep**2)
    return Residual(time, np.abs(lfilter([1.0], [1.0, -keep], noise, axis=0)) * (1 + growth * speed), speed)


def alarms(residual, thresholds, joint: int) -> int:
    limit = (
        np.array(thresholds.static)[joint] + np.array(thresholds.per_speed)[joint] * residual.speed[:, joint]
    )
    return len(_peaks(residual.time, residual.size[:, joint] / limit, 1.0))


@pytest.mark.parametrize("per_hour", [2.0, 6.0])
def test_false_alarms_come_at_the_asked_rate(per_hour, capsys):
    rng = np.random.default_rng(3)
    fitted = fit_thresholds([hours_of(rng, 2.0)], per_hour, np.ones(6), "one")
    test = hours_of(rng, 60.0)
    seen = np.array([alarms(test, fitted, j) for j in range(6)]) / 60.0
    with capsys.disabled():
        print(f"\nasked {per_hour}/h, seen {np.round(seen, 2)} /h by joint, mean {seen.mean():.2f}")
    assert per_hour / 2 < seen.mean() < 2 * per_hour
    assert ((seen > per_hour / 2) & (seen < 2 * per_hour)).mean() >= 0.8


def test_static_limits_hold_the_rate_too():
    rng = np.random.default_rng(4)
    fitted = fit_thresholds([hours_of(rng, 2.0)], 4.0, np.ones(6), "one")
    test = hours_of(rng, 40.0)
    limits = np.array(fitted.static_only)
    seen = np.mean([len(_peaks(test.time, test.size[:, j], limits[j])) for j in range(6)]) / 40.0
    assert 2.0 < seen < 8.0


def test_too_little_data_is_said_with_its_factor():
    fitted = fit_thresholds([hours_of(np.random.default_rng(1), 0.1)], 1.0, np.ones(6), "one")
    assert "extrapolated 10 times" in fitted.source
    assert "1 h" in fitted.source
    long = fit_thresholds([hours_of(np.random.default_rng(1), 2.0)], 1.0, np.ones(6), "one")
    assert "extrapolated" not in long.source


def test_speed_dependence_is_found_and_absent_where_there_is_none():
    rng = np.random.default_rng(2)
    found = fit_thresholds([hours_of(rng, 1.0, growth=1.0)], 6.0, np.ones(6), "one")
    np.testing.assert_allclose(np.array(found.per_speed) / np.array(found.static), 1.0, rtol=0.35)
    none = fit_thresholds([hours_of(rng, 1.0, growth=0.0)], 6.0, np.ones(6), "one")
    assert (np.array(none.per_speed) / np.array(none.static) < 0.15).all()


def test_stated_deviation_is_that_of_repeated_fits():
    rng = np.random.default_rng(7)
    fits = [fit_thresholds([hours_of(rng, 1.0)], 2.0, np.ones(6), "one") for _ in range(12)]
    scatter = np.std([f.static for f in fits], axis=0).mean()
    stated = np.mean([f.std for f in fits])
    assert 0.5 < stated / scatter < 2.0


@pytest.mark.parametrize("shape", [-0.08, 0.0, 0.2])
def test_the_law_agrees_with_scipy(shape):
    assert _exceeded(0.01, shape, 2.0) == pytest.approx(
        float(genpareto.isf(0.01, shape, scale=2.0)), rel=1e-6
    )
    drawn = np.sort(genpareto.rvs(shape, scale=2.0, size=20_000, random_state=1))
    found = _pareto(drawn)
    assert found[0] == pytest.approx(shape, abs=0.04)
    assert found[1] == pytest.approx(2.0, rel=0.05)
