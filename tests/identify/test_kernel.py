"""The filter in continuous time: SciPy's on a uniform grid, the analytic gain on jittered samples."""

import numpy as np
import pytest
from scipy import signal

from residuum.identify.kernel import Filter, Kernel, segments


@pytest.mark.parametrize("zero_phase", [True, False])
def test_it_is_the_butterworth_filter(zero_phase):
    rng = np.random.default_rng(0)
    time = np.arange(2500) * 0.002
    x = np.cumsum(rng.normal(size=2500))
    sos = signal.butter(4, 10, fs=500, output="sos")
    right = (
        signal.sosfiltfilt(sos, x)
        if zero_phase
        else signal.sosfilt(sos, x, zi=signal.sosfilt_zi(sos) * x[0])[0]
    )
    keep = slice(500, 2000, 25)
    (smooth,) = Filter(Kernel(10.0, 4, zero_phase)).weights(time, time[keep], (0,))
    assert np.abs(smooth @ x - right[keep]).max() < 2e-3 * np.ptp(x)


@pytest.mark.parametrize("frequency", [0.5, 1.0, 3.0])
def test_jittered_samples_see_the_analytic_gain(frequency):
    """94 Hz with 2-34 ms steps, as the real logs: gain and derivative within a percent."""
    rng = np.random.default_rng(1)
    time = np.cumsum(np.clip(rng.normal(0.0106, 0.0015, 900), 0.002, 0.034))
    at = np.arange(2.0, 7.0, 0.05)
    w = 2 * np.pi * frequency
    gain = 1 / (1 + (frequency / 10) ** 8)
    smooth, slope = Filter(Kernel(10.0)).weights(time, at)
    wave, right = np.exp(1j * w * time), gain * np.exp(1j * w * at)
    assert np.abs(smooth @ wave - right).max() < 0.01
    assert np.abs(slope @ wave / (1j * w) - right).max() < 0.03


@pytest.mark.parametrize("zero_phase", [True, False])
def test_polynomials_are_exact_whatever_the_jitter(zero_phase):
    rng = np.random.default_rng(2)
    time = np.cumsum(rng.uniform(0.002, 0.034, 400))
    at = np.array([2.0, 3.0, 4.0])
    smooth, slope = Filter(Kernel(10.0, 4, zero_phase)).weights(time, at)
    np.testing.assert_allclose(smooth @ np.ones(400), 1.0, atol=1e-12)
    np.testing.assert_allclose(slope @ np.ones(400), 0.0, atol=1e-9)
    np.testing.assert_allclose(slope @ (3 * time), 3.0, atol=1e-9)


def test_segments_stop_at_gaps():
    assert segments(np.array([0.0, 0.1, 0.2, 5.0, 5.1]), 0.5) == [slice(0, 3), slice(3, 5)]
