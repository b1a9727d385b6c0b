"""What is fitted whatever is found: published masses, and friction that may start gently, but has no peak."""

import numpy as np
import pytest

from residuum.codegen.generate import generate
from residuum.codegen.load import load_text
from residuum.mismatch.evidence import Evidence, gather
from residuum.mismatch.judging import judge
from residuum.mismatch.naming import MUCH, NARROW, PEAK, nuisance
from residuum.mismatch.peaks import peak
from residuum.mismatch.refit import parameters
from residuum.symbolic.nominal import nominal_model


@pytest.fixture(scope="module")
def recorded(arm, along):
    """(friction of qd (T, 3), the generated code of the arm that moves) -> evidence without a reference."""

    def of(friction, body=None) -> Evidence:
        time, rng = np.arange(0.0, 60.0, 0.008), np.random.default_rng(6)
        q, qd, qdd = along(time)
        torque = (body or arm.observer).inverse_dynamics(q, qd, qdd) + friction(qd) + 2.0 * qd
        noise = 0.15 * rng.standard_normal(q.shape)
        return gather([arm.recording(time, torque + noise)], [True], arm.model, arm.robot)

    return of


def named(evidence: Evidence) -> set[tuple[str, int | None]]:
    return {a.score.candidate.key for a in judge(evidence).accepted if a.is_finding}


@pytest.mark.parametrize("speed", [0.06, 0.1])
def test_a_peak_is_no_gentle_start_and_gets_its_name(recorded, speed) -> None:
    evidence = recorded(lambda qd: np.sign(qd) * (5.0 + 2.5 * np.exp(-np.abs(qd) / speed)))
    space, plain = evidence.setup.space, parameters(evidence, nuisance(evidence))
    for joint, level in enumerate(evidence.setup.friction[:, 0]):
        assert peak(space, plain, joint, ["coulomb"]) <= MUCH * level
        assert peak(space, plain, joint, ["coulomb"], NARROW) <= PEAK * level
    assert {("stribeck", j) for j in range(3)} <= named(evidence)


@pytest.mark.parametrize("width", [0.005, 0.02])
def test_a_gentle_start_is_every_gears(recorded, width) -> None:
    """Sharper than a smooth sign bends, which a wide sign and a peak together would imitate."""
    assert named(recorded(lambda qd: 5.0 * np.clip(qd / width, -1, 1))) == set()


def test_a_link_that_is_a_tenth_heavier_is_another_link(arm, recorded) -> None:
    first, second, *rest = arm.robot.joint
    second = second.model_copy(update={"mass": 1.1 * second.mass})
    heavier = arm.robot.model_copy(update={"joint": (first, second, *rest)})
    body = load_text(generate(nominal_model(heavier, "", 3)).files["observer.py"])
    found = named(recorded(lambda qd: 5.0 * np.tanh(qd / 1e-3), body))
    assert found == {("link_inertial", 1)}
