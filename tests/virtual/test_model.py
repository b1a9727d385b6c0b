"""The rigid body against Pinocchio, built apart from the same data, and against conservation of energy."""

import mujoco
import numpy as np
import pytest

from residuum.robots import Robot, load_robot, robot_names
from residuum.virtual.model import Build, RigidBody, build_model, link_body, tilted_gravity

pin = pytest.importorskip("pinocchio")

LOAD = RigidBody(2.0, np.array([0.02, -0.03, 0.08]), np.diag([0.01, 0.012, 0.006]) + 0.001)
HEAVY = RigidBody(4.0, np.array([0.1, 0.02, 0.1]), np.diag([0.02, 0.05, 0.04]) - 0.002)


def rotation(axis, angle):
    return pin.utils.rotate(axis, angle)


def in_pinocchio(robot: Robot, build: Build):
    model, parent, frame = pin.Model(), 0, pin.SE3.Identity()
    model.gravity.linear = np.array(robot.gravity if build.gravity is None else build.gravity)
    for number, joint in enumerate(robot.joint, start=1):
        parent = model.addJoint(parent, pin.JointModelRZ(), frame, f"joint_{number}")
        turn = rotation("z", joint.offset)
        frame = pin.SE3(turn @ rotation("x", joint.alpha), turn @ np.array([joint.a, 0, joint.d]))
        body = build.links.get(number) or link_body(robot, number)
        model.appendBodyToJoint(parent, pin.Inertia(body.mass, body.centre_of_mass, body.inertia), frame)
    if build.load:
        load = build.load
        model.appendBodyToJoint(parent, pin.Inertia(load.mass, load.centre_of_mass, load.inertia), frame)
    model.armature = np.array([joint.reflected_inertia for joint in robot.joint])
    return model


@pytest.mark.parametrize("name", robot_names())
@pytest.mark.parametrize(
    "build",
    [Build(), Build(load=LOAD), Build(links={3: HEAVY}, gravity=tilted_gravity((0, 0, -9.81), 0.05, -0.03))],
    ids=["bare", "loaded", "altered"],
)
def test_dynamics_agree_with_pinocchio(name, build):
    robot, _ = load_robot(name)
    robot = robot.model_copy(
        update={"joint": tuple(j.model_copy(update={"offset": 0.1 * i}) for i, j in enumerate(robot.joint))}
    )
    model, other = build_model(robot, build), in_pinocchio(robot, build)
    data, other_data = mujoco.MjData(model), other.createData()
    rng = np.random.default_rng(1)
    for _ in range(50):
        q, qd, qdd = rng.uniform(-3, 3, (3, 6))
        data.qpos[:], data.qvel[:], data.qacc[:] = q, qd, qdd
        mujoco.mj_inverse(model, data)
        torque = pin.rnea(other, other_data, q, qd, qdd)
        np.testing.assert_allclose(data.qfrc_inverse, torque, rtol=0, atol=1e-9)
        data.qfrc_applied[:] = torque
        mujoco.mj_forward(model, data)
        np.testing.assert_allclose(data.qacc, pin.aba(other, other_data, q, qd, torque), rtol=0, atol=1e-9)


def test_tilt_turns_gravity_into_the_base_frame():
    roll, pitch = 0.02, -0.05
    gravity = tilted_gravity((0.0, 0.0, -9.81), roll, pitch)
    expected = [np.sin(pitch), -np.sin(roll) * np.cos(pitch), -np.cos(roll) * np.cos(pitch)]
    np.testing.assert_allclose(gravity, 9.81 * np.array(expected), atol=1e-12)
    assert np.linalg.norm(gravity) == pytest.approx(9.81)


@pytest.mark.parametrize("timestep", [1e-3, 2.5e-4])
def test_energy_of_the_free_arm_is_conserved(timestep):
    model = build_model(load_robot("ur5e")[0], Build(load=LOAD), timestep)
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    data = mujoco.MjData(model)
    data.qpos[:] = [0.0, -1.0, 1.2, -0.5, -1.0, 0.4]
    energies = []
    for _ in range(int(2.0 / timestep)):
        mujoco.mj_step(model, data)
        energies.append(data.energy.sum())
    swing = np.ptp(energies) / 60.0  # some 60 J go to and fro between height and speed
    assert swing < 20.0 * timestep
