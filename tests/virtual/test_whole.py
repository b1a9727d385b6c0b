"""The package as a whole: it stands apart, keeps energy, and stays in physics with everything switched on."""

import ast
from pathlib import Path

import mujoco
import numpy as np
import pytest

import residuum.virtual
from residuum.robots import load_robot
from residuum.virtual import NOISELESS, Contact, Plant, Simulator, Torque, simulate
from residuum.virtual import effects as e
from residuum.virtual.model import build_model
from residuum.virtual.motions import fourier, pick_and_place
from residuum.virtual.plant import BaseFriction

ROBOT, _ = load_robot("ur5e")
JOINTS = range(1, 7)
STRONG = {
    "payload": e.Payload(mass=5.0, centre_of_mass=(0.0, 0.0, 0.1)),
    "link_inertial": tuple(e.LinkInertial(link=j, mass=0.1) for j in JOINTS),
    "base_tilt": e.BaseTilt(roll=0.087, pitch=-0.087),
    "rotor_inertia": tuple(e.RotorInertia(joint=j, share=0.5) for j in JOINTS),
    "drive_gain": tuple(e.DriveGain(joint=j, error=-0.3) for j in JOINTS),
    "stribeck": tuple(e.Stribeck(joint=j, torque=2.0, speed=0.02) for j in JOINTS),
    "nonlinear_viscous": tuple(e.NonlinearViscous(joint=j, shape="cubic", coefficient=1.0) for j in JOINTS),
    "load_dependent_friction": tuple(e.LoadDependentFriction(joint=j, coefficient=0.15) for j in JOINTS),
    "temperature_dependent_friction": tuple(
        e.TemperatureDependentFriction(joint=j, coulomb=-0.025, viscous=-0.025, shape="exponential")
        for j in JOINTS
    ),
    "presliding_hysteresis": tuple(
        e.PreslidingHysteresis(joint=j, travel=0.03, law="maxwell") for j in JOINTS
    ),
    "torque_ripple": tuple(e.TorqueRipple(joint=j, torque=0.6, order=4.0) for j in JOINTS),
    "position_dependent_friction": tuple(e.PositionDependentFriction(joint=j, sine=1.0) for j in JOINTS),
    "cable_spring": tuple(e.CableSpring(joint=j, stiffness=2.0) for j in JOINTS),
    "encoder_offset": tuple(e.EncoderOffset(joint=j, offset=0.035) for j in JOINTS),
    "current_offset": tuple(e.CurrentOffset(joint=j, offset=0.1) for j in JOINTS),
    "time_delay": (e.TimeDelay(delay=0.02, channels="current"),),
    "velocity_lag": tuple(e.VelocityLag(joint=j, lag=0.02) for j in JOINTS),
    "external_contact": (Contact(start=1.0, end=2.0, force=(40.0, 40.0, 40.0)),),
    "soft": {"joint_elasticity": tuple(e.JointElasticity(joint=j, stiffness=3000.0) for j in JOINTS)},
    "stiff": {
        "joint_elasticity": tuple(e.JointElasticity(joint=j, stiffness=4e4, damping=0.0) for j in JOINTS)
    },
    "backlash": tuple(e.Backlash(joint=j, gap=5e-3) for j in JOINTS),
}


def test_it_shares_nothing_with_the_derivation():
    for file in Path(residuum.virtual.__file__).parent.glob("*.py"):
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.ImportFrom) and node.level == 2:
                assert (node.module or "").split(".")[0] in {"robots", "errors"}, (
                    f"{file.name}: {node.module}"
                )
            elif isinstance(node, ast.Import | ast.ImportFrom):
                names = [node.module] if isinstance(node, ast.ImportFrom) else [a.name for a in node.names]
                assert not any(str(name).startswith(("residuum", "sympy", "casadi")) for name in names)


@pytest.mark.parametrize("name", STRONG)
def test_strong_effects_stay_in_physics(name):
    effect = STRONG[name] if isinstance(STRONG[name], dict) else {name: STRONG[name]}
    motion = fourier(ROBOT, 3.0, seed=2, period=6.0)
    run = simulate(ROBOT, Plant(sensing=NOISELESS, **effect), motion)
    error = np.abs(run.recording["target_q"] - run.recording["actual_q"])
    assert error.max() < 6e-3
    jerk = np.diff(run.recording["actual_current"], 2, axis=0)
    assert np.abs(jerk[-50:]).max() < 0.05  # calm again at the end


@pytest.mark.slow
def test_everything_at_once():
    motion = pick_and_place(ROBOT, 1, seed=3)
    effects = {
        name: value for name, value in STRONG.items() if name not in {"soft", "stiff", "backlash", "payload"}
    }
    effects["payload"] = e.Payload(mass=2.0, centre_of_mass=(0.0, 0.0, 0.05), intervals=motion.grips)
    effects["joint_elasticity"] = tuple(e.JointElasticity(joint=j, stiffness=1e4) for j in (1, 2, 3))
    effects["backlash"] = tuple(e.Backlash(joint=j, gap=1e-3) for j in (4, 5, 6))
    run = simulate(ROBOT, Plant(**effects), motion)
    assert set(run.truth.effects) == set(effects)
    assert np.abs(run.recording["target_q"] - run.recording["actual_q"]).max() < 0.01


@pytest.mark.parametrize("gear", [{}, STRONG["stiff"]], ids=["rigid", "elastic"])
def test_energy_is_conserved_by_the_unpowered_frictionless_arm(gear):
    plant = Plant(sensing=NOISELESS, friction=BaseFriction(kind="none"), **gear)
    simulator = Simulator(ROBOT, plant, np.array([0.0, -1.0, 1.2, -0.5, -1.0, 0.4]))
    model = build_model(ROBOT)
    rotors = model.dof_armature.copy()
    model.dof_armature[:] = 0.0
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    data, energies, kinetic = mujoco.MjData(model), [], []
    for _ in range(500):
        state = simulator.step(Torque((0.0,) * 6))
        data.qpos[:], data.qvel[:] = state.truth["link_q"], state.truth["link_qd"]
        mujoco.mj_forward(model, data)
        rotor = 0.5 * np.sum(rotors * state.rtde["actual_qd"] ** 2)
        wound = state.rtde["actual_q"] - state.truth["link_q"]
        energies.append(data.energy.sum() + rotor + (0.5 * 4e4 * np.sum(wound**2) if gear else 0.0))
        kinetic.append(data.energy[1] + rotor)
    assert max(kinetic) > 20.0
    assert np.ptp(energies) < 0.01 * max(kinetic)
