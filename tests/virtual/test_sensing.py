"""Sensors: noise as stated, resolution, delay, and no difference between one block and row by row."""

import numpy as np
import pytest

from residuum.errors import InputError
from residuum.robots import load_robot
from residuum.virtual import NOISELESS, Plant, Position, Simulator, simulate
from residuum.virtual import effects as e
from residuum.virtual.motions import fourier, still

ROBOT, _ = load_robot("ur5e")
POSE = (0.3, -1.2, 1.4, -1.5, -1.4, 0.3)
MOTION = fourier(ROBOT, 3.0, seed=2, period=6.0)


def test_noise_at_rest_is_what_the_plant_states():
    recording = simulate(ROBOT, Plant(), still(POSE, 4.0), seed=3).recording
    noise = recording["actual_current"][500:].std(0)
    np.testing.assert_allclose(noise, Plant().sensing.current_noise, rtol=0.1)
    assert np.abs(recording["actual_qd"]).max() == 0.0
    assert recording["actual_TCP_force"][:, :3].std() == pytest.approx(0.15, rel=0.1)


def test_resolution():
    recording = simulate(ROBOT, Plant(), MOTION).recording
    for name, step in (("actual_q", 1.1984225e-5), ("actual_current", 1e-3), ("joint_temperatures", 0.0625)):
        counts = recording[name] / step
        np.testing.assert_allclose(counts, np.round(counts), atol=1e-6)


def test_noise_is_white():
    current = simulate(ROBOT, Plant(), still(POSE, 8.0), seed=5).recording["actual_current"][1000:, 0]
    current = current - current.mean()
    assert abs((current[1:] * current[:-1]).mean() / current.var()) < 0.06


@pytest.mark.parametrize("delay", [0.008, 0.013])
def test_delay_by_cross_correlation(delay):
    late = e.TimeDelay(delay=delay, channels="current")
    runs = [simulate(ROBOT, Plant(sensing=NOISELESS, time_delay=d), MOTION).recording for d in ((), (late,))]
    on_time, delayed = (run["actual_current"][:, 1] for run in runs)
    time = MOTION.time
    errors = [rms(np.interp(time - d, time, on_time) - delayed) for d in np.arange(0, 0.02, 0.0005)]
    assert np.argmin(errors) * 0.0005 == pytest.approx(delay, abs=1e-6)
    np.testing.assert_array_equal(runs[0]["actual_q"], runs[1]["actual_q"])


def rms(values):
    return np.sqrt(np.mean(np.square(values)))


def test_delay_of_all_on_one_joint():
    late = e.TimeDelay(delay=0.01, channels="all", joints=(3,))
    runs = [simulate(ROBOT, Plant(sensing=NOISELESS, time_delay=d), MOTION).recording for d in ((), (late,))]
    for name in ("actual_q", "actual_qd", "actual_current"):
        np.testing.assert_allclose(runs[1][name][5:, 2], runs[0][name][:-5, 2], atol=1e-12)
        np.testing.assert_array_equal(np.delete(runs[0][name], 2, 1), np.delete(runs[1][name], 2, 1))
    np.testing.assert_array_equal(runs[0]["target_q"], runs[1]["target_q"])


def test_row_by_row_is_the_same_as_in_one_block():
    plant = Plant(time_delay=(e.TimeDelay(delay=0.013),), payload=e.Payload(mass=1.0))
    run = simulate(ROBOT, plant, MOTION, seed=7)
    simulator = Simulator(ROBOT, plant, MOTION.q[0], seed=7)
    for k in range(200):
        state = simulator.step(Position(*(tuple(x[k].tolist()) for x in (MOTION.q, MOTION.qd, MOTION.qdd))))
        assert state.time == run.recording["timestamp"][k]
        for name, values in state.rtde.items():
            np.testing.assert_allclose(values, run.recording[name][k], atol=1e-9, err_msg=name)


def test_lost_rows_keep_true_stamps():
    fault = e.DataFault(late=0.004, gaps=((1.0, 1.3),))
    run = simulate(ROBOT, Plant(sensing=NOISELESS, data_fault=fault), MOTION, rate=125)
    time = run.recording["timestamp"]
    steps = np.diff(time)
    assert steps.max() > 0.3 and len(np.unique(steps.round(3))) > 4
    assert not np.any((time >= 1.0) & (time < 1.3))
    np.testing.assert_allclose(run.recording["target_q"], MOTION.q[np.round(time / 0.002).astype(int)])


def test_stuck_and_absurd_values():
    stuck = e.StuckChannel(column="actual_current_2", start=1.0, end=2.0)
    fault = e.DataFault(stuck=(stuck,), absurd=(10,), stamp_noise=1e-4)
    clean, spoiled = (
        simulate(ROBOT, Plant(data_fault=f), MOTION, seed=2).recording.fields for f in (None, fault)
    )
    rows = slice(500, 1000)
    assert np.ptp(spoiled["actual_current"][rows, 2]) == 0.0
    np.testing.assert_array_equal(spoiled["actual_current"][500:, :2], clean["actual_current"][500:, :2])
    np.testing.assert_array_equal(spoiled["actual_current"][1000:], clean["actual_current"][1000:])
    assert max(np.abs(spoiled[n][10]).max() for n in ("actual_q", "actual_qd", "actual_current")) > 1e100
    assert np.std(spoiled["timestamp"] - clean["timestamp"]) == pytest.approx(1e-4, rel=0.1)


def test_stuck_column_must_exist():
    fault = e.DataFault(stuck=(e.StuckChannel(column="actual_current_9", start=0.0, end=1.0),))
    with pytest.raises(InputError, match="no column actual_current_9"):
        simulate(ROBOT, Plant(data_fault=fault), still(POSE, 0.01))
