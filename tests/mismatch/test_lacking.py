"""What a simplified model lacks by its form: the columns, and `explain` on arms that show it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from residuum.codegen.generate import model_toml, observer_text
from residuum.codegen.load import load_text
from residuum.mismatch.columns import space_of
from residuum.mismatch.explain import Task, explain
from residuum.mismatch.lacking import dropped_of, frozen_of, full_of
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


def with_column(arm, lacking):
    space = space_of(arm.physics.regressor, arm.setup.space.own, common_names(3, (lacking,)))
    return replace(arm.setup, lacking=(lacking,), space=space)


@pytest.fixture(scope="module")
def setup(arm, along):
    """The arm's setup with the column; the wrist moves in a recording of no torque."""
    time = np.arange(0.0, 1.0, 0.008)
    q, qd, _ = whole_motion(along, time)
    frozen = frozen_of(arm.model, arm.robot, [recording(time, q, qd, q[:, :3], arm.gains)])
    return with_column(arm, frozen)


def column(setup, rows, row):
    space = setup.space
    return rows.columns[row][:, len(space.seen[row]) + len(space.own) + len(space.common) - 1]


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
        error = rows.torque[:, row] - column(setup, rows, row)
        assert size > 0.1
        assert np.sqrt(np.mean(error**2)) < 2e-3 * size


def test_the_thesis_column_is_the_links_torque_less_its_own(arm, along) -> None:
    simple = nominal_model(ROBOT, DIGEST, 3, variant="thesis")
    full = full_of(simple, ROBOT, DIGEST)
    dropped = dropped_of(simple, full)
    setup = with_column(arm, dropped)
    time = np.arange(0.0, 8.0, 0.008)
    q, qd, qdd = along(time)
    arms, step = (load_text(observer_text(m)) for m in (full, simple)), 1e-5
    torque = [  # of the momentum, as the observer sees it: the thesis' inverse dynamics drops more
        (m.momentum(q + step * qd, qd + step * qdd) - m.momentum(q - step * qd, qd - step * qdd)) / (2 * step)
        - m.beta(q, qd)
        for m in arms
    ]
    rows = make_rows(arm.recording(time, torque[0] - torque[1]), setup)
    for row in range(3):
        size = np.sqrt(np.mean(rows.torque[:, row] ** 2))
        assert size > 0.01
        assert np.sqrt(np.mean((rows.torque[:, row] - column(setup, rows, row)) ** 2)) < 2e-3 * size


def test_a_motion_of_the_models_joints_alone_has_an_empty_column(arm, along, setup) -> None:
    """As of an experiment that is rehearsed: nothing is said of the wrist, so it stands."""
    time = np.arange(0.0, 4.0, 0.008)
    rows = make_rows(arm.recording(time, np.zeros((len(time), 3))), setup)
    assert not any(column(setup, rows, row).any() for row in range(3))


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
    return explain(Task(recordings, reference, ROBOT, DIGEST, 3, propose=False, thresholds=False))


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
    assert set(effects(answer)) == {"frozen_joint_coupling", "nonlinear_viscous"}  # the factory sheet's drag
    assert {t.name for t in answer.model.term} == {"coulomb", "viscous", "tanh"}
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


def test_the_thesis_model_is_told_what_it_drops(tmp_path) -> None:
    """All masses are there but links 4-6; the wrist stands, as in Gylling 2019."""
    wrist = (-1.4, -1.5708, 0.0)
    paths = []
    for seed in (1, 2):
        m = fourier(ROBOT, 40.0, seed=seed)
        q, qd, qdd = m.q.copy(), m.qd.copy(), m.qdd.copy()
        q[:, 3:], qd[:, 3:], qdd[:, 3:] = wrist, 0.0, 0.0
        paths.append(tmp_path / f"run{seed}.csv")
        simulate(ROBOT, Plant(), Motion(q, qd, qdd), 125, seed).recording.write_csv(paths[-1])
    simple = nominal_model(ROBOT, DIGEST, 3, wrist, variant="thesis")
    answer = explain(Task(tuple(paths), (), ROBOT, DIGEST, 3, simple, propose=False, thresholds=False))
    found = {f["effect"]: f["parameters"] for f in answer.findings["findings"]}
    assert found["dropped_coupling"]["share"]["value"] == pytest.approx(1.0, abs=0.1)
    absent = sum(j.mass for j in ROBOT.joint[3:])
    assert found["payload"]["mass"]["value"] == pytest.approx(absent, rel=0.05)
    before, after = (np.array(answer.findings["fit"][k]) for k in ("before", "after"))
    assert np.all(after[1:] < 0.2 * before[1:])
    assert answer.model.variant == "full"
    assert load_text(observer_text(answer.model)).gravity([0.0, 0.0, 0.0])[1] < -50.0  # the whole arm's
    assert "ZZ1" in model_toml(answer.model)
