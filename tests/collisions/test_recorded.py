"""Contacts on recordings: the sensor's foot on made-up counts, and the real UR10's where they are at hand."""

import numpy as np
import pytest

from residuum.collisions.recorded import evaluate, onset, past_slope, sensor, table
from residuum.errors import InputError


@pytest.fixture
def time():
    return np.arange(0.0, 11.0, 0.011)


@pytest.mark.parametrize("ramp", [0.02, 0.2])
def test_onset_is_the_foot_of_the_drop(time, ramp) -> None:
    noise = np.random.default_rng(0)
    drift = 1.6e7 + 3000.0 * time + 8000.0 * np.sin(0.3 * time)
    counts = (
        drift - 4.0e4 * np.clip((time - 8.0) / ramp, 0.0, 1.0) + 2000.0 * noise.standard_normal(len(time))
    )
    found = time[onset(time, counts)]
    assert -0.012 < found - 8.0 < 0.012 + 0.3 * ramp


def test_no_contact_is_said(time) -> None:
    counts = np.random.default_rng(1).standard_normal(len(time))
    with pytest.raises(InputError, match="contact"):
        onset(time, counts)


def test_the_slope_of_a_line_is_exact_at_any_jitter() -> None:
    time = np.cumsum(np.random.default_rng(2).uniform(0.002, 0.02, 50))
    q = np.stack([0.07 * time + 1.0, -0.3 * time], axis=1)
    assert past_slope(time, q) == pytest.approx(np.tile([0.07, -0.3], (50, 1)))


def test_what_is_missing_is_named(tmp_path) -> None:
    file = tmp_path / "free.csv"
    file.write_text("timestamp,actual_q_0,actual_current_0\n0,0,0\n")
    assert sensor(file) is None
    with pytest.raises(InputError, match="found 1 free ones and 0 with contact_sensor_counts"):
        evaluate([file])


@pytest.mark.slow
def test_real_contacts_are_found_by_the_extremes_of_free_motion(real_recordings) -> None:
    results = evaluate(sorted((real_recordings / "ur10_collisions").glob("*.csv")))
    hits = [r for r in results if not np.isnan(r.onset)]
    assert len(hits) == 8 and len(results) == 14
    assert sum(not np.isnan(r.delays["extremes"]) for r in hits) == 8
    assert "8 contacts" in table(results)
