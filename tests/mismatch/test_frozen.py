"""Joints that a reduced model holds still: their column, and `explain` on an arm whose wrist moves."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from residuum.codegen.load import load_text
from residuum.mismatch.columns import space_of
from residuum.mismatch.explain import Task, explain
from residuum.mismatch.frozen import frozen_of
from residuum.mismatch.rows import common_names, make_rows
from residuum.recordings import Recording
from residuum.robots import load_robot
from residuum.symbolic.nominal import nominal_model
from residuum.virtual import Plant, simulate
from residuum.virtual.motions import Motion, fourier

ROBOT, DIGEST = load_robot("ur5e")
_SIZE, _RATE = np.array([0.8, 1.1, 1.5]), 2 * np.pi * np.array([0.37, 0.29, 0.41])


def whole_motion(along, time):
    """The conftest's motion of joints 1-3, and the wrist in sines: q, qd, qdd (T, 6)."""
    angle = np.outer(time, _RATE)
    wrist = _SIZE * np.sin(angle), _SIZE * _RATE * np.cos(angle), -_SIZE * _RATE**2 * np.sin(angle)
    return tuple(np.hstack(x) for x in zip(along(time), wrist, strict=True))


def recording(time, q, qd, torque, gains) -> Recording:
    still = np.zeros_like(q)
    still[:, :3] = torque / gains
    return Recording("known", time, q, still, qd=qd, joint_temperatures=np.full_like(q, 35.0))


@pytest.fixture(scope="module")
def setup(arm, along):
    """The arm's setup with the column; the wrist moves in a recording of no torque."""
    time = np.arange(0.0, 1.0, 0.008)
    q, qd, _ = whole_motion(along, time)
    frozen = frozen_of(arm.model, arm.robot, [recording(time, q, qd, q[:, :3], arm.gains)])
    space = space_of(arm.physics.regressor, arm.setup.space.own, common_names(3, True))
    return replace(arm.setup, frozen=frozen, space=space)


def frozen_column(setup, rows, row):
    space = setup.space
    return rows.columns[row][:, len(space.seen[row]) + len(space.own) + space.common.index("frozen")]


def test_the_column_is_the_whole_arms_torque_less_the_reduced_ones(arm, along, setup, generated) -> None:
    """Both from the generated inverse dynamics, with the exact accelerations."""
    whole = load_text(generated("ur5e", 6).files["observer.py"])
    time = np.arange(0.0, 8.0, 0.008)
    q, qd, qdd = whole_motion(along, time)
    torque = whole.inverse_dynamics(q, qd, qdd)[:, :3]
    torque = torque - arm.observer.inverse_dynamics(q[:, :3], qd[:, :3], qdd[:, :3])
    rows = make_rows(recording(time, q, qd, torque, arm.gains), setup)
    for row in range(3):
        size = np.sqrt(np.mean(rows.torque[:, row] ** 2))
        error = rows.torque[:, row] - frozen_column(setup, rows, row)
        assert size > 0.1
        assert np.sqrt(np.mean(error**2)) < 2e-3 * size


def test_a_motion_of_the_models_joints_alone_has_an_empty_column(arm, along, setup) -> None:
    """As of an experiment that is rehearsed: nothing is said of the wrist, so it stands."""
    time = np.arange(0.0, 4.0, 0.008)
    rows = make_rows(arm.recording(time, np.zeros((len(time), 3))), setup)
    assert not any(frozen_column(setup, rows, row).any() for row in range(3))


def test_there_is_a_column_only_where_joints_beyond_move(arm, along) -> None:
    time = np.arange(0.0, 2.0, 0.008)
    q, qd, _ = whole_motion(along, time)
    moving = recording(time, q, qd, q[:, :3], arm.gains)
    q_still = q.copy()
    q_still[:, 3:] = 0.04
    still = replace(moving, q=q_still)
    fewer = arm.recording(time, q[:, :3])
    assert frozen_of(arm.model, arm.robot, [still]) is None
    assert frozen_of(arm.model, arm.robot, [moving, fewer]) is None
    assert frozen_of(nominal_model(ROBOT, DIGEST, 6), arm.robot, [moving]) is None
    assert frozen_of(arm.model, arm.robot, [still, moving]).joints == (4, 5, 6)
    q_still[:, 4] = q[:, 4]
    assert frozen_of(arm.model, arm.robot, [still]).joints == (5,)


def explained(*recordings: Path, reference: tuple[Path, ...] = ()):
    return explain(Task(recordings, reference, ROBOT, DIGEST, 3, propose=False))


def effects(answer) -> list[str]:
    return [f["effect"] for f in answer.findings["findings"]]


def test_a_moving_wrist_is_named_and_no_reduced_model_pretends_to_hold_it(simulated) -> None:
    answer = explained(simulated("clean", 3))
    first = answer.findings["findings"][0]
    assert (first["effect"], first["joints"]) == ("frozen_joint_coupling", [1, 2, 3])
    assert first["indistinguishable_from"] == []
    share = first["parameters"]["share"]
    assert share["unit"] == "1"
    assert share["value"] == pytest.approx(1.0, abs=0.1)
    assert share["std"] < 0.05
    assert any("joint 4, 5, 6" in x and "--dof 6" in x for x in answer.cannot)
    assert {t.name for t in answer.model.term} == {"coulomb", "viscous"}
    assert answer.model.dof == 3


def test_a_wrist_that_stands_still_is_not_named(tmp_path) -> None:
    whole = fourier(ROBOT, 30.0, seed=3)
    q, qd, qdd = whole.q.copy(), whole.qd.copy(), whole.qdd.copy()
    q[:, 3:], qd[:, 3:], qdd[:, 3:] = q[0, 3:], 0.0, 0.0
    simulate(ROBOT, Plant(), Motion(q, qd, qdd), 125, 3).recording.write_csv(tmp_path / "still.csv")
    answer = explained(tmp_path / "still.csv")
    assert "frozen_joint_coupling" not in effects(answer)
    assert not any("--dof" in x for x in answer.cannot)


@pytest.mark.slow
def test_a_wrist_that_moves_on_both_sides_is_no_change(simulated) -> None:
    answer = explained(simulated("clean", 3), reference=(simulated("clean", 1), simulated("clean", 2)))
    assert effects(answer) == []
