"""Physics gains wherever it acts; what one damaged tooth lends it, it gains at that place alone."""

from dataclasses import replace

import numpy as np
import pytest

from residuum.mismatch.candidates import Candidate
from residuum.mismatch.local import Rowwise, concentrated, for_a_time, loud, of_one_joint
from residuum.mismatch.naming import Scored

N, NOISE = 4000, 1.0
Q = np.random.default_rng(1).uniform(-2, 2, N)


def told(true, fitted, seed: int = 2) -> str:
    """What is said of a hypothesis `fitted` to a torque `true` in noise of one Nm."""
    torque = true + NOISE * np.random.default_rng(seed).normal(size=N)
    change = fitted * (fitted @ torque) / (fitted @ fitted)
    return concentrated(Q, 0.5 * (torque**2 - (torque - change) ** 2), 0.5 * change**2)


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("size", [0.08, 0.3, 1.0])
def test_a_wave_over_the_angle_gains_everywhere(size, seed) -> None:
    assert told(size * np.cos(Q), np.cos(Q), seed=seed) == ""


def test_what_acts_at_one_place_may_gain_there() -> None:
    """As friction does at reversals that are always at the same angle."""
    here = np.exp(-0.5 * ((Q - 0.7) / 0.05) ** 2)
    assert told(here, here) == ""


@pytest.mark.parametrize("at", [-1.3, 0.0, 0.7])
def test_what_a_tooth_lends_to_a_wave_is_told_with_its_place(at) -> None:
    tooth = 3 * np.exp(-0.5 * ((Q - at) / 0.04) ** 2)
    said = told(tooth, np.cos(Q - at - 0.4))
    place = float(said.split(" is at ")[1].split()[0])
    assert place == pytest.approx(at, abs=0.11)


def rowwise(torque, change) -> Rowwise:
    """What a change of the fit (n, N) does to torques (n, N) in units of the noise they are taken to have."""
    gain, left = 0.5 * (torque**2 - (torque - change) ** 2), (torque - change) ** 2
    return Rowwise(np.array([0]), np.zeros_like(torque), gain, 0.5 * change**2, left)


@pytest.mark.parametrize("crackle", [1.0, 4.0])
def test_a_wave_of_as_many_nats_is_none_where_noise_is_loud_at_its_crests(crackle) -> None:
    """Of a size that its evidence calls sure: 4 times the noise there is a variance of 16."""
    wave, rng = np.where(np.abs(Q) < 0.3, 1.0, 0.05), np.random.default_rng(3)
    found = 0.4 * wave
    torque = found + rng.normal(size=N) * np.where(np.abs(Q) < 0.3, crackle, 1.0)
    rows = rowwise(torque[:, None], found[:, None])
    nats = float(rows.acts.sum())
    assert nats > 40
    assert rows.loudness == pytest.approx(crackle**2, rel=0.15)
    assert (loud(rows, nats) == "") == (crackle == 1.0)


@pytest.mark.parametrize(("late", "said"), [((1.0, 1.0, 1.0), False), ((3.0, 0.0, 0.0), True)])
def test_a_clock_is_as_late_for_one_joint_as_for_the_next(late, said) -> None:
    rng = np.random.default_rng(4)
    slope = rng.normal(size=(N, 3)) * [0.5, 0.2, 0.2]
    torque = slope * late + rng.normal(size=(N, 3))
    delay = float(np.sum(slope * torque) / np.sum(slope**2))
    test = Scored(Candidate("time_delay", None, (0, 1)), np.ones(4), 50.0, np.array([delay]), np.ones(1))
    why = of_one_joint(rowwise(torque, slope * delay), test)
    assert why.startswith("joints other than 1") if said else why == ""


@pytest.mark.parametrize("runs", [1, 3])
@pytest.mark.parametrize(("absent", "said"), [(0.0, False), (0.1, False), (0.5, True)])
def test_what_begins_within_recordings_was_not_there_before(absent, said, runs) -> None:
    """A tenth of the time is no reason, and neither is a recording as a whole."""
    there = np.where(np.arange(N) < absent * N, 0.0, 0.3)
    torque = np.tile(there, runs) + np.random.default_rng(5).normal(size=runs * N)
    change = np.full_like(torque, torque.mean())
    rows = replace(rowwise(torque[:, None], change[:, None]), starts=np.arange(runs) * N)
    assert bool(for_a_time(rows)) == said


def test_a_recording_without_it_is_none_in_which_it_begins() -> None:
    torque = np.concatenate([np.zeros(N), np.full(N, 0.3)]) + np.random.default_rng(6).normal(size=2 * N)
    rows = rowwise(torque[:, None], np.full((2 * N, 1), torque.mean()))
    assert for_a_time(rows)
    assert not for_a_time(replace(rows, starts=np.array([0, N])))
