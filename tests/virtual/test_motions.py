"""Motions: derivatives that belong together, limits, the table, seeds."""

import numpy as np
import pytest

from residuum.robots import load_robot
from residuum.virtual import Plant, Simulator
from residuum.virtual import motions as m

ROBOT, _ = load_robot("ur5e")
POSE = (0.0, -1.2, 1.4, -1.5, -1.4, 0.3)
ALL = {
    "fourier": lambda: m.fourier(ROBOT, 12.0, seed=3),
    "point_to_point": lambda: m.point_to_point(m.random_poses(ROBOT, 4, seed=1), 0.5),
    "still_poses": lambda: m.still_poses(ROBOT, 3, 1.0),
    "sweep": lambda: m.sweep(4, POSE, -2.0, 0.0, (0.1, 1.0)),
    "small_reversals": lambda: m.small_reversals(2, POSE),
    "pick_and_place": lambda: m.pick_and_place(ROBOT, 2),
}


@pytest.mark.parametrize("name", ALL)
def test_motion_is_consistent_and_within_limits(name):
    motion = ALL[name]()
    assert motion.q.shape == motion.qd.shape == motion.qdd.shape
    np.testing.assert_allclose(np.diff(motion.q, axis=0), 0.001 * (motion.qd[1:] + motion.qd[:-1]), atol=2e-5)
    step = np.abs(np.diff(motion.qd, axis=0) - 0.001 * (motion.qdd[1:] + motion.qdd[:-1]))
    assert np.quantile(step, 0.99) < 2e-4 and step.max() < 0.01
    assert np.abs(motion.qd).max() < np.pi
    assert np.abs(motion.q).max() < 2 * np.pi
    for end in (0, -1):
        np.testing.assert_allclose(motion.qd[end], 0.0, atol=1e-9)


@pytest.mark.parametrize("seed", range(5))
def test_fourier_uses_its_bounds_stays_above_the_table_and_repeats(seed):
    motion = m.fourier(ROBOT, 10.0, seed=seed, speed=1.2, acceleration=3.0)
    assert np.abs(motion.qd).max() <= 1.2 + 1e-9
    assert np.abs(motion.qdd).max() <= 3.0 + 1e-9
    assert np.all(np.abs(motion.qd).max(0) > 0.15)
    np.testing.assert_array_equal(m.fourier(ROBOT, 10.0, seed=seed, speed=1.2, acceleration=3.0).q, motion.q)
    for q in motion.q[::500]:
        simulator = Simulator(ROBOT, Plant(), q)
        assert min(simulator.where(link)[2] for link in range(2, 7)) > m.TABLE - 0.02


def test_seeds_differ():
    assert np.abs(m.fourier(ROBOT, 5.0, seed=1).q - m.fourier(ROBOT, 5.0, seed=2).q).max() > 0.1


def test_move_is_a_trapezoid_of_all_joints_in_step():
    end = np.array(POSE) + np.array([2.0, 0.5, 0, 0, 0, -1.0])
    motion = m.move(np.array(POSE), end, speed=1.0, acceleration=2.0)
    assert motion.duration == pytest.approx(2.0 / 1.0 + 0.5, abs=0.01)
    assert np.abs(motion.qd[:, 0]).max() == pytest.approx(1.0)
    np.testing.assert_allclose(motion.qd[:, 1], 0.25 * motion.qd[:, 0], atol=1e-12)
    np.testing.assert_allclose(motion.q[-1], end, atol=1e-9)


def test_grips_are_closed_at_rest():
    motion = m.pick_and_place(ROBOT, 3, pause=0.6)
    assert len(motion.grips) == 3
    for start, end in motion.grips:
        assert end - start > 1.0
        for instant in (start, end):
            np.testing.assert_allclose(motion.qd[round(instant / 0.002)], 0.0, atol=1e-9)


def test_joining_shifts_the_grips():
    part = m.pick_and_place(ROBOT, 1)
    wait = m.still(part.q[0], 2.0)
    assert m.join(wait, part).grips[0][0] == pytest.approx(part.grips[0][0] + 2.0)
