"""What is fitted whatever is found: friction may start gently, but has no peak."""

import numpy as np
import pytest

from residuum.mismatch import naming
from residuum.mismatch.candidates import of_key
from residuum.mismatch.columns import NARROW
from residuum.mismatch.evidence import Evidence
from residuum.mismatch.judging import judge
from residuum.mismatch.naming import MUCH, PEAK, nuisance, scored
from residuum.mismatch.peaks import peak
from residuum.mismatch.refit import parameters


@pytest.fixture(scope="module")
def recorded(moved):
    """Dry friction of qd (T, 3) in Nm -> evidence without a reference."""

    def of(dry) -> Evidence:
        return moved(lambda qd: dry(qd) + 2.0 * qd, 0.15, seed=6)

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


def test_a_hypothesis_is_tested_at_the_value_that_its_own_weights_ask_for(recorded) -> None:
    evidence = recorded(lambda qd: np.sign(qd) * (5.0 + 2.5 * np.exp(-np.abs(qd) / 0.08)))
    model, each = nuisance(evidence), of_key(evidence.found.each, ("stribeck", 0))
    wide = max(each, key=lambda c: dict(c.values)["vs"])
    test, weighed = naming.tested(evidence, model, wide)
    assert dict(test.candidate.values)["vs"] == 0.08
    best = max(scored(weighed, model, each), key=lambda s: s.evidence)
    assert test.candidate == best.candidate != wide


def test_a_peak_of_a_tenth_of_the_level_gets_its_name(recorded) -> None:
    """Several shapes and soft signs that every gear may have a little of must not make it up together."""
    evidence = recorded(lambda qd: np.sign(qd) * (5.0 + 0.5 * np.exp(-np.abs(qd) / 0.07)))
    assert named(evidence) == {("stribeck", j) for j in range(3)}


@pytest.mark.parametrize("width", [0.005, 0.02])
def test_a_gentle_start_is_every_gears(recorded, width) -> None:
    """Sharper than a smooth sign bends, which a wide sign and a peak together would imitate."""
    assert named(recorded(lambda qd: 5.0 * np.clip(qd / width, -1, 1))) == set()
