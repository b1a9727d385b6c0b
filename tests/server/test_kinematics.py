"""Kinematics against MuJoCo's, and against itself by differences."""

from math import pi

import numpy as np
import pytest

from residuum.robots import load_robot, robot_names
from residuum.urscript.poses import matrix, rotation_vector
from residuum.virtual import Simulator
from residuum.virtual.server.kinematics import Kinematics, error, pose_of, transform

TOOL = transform((0.01, -0.02, 0.1, 0.2, -0.1, 0.3))
POSES = np.random.default_rng(0).uniform(-2.5, 2.5, (8, 6))


@pytest.mark.parametrize("name", robot_names())
def test_the_flange_is_where_mujoco_has_it(name) -> None:
    robot, _ = load_robot(name)
    simulator = Simulator(robot, start=POSES[0])
    place, turn = simulator.frame(6)
    frame = Kinematics(robot).forward(POSES[0], np.eye(4))
    assert frame[:3, 3] == pytest.approx(place, abs=2e-3)  # the servo carries the arm to 1 mrad
    assert frame[:3, :3] == pytest.approx(turn, abs=2e-3)


@pytest.mark.parametrize("q", POSES)
def test_the_jacobian_is_the_derivative(q) -> None:
    kinematics, h = Kinematics(load_robot("ur5e")[0]), 1e-6
    jacobian = kinematics.jacobian(q, TOOL)
    for k in range(6):
        step = h * np.eye(6)[k]
        ends = kinematics.forward(q + step, TOOL), kinematics.forward(q - step, TOOL)
        assert error(ends[0], ends[1]) / (2 * h) == pytest.approx(jacobian[:, k], abs=1e-6)


@pytest.mark.parametrize("q", POSES)
def test_the_inverse_comes_back(q) -> None:
    kinematics = Kinematics(load_robot("ur5e")[0])
    target = kinematics.forward(q, TOOL)
    near = kinematics.inverse(target, q + 0.2, TOOL)
    assert near is not None
    assert error(target, kinematics.forward(near, TOOL)) == pytest.approx(np.zeros(6), abs=1e-9)
    assert np.abs(near - q).max() < 2 * pi


def test_from_home_most_reachable_frames_are_found() -> None:
    kinematics, home = Kinematics(load_robot("ur5e")[0]), np.array([0, -1.57, 1.57, -1.57, -1.57, 0])
    targets = np.random.default_rng(1).uniform(-1.2, 1.2, (40, 6)) + home
    found = [kinematics.inverse(kinematics.forward(q, np.eye(4)), home, np.eye(4)) for q in targets]
    assert sum(q is not None for q in found) >= 39


def test_beyond_reach_there_is_none() -> None:
    kinematics = Kinematics(load_robot("ur5e")[0])
    assert kinematics.inverse(transform((2.0, 0, 0, 0, 0, 0)), np.zeros(6) + 0.5, np.eye(4)) is None


@pytest.mark.parametrize("angle", [1e-12, 1e-8, 1e-7, 5e-7, 1e-3, 1.0, 3.1])
def test_rotation_vectors_of_all_sizes_come_back(angle) -> None:
    axis = np.array([0.36, -0.48, 0.8])
    assert rotation_vector(matrix(angle * axis)) == pytest.approx(angle * axis, rel=1e-6, abs=1e-15)


def test_poses_come_back() -> None:
    pose = (0.1, -0.2, 0.3, 0.4, -0.5, 0.6)
    assert pose_of(transform(pose)) == pytest.approx(pose)
