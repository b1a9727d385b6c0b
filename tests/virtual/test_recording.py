"""Whole runs: the CSV, determinism, rates, errors, speed."""

import csv
import time
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline
from scipy.signal import butter, filtfilt

from residuum.errors import InputError
from residuum.robots import load_robot
from residuum.virtual import Motion, Plant, simulate
from residuum.virtual import effects as e
from residuum.virtual.motions import fourier, still

ROBOT, _ = load_robot("ur5e")
MOTION = fourier(ROBOT, 2.0, seed=2, period=6.0)
FIELDS = (
    "actual_q actual_qd actual_current target_q target_qd target_qdd target_current target_moment"
    " joint_temperatures actual_TCP_force"
)


def test_csv_has_rtde_names_and_the_numbers(tmp_path):
    recording = simulate(ROBOT, Plant(), MOTION).recording
    recording.write_csv(tmp_path / "run.csv")
    with (tmp_path / "run.csv").open() as file:
        header, *rows = csv.reader(file)
    assert header == ["timestamp", *[f"{name}_{k}" for name in FIELDS.split() for k in range(6)]]
    table = np.array(rows, dtype=float)
    assert table.shape == (1000, 61)
    np.testing.assert_allclose(table[:, 0], 0.002 * np.arange(1000), atol=1e-9)
    np.testing.assert_allclose(table[:, 13:19], recording["actual_current"], atol=1e-6)


def test_nothing_of_the_truth_is_in_the_csv(tmp_path):
    plant = Plant(payload=e.Payload(mass=1.2345, declared=False), outside=e.Outside())
    run = simulate(ROBOT, plant, MOTION)
    run.recording.write_csv(tmp_path / "run.csv")
    text = (tmp_path / "run.csv").read_text()
    assert not any(
        word in text.splitlines()[0] for word in ("friction", "external", "motor", "gear", "effect")
    )
    assert run.truth.effects["payload"]["mass"] == 1.2345


def test_cut_rows_are_cut(tmp_path):
    run = simulate(ROBOT, Plant(data_fault=e.DataFault(cut=(5, 999))), MOTION)
    run.recording.write_csv(tmp_path / "run.csv")
    lines = (tmp_path / "run.csv").read_text().splitlines()
    whole = lines[0].count(",")
    assert [k - 1 for k, line in enumerate(lines) if line.count(",") < whole] == [5, 999]


def test_same_seed_same_numbers_and_another_seed_others():
    runs = [simulate(ROBOT, Plant(), MOTION, seed=s).recording for s in (1, 1, 2)]
    for name in runs[0].fields:
        np.testing.assert_array_equal(runs[0][name], runs[1][name])
    assert np.std(runs[0]["actual_current"] - runs[2]["actual_current"]) > 0.01


def test_rate_125_takes_every_fourth_row():
    fast, slow = (simulate(ROBOT, Plant(), MOTION, rate=rate).recording for rate in (500, 125))
    np.testing.assert_array_equal(fast["actual_current"][::4], slow["actual_current"])


@pytest.mark.parametrize("rate", [0, 300, 1000, -5])
def test_impossible_rates_are_refused(rate):
    with pytest.raises(InputError, match="500 Hz divided by a whole number"):
        simulate(ROBOT, Plant(), MOTION, rate=rate)


def test_motion_must_fit_the_robot():
    with pytest.raises(InputError, match="motion has 3 joints, ur5e has 6"):
        simulate(ROBOT, Plant(), still((0.0,) * 3, 0.1))


def test_unwritable_file_is_one_line(tmp_path):
    with pytest.raises(InputError, match="cannot be written"):
        simulate(ROBOT, Plant(), still((0.0,) * 6, 0.01)).recording.write_csv(tmp_path / "none" / "run.csv")


@pytest.mark.parametrize("name", ["ur3e", "ur10e", "ur16e"])
def test_the_other_arms_run_too(name):
    robot, _ = load_robot(name)
    motion = fourier(robot, 2.0, seed=1, period=6.0, speed=1.0)
    recording = simulate(robot, Plant(), motion).recording
    assert np.abs(recording["target_q"] - recording["actual_q"]).max() < 2e-3


REAL = Path(__file__).resolve().parents[3] / "shared" / "recordings" / "ur10e" / "unloaded_03.csv"


@pytest.mark.skipif(not REAL.exists(), reason="the real recordings are not beside this checkout")
def test_a_virtual_ur10e_draws_the_currents_of_a_real_one():
    """The path of a public UR10e recording (Mamedov and Mikhel 2020), replayed."""
    table = np.genfromtxt(REAL, delimiter=",", names=True, invalid_raise=False)
    columns = {
        n: np.stack([table[f"{n}_{k}"] for k in range(6)], axis=1) for n in ("actual_q", "actual_current")
    }
    stamp = table["timestamp"] - table["timestamp"][0]
    path = make_interp_spline(stamp, columns["actual_q"])(np.arange(0, stamp[-1], 0.002))
    q = filtfilt(*butter(4, 8 / 250), path, axis=0)
    q[:50] = q[0]
    qd = np.gradient(q, 0.002, axis=0)
    motion = Motion(q, qd, np.gradient(qd, 0.002, axis=0))
    virtual = simulate(load_robot("ur10e")[0], Plant(), motion).recording
    for k in range(6):
        real = columns["actual_current"][:, k]
        ours = np.interp(stamp, virtual["timestamp"], virtual["actual_current"][:, k])
        assert np.corrcoef(real, ours)[0, 1] > 0.97
        assert 0.7 < np.std(real) / np.std(ours) < 1.4


@pytest.mark.slow
def test_speed_on_one_core():
    motion = fourier(ROBOT, 20.0, seed=1)
    start = time.process_time()
    simulate(ROBOT, Plant(), motion)
    assert 20.0 / (time.process_time() - start) > 12.0  # 25-30 on an idle machine
