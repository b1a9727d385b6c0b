"""What comes late on one joint: its current with all that it carries, or its friction alone."""

import numpy as np
import pytest
from terms_by_hand import built_up_by_hand

from residuum.mismatch.candidates import of_key
from residuum.mismatch.evidence import gather
from residuum.mismatch.naming import chosen, nuisance, reweighed, scored
from residuum.mismatch.plausibility import of_friction

JOINT, LATE, STEP = 1, 0.016, 0.008  # s: two samples


@pytest.fixture(scope="module")
def tested(arm, along):
    """What is late -> a late current as a hypothesis on the joint, with the rows that it leaves."""
    time = np.arange(0.0, 60.0, STEP)
    q, qd, qdd = along(time)
    rigid = arm.observer.inverse_dynamics(q, qd, qdd)
    friction, steps = 2.0 * qd, np.full(len(time), STEP)
    for j in range(3):
        friction[:, j] += 5.0 * built_up_by_hand({"zs": 3e-4, "width": 1e-4}, q[:, j], qd[:, j], steps)

    def of(what: str):
        torque, samples = rigid + friction, round(LATE / STEP)
        late = {"friction": friction, "current": torque}[what][:, JOINT]
        torque[:, JOINT] += np.roll(late, samples) - late
        noise = 0.1 * np.random.default_rng(1).standard_normal(q.shape)
        some = slice(samples, None)
        rec = arm.recording(time[some], (torque + noise)[some], q[some], qd[some])
        evidence = gather([rec], [True], arm.model, arm.robot)
        model, each = nuisance(evidence), of_key(evidence.found.each, ("time_delay", JOINT))
        best = max(scored(evidence, model, each), key=lambda s: s.evidence)
        weighed = reweighed(evidence, chosen(model, evidence, best.candidate))
        return weighed, model, scored(weighed, model, [best.candidate])[0]

    return of


def test_a_late_current_is_not_its_friction(tested) -> None:
    weighed, model, test = tested("current")
    assert of_friction(weighed, model, test) == ""
    assert test.size[0] == pytest.approx(LATE, rel=0.15)


def test_late_friction_is_no_late_current(tested) -> None:
    assert "friction alone" in of_friction(*tested("friction"))
