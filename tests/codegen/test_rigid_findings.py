"""What a finding changes in the rigid body reaches all three languages through model.toml."""

import numpy as np
import pytest
from peers import PinocchioArm

from residuum.codegen.generate import generate, model_toml
from residuum.codegen.load import CLibrary, c_compiler, compile_c, load_text
from residuum.robots import load_robot
from residuum.robots.model import Model
from residuum.robots.toml import parse
from residuum.symbolic.nominal import nominal_model
from residuum.symbolic.tilt import tilted, tilted_gravity
from residuum.urscript.run import Functions

ROLL, PITCH = 0.035, -0.02
OFFSETS = (0.0, 0.02, -0.03, 0.01, 0.0, 0.015)


class Languages:
    """Momentum and beta (N,) each, by language, of a model that went through model.toml."""

    def __init__(self, model: Model, folder) -> None:
        self.tree = generate(parse(Model, model_toml(model), "model.toml"))
        self.numpy = load_text(self.tree.files["observer.py"])
        self.script = Functions(self.tree.files["collision_guard.script"])
        self.library = None
        if c_compiler():
            for name, text in self.tree.files.items():
                (folder / name).write_text(text)
            compile_c(folder, folder / "observer.so")
            self.library = CLibrary(folder / "observer.so", model.name, self.tree.listings)

    def of(self, q, qd):
        n = len(q)
        yield self.numpy.momentum(q, qd), self.numpy.beta(q, qd)
        core = self.script.call("rs_core", q.tolist(), qd.tolist(), [30.0] * n)
        yield np.array(core[:n]), np.array(core[n : 2 * n])
        if self.library:
            found = self.library.call("momentum_and_beta", q, qd)
            yield found["momentum"], found["beta"]


def states(dof: int, count: int = 15):
    random = np.random.default_rng(dof)
    for _ in range(count):
        yield random.uniform(-3, 3, dof), random.uniform(-3, 3, dof)


@pytest.mark.parametrize("dof", [3, 6])
def test_a_tilted_base_is_turned_gravity_in_all_languages(dof, tmp_path) -> None:
    robot, digest = load_robot("ur5e")
    made = Languages(tilted(nominal_model(robot, digest, dof), robot, ROLL, PITCH), tmp_path)
    gravity = tilted_gravity(robot.gravity, ROLL, PITCH)
    pinocchio = PinocchioArm(robot.model_copy(update={"gravity": gravity}), dof)
    for q, qd in states(dof):
        expected = pinocchio.beta(q, qd)
        for _, beta in made.of(q, qd):
            np.testing.assert_allclose(beta, expected, atol=1e-10 * np.abs(expected).max())
    assert abs(made.numpy.gravity(np.zeros(dof))[0]) > 0.1, "joint 1 carries a torque now"


def test_tilt_turns_gravity_as_a_rotation_does() -> None:
    c, s = np.cos(ROLL), np.sin(ROLL)
    about_x = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    c, s = np.cos(PITCH), np.sin(PITCH)
    about_y = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    gravity = np.array([0.5, -1.0, -9.7])
    np.testing.assert_allclose(tilted_gravity(tuple(gravity), ROLL, PITCH), (about_y @ about_x).T @ gravity)


def test_tilt_keeps_what_the_model_knows_and_fills_in_what_a_level_base_hides() -> None:
    robot, digest = load_robot("ur5e")
    level = nominal_model(robot, digest, 6)
    turned = tilted(level, robot, ROLL, PITCH)
    assert set(turned.base) - set(level.base) == {"MX1", "MY1"}
    assert {k: turned.base[k] for k in level.base} == level.base


@pytest.mark.parametrize("dof", [3, 6])
def test_an_encoder_offset_is_the_joints_offset_in_all_languages(dof, tmp_path) -> None:
    plain = nominal_model(*load_robot("ur5e"), dof)
    joints = tuple(
        j.model_copy(update={"offset": j.offset + o}) for j, o in zip(plain.joint, OFFSETS, strict=False)
    )
    made = Languages(plain.model_copy(update={"joint": joints}), tmp_path)
    reference = load_text(generate(plain).files["observer.py"])
    for q, qd in states(dof):
        there = q + np.array(OFFSETS[:dof])
        for momentum, beta in made.of(q, qd):
            np.testing.assert_allclose(momentum, reference.momentum(there, qd), atol=1e-10)
            np.testing.assert_allclose(beta, reference.beta(there, qd), atol=1e-10)


def test_a_drive_gain_is_the_gain_in_all_languages(tmp_path) -> None:
    plain = nominal_model(*load_robot("ur5e"), 3)
    joints = (plain.joint[0].model_copy(update={"drive_gain": 11.25}), *plain.joint[1:])
    made = Languages(plain.model_copy(update={"joint": joints}), tmp_path)
    assert made.numpy.GAINS[0] == 11.25
    assert made.numpy.motor_torque(np.ones(3))[0] == 11.25
    assert "_gains[UR5E_DOF3_DOF] = {11.25," in made.tree.files["observer.c"].replace("{ ", "{")
    assert "global rs_gains = [11.25," in made.tree.files["collision_guard.script"]


def test_a_rotor_inertia_adds_its_own_acceleration_only(tmp_path) -> None:
    plain = nominal_model(*load_robot("ur5e"), 6)
    rotor = plain.base["IA4"]
    more = {"IA4": rotor.model_copy(update={"value": rotor.value + 0.1})}
    made = load_text(generate(plain.model_copy(update={"base": {**plain.base, **more}})).files["observer.py"])
    reference = load_text(generate(plain).files["observer.py"])
    q, qd, qdd = np.random.default_rng(0).normal(size=(3, 20, 6))
    change = made.inverse_dynamics(q, qd, qdd) - reference.inverse_dynamics(q, qd, qdd)
    np.testing.assert_allclose(change, 0.1 * qdd * (np.arange(6) == 3), atol=1e-10)
