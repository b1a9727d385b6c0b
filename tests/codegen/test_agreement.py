"""C, NumPy and URScript against SymPy at 50 digits, and against Pinocchio and MuJoCo."""

import mpmath as mp
import numpy as np
import pytest
from peers import MujocoArm, PinocchioArm

from residuum.codegen.generate import generate
from residuum.codegen.load import CLibrary, c_compiler, compile_c, load_text
from residuum.robots import load_robot
from residuum.symbolic.arm import exact, symbolic_arm
from residuum.symbolic.energy import energies
from residuum.symbolic.nominal import nominal_model, robot_arm, with_wrist_locked
from residuum.symbolic.reference import Reference
from residuum.urscript import run as urscript_run

JOINTS = range(1, 7)


def states(dof: int, count: int):
    """Yield q, qd, qdd over the joints' whole range."""
    random = np.random.default_rng(dof)
    for _ in range(count):
        yield random.uniform(-np.pi, np.pi, dof), random.uniform(-3, 3, dof), random.uniform(-20, 20, dof)


def raw_reference(robot_name: str, dof: int) -> Reference:
    """The links as they are published: no base parameters, no gradient, no generated code."""
    robot, _ = load_robot(robot_name)
    moving = robot.model_copy(update={"joint": robot.joint[:dof]})
    arm = robot_arm(moving)
    bodies = with_wrist_locked(robot, dof, (0.0,) * (6 - dof))
    rotors = [exact(j.gear) ** 2 * exact(j.rotor_inertia) for j in moving.joint]
    return Reference(energies(arm, bodies, rotors), arm.values)


def relative(found, expected) -> float:
    """Largest difference over the largest element expected."""
    expected = [mp.mpf(x) for x in np.asarray(expected, dtype=object).ravel()]
    found = np.asarray(found, dtype=float).ravel()
    scale = max(abs(x) for x in expected) or mp.mpf(1)
    return float(max(abs(mp.mpf(float(f)) - x) for f, x in zip(found, expected, strict=True)) / scale)


@pytest.fixture(scope="module")
def library(tmp_path_factory, generated):
    if c_compiler() is None:
        pytest.skip("no C compiler")

    def compiled(dof: int) -> CLibrary:
        folder = tmp_path_factory.mktemp(f"c{dof}")
        tree = generated("ur5e", dof)
        for name, text in tree.files.items():
            (folder / name).write_text(text)
        compile_c(folder, folder / "observer.so")
        return CLibrary(folder / "observer.so", tree.model.model.name, tree.listings)

    return compiled


def exact_results(reference: Reference, q, qd, qdd) -> dict:
    return {
        "momentum": reference.momentum(q, qd),
        "beta": reference.beta(q, qd),
        "gravity": reference.gravity(q),
        "mass_matrix": reference.mass_matrix(q),
        "inverse_dynamics": reference.inverse_dynamics(q, qd, qdd),
    }


def numpy_results(module, q, qd, qdd) -> dict:
    return {
        "momentum": module.momentum(q, qd),
        "beta": module.beta(q, qd),
        "gravity": module.gravity(q),
        "mass_matrix": module.mass_matrix(q),
        "inverse_dynamics": module.inverse_dynamics(q, qd, qdd),
    }


def c_results(library: CLibrary, q, qd, qdd) -> dict:
    return {
        "momentum": library.call("momentum", q, qd)["momentum"],
        "beta": library.call("beta", q, qd)["beta"],
        "gravity": library.call("gravity", q)["gravity"],
        "mass_matrix": library.call("mass_matrix", q)["mass_matrix"],
        "inverse_dynamics": library.call("inverse_dynamics", q, qd, qdd)["torque"],
    }


def compare_with_sympy(dof: int, count: int, generated, library, record) -> None:
    tree = generated("ur5e", dof)
    module, compiled = load_text(tree.files["observer.py"]), library(dof)
    script = urscript_run.Functions(tree.files["collision_guard.script"])
    reference = raw_reference("ur5e", dof)
    worst = {"NumPy": 0.0, "C": 0.0, "URScript": 0.0}
    for q, qd, qdd in states(dof, count):
        expected = exact_results(reference, q, qd, qdd)
        in_numpy, in_c = numpy_results(module, q, qd, qdd), c_results(compiled, q, qd, qdd)
        for name, value in expected.items():
            worst["NumPy"] = max(worst["NumPy"], relative(in_numpy[name], value))
            worst["C"] = max(worst["C"], relative(in_c[name], value))
        core = script.call("rs_core", list(q), list(qd), [30.0] * dof)
        worst["URScript"] = max(
            worst["URScript"],
            relative(core[:dof], expected["momentum"]),
            relative(core[dof : 2 * dof], expected["beta"]),
        )
    record(dof, worst)
    assert worst["NumPy"] <= 1e-12
    assert worst["C"] <= 1e-12
    assert worst["URScript"] <= 1e-9


@pytest.mark.parametrize("dof", JOINTS)
def test_languages_agree_with_sympy(dof, generated, library, record_property) -> None:
    compare_with_sympy(dof, 10, generated, library, lambda n, worst: record_property(f"joints {n}", worst))


