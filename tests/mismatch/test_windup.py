"""The link behind a soft gear, against MuJoCo's and against the exact answer."""

from dataclasses import replace
from itertools import pairwise

import mujoco
import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from residuum.codegen.generate import generate
from residuum.codegen.load import load_text
from residuum.mismatch.candidates import WHOLE
from residuum.mismatch.columns import STIFFNESSES, WINDUP
from residuum.mismatch.explain import Task, explain
from residuum.mismatch.quantities import MIXING
from residuum.mismatch.rows import make_rows
from residuum.mismatch.windup import DAMPING, wound
from residuum.robots import load_robot
from residuum.virtual import Plant, effects, simulate
from residuum.virtual.motions import fourier, pick_and_place

INERTIA, STIFFNESS = 3.0, np.array([2e3, 1e4, 3e4])


def swept(rate: float, seconds: float = 6.0):
    """A motor that turns and stops: time (T,), angle and speed (T,)."""
    time = np.arange(0.0, seconds, 1 / rate)
    u = np.clip((time - 1.0) / 0.6, 0, 1)
    return time, u**3 * (10 - 15 * u + 6 * u**2), 30 * u**2 * (1 - u) ** 2 / 0.6


def column(x):
    return np.asarray(x)[:, None]


@pytest.mark.parametrize("rate", [125.0, 500.0])
def test_a_link_rings_behind_its_motor_as_mujoco_says(rate) -> None:
    time, angle, speed = swept(rate)
    place, _ = wound(
        time,
        column(angle),
        column(speed),
        np.zeros((len(time), 1)),
        np.full((len(time), 1), INERTIA),
        STIFFNESS,
    )
    for k, stiffness in enumerate(STIFFNESS):
        damping = 2 * DAMPING * np.sqrt(stiffness * INERTIA)
        model = mujoco.MjModel.from_xml_string(
            f"""<mujoco><option gravity="0 0 0" timestep="0.0001" integrator="implicit"/><worldbody><body>
            <joint axis="0 0 1"/><inertial pos="0 0 0" mass="1" diaginertia="3 3 {INERTIA}"/>
            </body></worldbody></mujoco>"""
        )
        data, found = mujoco.MjData(model), []
        fine = np.arange(0.0, time[-1], 1e-4)
        motor, turning = np.interp(fine, *swept(2000.0)[:2]), np.interp(fine, *swept(2000.0)[::2])
        for q, qd in zip(motor, turning, strict=True):
            found.append(data.qpos[0] - q)
            data.qfrc_applied[0] = stiffness * (q - data.qpos[0]) + damping * (qd - data.qvel[0])
            mujoco.mj_step(model, data)
        truth = np.interp(time, fine, found)
        assert np.abs(place[:, 0, k] - truth).max() < 0.05 * np.abs(truth).max(), stiffness


def test_under_a_steady_pull_the_link_hangs_by_it_over_the_stiffness() -> None:
    time = np.arange(0.0, 2.0, 0.008)
    still, pull = np.zeros((len(time), 1)), np.full((len(time), 1), 25.0)
    place, rate = wound(time, still, still, pull, np.full((len(time), 1), INERTIA), STIFFNESS)
    assert np.allclose(place[:, 0], -25.0 / STIFFNESS)
    assert np.allclose(rate, 0.0)


def test_after_a_pause_in_the_recording_the_link_is_at_rest_again() -> None:
    time, angle, speed = swept(500.0)
    later = time + np.where(time > 1.4, 3.0, 0.0)  # it rings when the pause comes
    flat, inertia = np.zeros((len(time), 1)), np.full((len(time), 1), INERTIA)
    place, _ = wound(later, column(angle), column(speed), flat, inertia, STIFFNESS[:1])
    first = int(np.flatnonzero(time > 1.4)[0])
    assert abs(place[first - 1, 0, 0]) > 1e-4
    assert place[first, 0, 0] == 0.0


@pytest.mark.parametrize("part", [0.25, 0.5, 0.75])
def test_a_stiffness_between_two_is_mixed_of_them(part) -> None:
    """On average over the grid it is missed by as much as a finding says that it may be."""
    time, angle, speed = swept(500.0)
    flat, errors = np.zeros((len(time), 1)), []
    for soft, stiff in pairwise(STIFFNESSES[:8]):
        between = soft * (stiff / soft) ** part
        _, rate = wound(
            time, column(angle), column(speed), flat, flat + INERTIA, np.array([soft, stiff, between])
        )
        torque = gaussian_filter1d(np.gradient(INERTIA * rate[:, 0], time, axis=0), 6, axis=0)
        size = np.linalg.lstsq(torque[:, :2], torque[:, 2], rcond=None)[0]
        assert WHOLE[0] < size.sum() < WHOLE[1]
        errors.append(size @ [soft, stiff] / size.sum() / between - 1)
    assert np.sqrt(np.mean(np.square(errors))) < MIXING


@pytest.mark.parametrize("rate", [125.0, 500.0])
@pytest.mark.parametrize("part", [0.01, 1.0], ids=["light", "as it is"])
def test_an_arm_too_light_to_swing_has_no_swing(arm, along, rate, part) -> None:
    """A folded UR3e's links all swing too fast to be seen."""
    time = np.arange(0.0, 4.0, 1 / rate)
    setup = replace(arm.setup, base=arm.physics.rotors + part * (arm.physics.published - arm.physics.rotors))
    rows = make_rows(arm.recording(time, arm.observer.inverse_dynamics(*along(time))), setup)
    own = [k for k, c in enumerate(setup.space.own) if c.term == WINDUP]
    swings = [rows.columns[j][:, len(setup.space.seen[j]) + own[0]].any() for j in range(3)]
    assert any(swings) == (part == 1.0)


@pytest.mark.slow
def test_explain_names_a_soft_gear_that_swings_and_the_model_is_generated(tmp_path) -> None:
    """Of the virtual arm, whose rotor and link are two bodies in MuJoCo's closed loop."""
    robot, digest = load_robot("ur5e")
    plant = Plant(joint_elasticity=(effects.JointElasticity(joint=2, stiffness=1e4, damping=15.0),))
    paths = []
    for seed, motion in enumerate((fourier(robot, 40.0, 1), pick_and_place(robot, cycles=3, seed=2))):
        paths.append(tmp_path / f"{seed}.csv")
        simulate(robot, plant, motion, 500, seed).recording.write_csv(paths[-1])
    answer = explain(Task(tuple(paths), (), robot, digest, 6, propose=False, thresholds=False))
    found = [f for f in answer.findings["findings"] if f["effect"] == "joint_elasticity"]
    assert [f["joints"] for f in found] == [[2]]
    assert found[0]["parameters"]["stiffness"]["value"] == pytest.approx(1e4, rel=0.15)
    assert ("elasticity", 2) in [(t.name, t.joint) for t in answer.model.term]
    observer = load_text(generate(answer.model).files["observer.py"])
    assert observer.DOF == 6
