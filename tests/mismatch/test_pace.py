"""Noise of speeds is in the torque's error and in columns of accelerations: it must not pass for physics."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from residuum.mismatch.evidence import Evidence, gather
from residuum.mismatch.judging import UNSEEN
from residuum.mismatch.naming import Scored, nuisance, ranked
from residuum.mismatch.pace import paceless

TIME = np.arange(0.0, 60.0, 0.008)
FRICTION = np.array([[6.5, 5.0], [7.0, 6.0], [5.5, 4.5]])


def noisy(arm, along, late: float = 0.0) -> Evidence:
    """Evidence from motion whose speeds have noise, and whose current has noise that remembers 0.25 s."""
    rng, memory = np.random.default_rng(3), np.exp(-0.008 / 0.25)
    recordings = []
    for run in range(3):
        then = TIME + 100.0 * run
        _, qd, _ = moved = along(then)
        white, slow = (0.5 * rng.standard_normal(qd.shape) for _ in range(2))
        noise = 0.6 * white + 0.5 * lfilter([np.sqrt(1 - memory**2)], [1, -memory], slow, axis=0)
        torque = arm.observer.inverse_dynamics(*moved) + FRICTION[:, 0] * np.sign(qd) + FRICTION[:, 1] * qd
        torque = np.stack([np.interp(then - late, then, x) for x in torque.T], axis=1)
        q, qd = (x + std * rng.standard_normal(x.shape) for x, std in zip(moved, (1e-5, 1e-3), strict=False))
        recordings.append(replace(arm.recording(then, torque + noise, q=q, qd=qd), name=f"run {run}"))
    return gather(recordings, [True] * 3, arm.model, arm.robot)


@pytest.fixture(scope="module")
def on_time(arm, along) -> Evidence:
    return noisy(arm, along)


def delay_of(evidence: Evidence) -> Scored:
    return next(
        s for s in ranked(evidence, nuisance(evidence), UNSEEN) if s.candidate.key == ("time_delay", None)
    )


def test_noise_of_speeds_is_no_delay(on_time) -> None:
    found = delay_of(on_time)
    assert found.evidence < 10.0
    assert abs(found.size[0]) < 4 * found.std[0]


def test_a_delay_has_its_size_at_every_pace(arm, along) -> None:
    evidence = noisy(arm, along, late=0.016)
    found = delay_of(evidence)
    assert found.size[0] == pytest.approx(0.016, abs=4 * found.std[0])
    assert paceless(evidence, nuisance(evidence), found) == ""


def test_what_only_fast_torques_show_is_refused(on_time) -> None:
    found = delay_of(on_time)
    claimed = replace(found, size=found.size + np.array([0.05, 0.0]))
    assert "% of its size in slow torques" in paceless(on_time, nuisance(on_time), claimed)
