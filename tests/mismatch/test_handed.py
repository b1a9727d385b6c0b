"""The model that is handed over: what is named, and with a reference the friction that was there before."""

from dataclasses import replace

import numpy as np
import pytest

from residuum.mismatch.evidence import Evidence, evenly_weighed, gather
from residuum.mismatch.handed import handed, shapes_of
from residuum.mismatch.judging import judge
from residuum.mismatch.naming import reweighed
from residuum.mismatch.proof import prove


@pytest.fixture(scope="module")
def changed(arm, along) -> Evidence:
    """An arm whose joint 2 has drag that bends, before and after; joint 1 has got 1.5 Nm more dry friction."""
    rng, recordings = np.random.default_rng(8), []
    for run, more in enumerate((0.0, 0.0, 1.5, 1.5)):
        time = np.arange(0.0, 40.0, 0.008) + 60.0 * run
        q, qd, qdd = along(time)
        friction = np.array([5.0 + more, 6.0, 4.0]) * np.sign(qd) + 2.0 * qd
        friction[:, 1] += 3.0 * qd[:, 1] * np.abs(qd[:, 1])
        torque = arm.observer.inverse_dynamics(q, qd, qdd) + friction + 0.2 * rng.standard_normal(q.shape)
        recordings.append(replace(arm.recording(time, torque), name=f"run {run}"))
    return gather(recordings, [False, False, True, True], arm.model, arm.robot)


def test_the_healthy_robots_friction_is_in_the_model_and_no_finding(changed) -> None:
    found = [a for a in judge(changed).accepted if a.is_finding]
    assert [a.score.candidate.key for a in found] == [("coulomb_friction", 0)]
    shapes = shapes_of(changed, found)
    assert {c.joint for c in shapes} == {1}
    assert "nonlinear_viscous" in {c.effect for c in shapes}
    model = handed(changed, found, shapes)
    fair = reweighed(evenly_weighed(changed), model, even=True)
    proof, _, _ = prove(fair, model, model, fair)
    assert proof.after[0] < 0.3 * proof.before[0]
    assert proof.after[1:] == pytest.approx(proof.before[1:], rel=1e-3)
    assert proof.after[1] < 0.15  # of white noise of 0.2 Nm a low-pass leaves less


def test_without_a_reference_what_is_missing_is_a_finding(healthy) -> None:
    assert shapes_of(healthy, ()) == ()
