"""The link within the slack of its gear: how long it flies, where it stands, what the motor gives for it."""

import numpy as np
import pytest

from residuum.mismatch.explain import Task, explain
from residuum.mismatch.slack import within_gap
from residuum.robots import load_robot
from residuum.virtual import Plant, effects, simulate
from residuum.virtual.motions import fourier

RATE, INERTIA, GAP = 20.0, 1.5, 0.002  # Nm/s, kg m^2, rad


def crossing(step=1e-4, sign=1.0):
    """A load that falls through zero at a steady rate, at t = 0.5 s."""
    time = np.arange(0.0, 1.0, step)
    load = -sign * RATE * (time - 0.5)
    return time, *within_gap(time, load, np.full(len(time), INERTIA), GAP)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_link_crosses_by_its_own_inertia(sign) -> None:
    """From rest under a load r t: way r t^3 / (6 M), so 2 gap after (12 gap M / r)^(1/3)."""
    time, place, rate = crossing(sign=sign)
    lasts = (12 * GAP * INERTIA / RATE) ** (1 / 3)
    flying = np.abs(place) < GAP * (1 - 1e-9)
    assert time[flying][-1] - 0.5 == pytest.approx(lasts, abs=5e-4)
    assert place[0] == -sign * GAP and place[-1] == sign * GAP
    middle = np.searchsorted(time, 0.5 + 0.6 * lasts)
    assert place[middle] == pytest.approx(sign * GAP * (2 * 0.6**3 - 1), abs=1e-5)
    assert rate[middle] == pytest.approx(sign * RATE * (0.6 * lasts) ** 2 / (2 * INERTIA), rel=1e-2)
    assert not rate[~flying].any()


def test_what_the_blow_gives_is_what_the_flight_lacked() -> None:
    time, _, rate = crossing()
    torque = np.gradient(INERTIA * rate, time)
    assert np.abs(np.trapezoid(torque, time)) < 1e-6
    assert torque.min() < -5 * torque.max()  # at once, against long


def test_a_load_that_turns_back_meets_the_old_flank() -> None:
    time = np.arange(0.0, 2.0, 1e-3)
    load = np.where((time > 0.5) & (time < 0.52), -1.0, 1.0)
    place, rate = within_gap(time, load, np.full(len(time), INERTIA), GAP)
    assert place[0] == place[-1] == -GAP
    assert place.max() > -GAP  # it left, and came back
    assert not rate[time > 0.6].any()


def test_a_link_without_inertia_and_a_load_of_nothing_end() -> None:
    time = np.arange(0.0, 1.0, 2e-3)
    noise = np.random.default_rng(1).standard_normal(len(time))
    for load in (np.zeros(len(time)), noise):
        place, rate = within_gap(time, load, np.full(len(time), -0.01), GAP)
        assert np.all(np.abs(place) <= GAP * (1 + 1e-9)) and np.all(np.isfinite(rate))


@pytest.mark.slow
def test_explain_names_the_slack_of_an_axis_without_gravity(tmp_path) -> None:
    """The virtual arm's slack is a gear with a dead zone, in MuJoCo's closed loop."""
    robot, digest = load_robot("ur5e")
    plant = Plant(backlash=(effects.Backlash(joint=1, gap=0.002, stiffness=2e4),))
    paths = []
    for seed in (1, 2):
        paths.append(tmp_path / f"{seed}.csv")
        simulate(robot, plant, fourier(robot, 40.0, seed), 125, seed).recording.write_csv(paths[-1])
    answer = explain(Task(tuple(paths), (), robot, digest, 6, propose=False, thresholds=False))
    found = [f for f in answer.findings["findings"] if f["effect"] == "backlash"]
    assert [f["joints"] for f in found] == [[1]]
    assert found[0]["parameters"]["gap"]["value"] == pytest.approx(0.002, rel=0.5)
    assert found[0]["parameters"]["gap"]["unit"] == "rad"
