"""One experiment: it is the same twice, forces and impulses are those of the obstacle, strategies differ."""

import numpy as np
import pytest

from residuum.collisions.campaign import at_thesis_delays, beyond, closed
from residuum.collisions.cells import TOUCH, Cell, scene, thesis_cells
from residuum.collisions.published import DELAY, MEAN_DELAY, UR_DELAY, UR_MEAN_DELAY
from residuum.collisions.run import AtTime, Closed, Watch, drive, measure
from residuum.virtual.server.kinematics import Kinematics

SLOW = Cell(1, "slow")


@pytest.fixture(scope="module")
def runs(robot, seen):
    return {s: closed(robot, SLOW, s, seen, "thesis") for s in (1, 2, 3)}


def test_published_means_are_those_of_the_cells() -> None:
    for pace, mean in MEAN_DELAY.items():
        assert np.mean([DELAY[j, pace] for j in (1, 2, 3)]) == pytest.approx(mean, abs=0.5)
        for k in (0, 1):
            assert np.mean([UR_DELAY[j, pace][k] for j in (1, 2, 3)]) == pytest.approx(
                UR_MEAN_DELAY[pace][k], abs=0.5
            )


@pytest.mark.parametrize("joint", range(1, 7))
@pytest.mark.parametrize("obstacle", ["foam", "clamped", "soft"])
def test_the_face_stands_square_in_the_way(robot, joint, obstacle) -> None:
    cell = Cell(joint, "fast", obstacle)
    here = scene(robot, cell)
    kinematics, tool = Kinematics(robot), np.eye(4)
    tool[:3, 3] = TOUCH
    place, normal = np.array(here.obstacle.place), np.array(here.obstacle.normal)
    assert normal @ (kinematics.forward(here.start, tool)[:3, 3] - place) > 0.0, "the arm begins outside"
    assert 0.03 < here.tool_speed < 0.6
    assert here.speeds[joint - 1] == cell.speed and np.count_nonzero(here.speeds) == 1


def test_ninety_runs() -> None:
    assert 3 * len(thesis_cells(5)) == 90


def test_detected_after_contact_and_soon(runs) -> None:
    for row, trace in runs.values():
        assert not row.figures.early
        assert 0.0 < row.figures.delay < 0.5e-3 * MEAN_DELAY["slow"]
        assert row.figures.joint == 1
        assert row.figures.peak >= row.tool_force > 0.0
        assert trace.alarm is not None and trace.alarm.direction == -1.0, "the foam pushes joint 1 back"


def test_stopping_is_fastest_and_costs_most(runs) -> None:
    figures = {s: row.figures for s, (row, _) in runs.items()}
    assert figures[1].stop_time < figures[2].stop_time < figures[3].stop_time
    assert figures[1].impulse > max(figures[2].impulse, figures[3].impulse)


def test_the_force_is_that_of_the_stated_foam(robot, runs) -> None:
    _, trace = runs[1]
    held = trace.force[-50:].mean()
    here = scene(robot, SLOW)
    kinematics, tool = Kinematics(robot), np.eye(4)
    tool[:3, 3] = TOUCH
    point = kinematics.forward(trace.fields["actual_q"][-1], tool)[:3, 3]
    depth = np.array(here.obstacle.normal) @ (np.array(here.obstacle.place) - point)
    assert held == pytest.approx(here.obstacle.stiffness * depth, rel=0.02)


def test_a_repeat_at_the_known_time_is_the_closed_loop(robot, seen, runs) -> None:
    _, trace = runs[2]
    again = drive(robot, SLOW, 2, AtTime(trace.alarm))
    assert measure(again) == measure(trace)
    assert np.array_equal(again.fields["actual_current"], trace.fields["actual_current"])


def test_seeds_differ(robot, seen) -> None:
    one = drive(robot, SLOW, None, Closed(Watch(seen, ("thesis",))), 0.05)
    two = drive(robot, Cell(1, "slow", seed=1), None, Closed(Watch(seen, ("thesis",))), 0.05)
    assert not np.array_equal(one.fields["actual_q"][0], two.fields["actual_q"][0])
    assert not np.array_equal(one.fields["actual_current"][:500], two.fields["actual_current"][:500])


def test_the_thesis_delays_are_kept(robot) -> None:
    (task, *_rest) = at_thesis_delays(robot, [SLOW])
    row, _ = task()
    assert row.figures.delay == pytest.approx(1e-3 * DELAY[1, "slow"], abs=1e-6)


@pytest.mark.slow
def test_beyond_has_a_row_for_every_detector_and_ur(robot, seen) -> None:
    rows = beyond(robot, Cell(4, "fast", "clamped"), (seen,))
    by = {row.detector: row.figures for row in rows}
    assert {
        "thesis",
        "static",
        "speed",
        "cusum",
        "vote",
        "current",
        "velocity",
        "ur-least",
        "ur-most",
    } <= set(by)
    assert by["ur-least"].delay == pytest.approx(0.229, abs=2e-3), "joint 4 gets the mean of 1 to 3"
    assert by["static"].peak < by["ur-most"].peak