@pytest.mark.slow
@pytest.mark.parametrize("dof", JOINTS)
def test_languages_agree_with_sympy_at_1000_states(dof, generated, library, capsys) -> None:
    def show(n: int, worst: dict) -> None:
        with capsys.disabled():
            print(
                f"\n{n} joints, 1000 states, worst relative error: "
                + ", ".join(f"{k} {v:.1e}" for k, v in worst.items())
            )

    compare_with_sympy(dof, 1000, generated, library, show)


@pytest.mark.slow
@pytest.mark.parametrize("robot_name", ["ur5e", "ur10e", "ur3e", "ur16e"])
@pytest.mark.parametrize("dof", JOINTS)
def test_agrees_with_pinocchio_and_mujoco_at_1000_states(robot_name, dof, generated) -> None:
    compare_with_peers(robot_name, dof, 1000, generated)


@pytest.mark.parametrize("dof", JOINTS)
def test_agrees_with_pinocchio_and_mujoco(dof, generated) -> None:
    compare_with_peers("ur5e", dof, 20, generated)


def compare_with_peers(robot_name, dof, count, generated) -> None:
    robot, _ = load_robot(robot_name)
    module = load_text(generated(robot_name, dof).files["observer.py"])
    pinocchio, mujoco = PinocchioArm(robot, dof), MujocoArm(robot, dof)
    for q, qd, qdd in states(dof, count):
        found = numpy_results(module, q, qd, qdd)
        assert relative(found["mass_matrix"], pinocchio.mass_matrix(q)) <= 1e-10
        assert relative(found["momentum"], pinocchio.momentum(q, qd)) <= 1e-10
        expected_beta = pinocchio.beta(q, qd)
        scale = max(np.abs(expected_beta).max(), 1e-3)
        assert np.abs(found["beta"] - expected_beta).max() / scale <= 1e-10
        torque = pinocchio.inverse_dynamics(q, qd, qdd)
        assert relative(found["inverse_dynamics"], torque) <= 1e-10
        assert relative(mujoco.inverse_dynamics(q, qd, qdd), torque) <= 1e-10
        assert relative(found["inverse_dynamics"], mujoco.inverse_dynamics(q, qd, qdd)) <= 1e-10


def test_locked_wrist_at_other_angles_agrees_with_pinocchio() -> None:
    robot, digest = load_robot("ur5e")
    angles = (-np.pi / 2, 0.3, 1.1)
    module = load_text(generate(nominal_model(robot, digest, 3, angles)).files["observer.py"])
    pinocchio = PinocchioArm(robot, 3, angles)
    for q, qd, _ in states(3, 100):
        assert relative(module.momentum(q, qd), pinocchio.momentum(q, qd)) <= 1e-10
        assert relative(module.beta(q, qd), pinocchio.beta(q, qd)) <= 1e-10


@pytest.mark.parametrize(
    "gravity", [(0.0, 0.0, -9.81), (0.0, 0.0, 9.81), (1.2, -3.4, -9.0), (9.81, 0.0, 0.0)]
)
def test_gravity_in_any_direction(gravity) -> None:
    robot, digest = load_robot("ur5e")
    robot = robot.model_copy(update={"gravity": gravity})
    module = load_text(generate(nominal_model(robot, digest, 6)).files["observer.py"])
    pinocchio = PinocchioArm(robot, 6)
    for q, qd, _ in states(6, 50):
        assert relative(module.gravity(q), pinocchio.gravity(q)) <= 1e-10
        assert relative(module.beta(q, qd), pinocchio.beta(q, qd)) <= 1e-10


def test_an_arm_with_skew_axes_and_offsets_agrees_with_pinocchio() -> None:
    """No right angle, no zero: nothing that the UR family makes vanish."""
    robot, digest = load_robot("ur5e")
    random = np.random.default_rng(1)
    joints = tuple(
        j.model_copy(
            update={
                "a": float(random.uniform(-0.5, 0.5)),
                "d": float(random.uniform(-0.5, 0.5)),
                "alpha": float(random.uniform(-2, 2)),
            }
        )
        for j in robot.joint
    )
    robot = robot.model_copy(update={"joint": joints})
    module = load_text(generate(nominal_model(robot, digest, 6)).files["observer.py"])
    pinocchio = PinocchioArm(robot, 6)
    for q, qd, qdd in states(6, 50):
        assert relative(module.inverse_dynamics(q, qd, qdd), pinocchio.inverse_dynamics(q, qd, qdd)) <= 1e-10
        assert relative(module.beta(q, qd), pinocchio.beta(q, qd)) <= 1e-10


def test_the_symbolic_arm_keeps_right_angles_exact() -> None:
    arm = symbolic_arm([(0.0, 0.1, np.pi / 2, 0.0), (0.3, 0.0, 0.0, 0.0)], (0.0, 0.0, -9.81))
    assert arm.links[0].cos_alpha == 0
    assert arm.parallel_groups() == [[0], [1]]
