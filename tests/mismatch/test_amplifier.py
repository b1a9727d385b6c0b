"""Friction's level and an amplifier's dead band: told apart where a joint carries something, and else said."""

import numpy as np
import pytest

from residuum.mismatch.amplifier import hidden_amplifiers
from residuum.mismatch.evidence import gather
from residuum.mismatch.judging import judge
from residuum.mismatch.naming import reweighed

LEVELS = np.array([5.0, 6.0, 4.0])


@pytest.mark.parametrize(("joint", "hidden"), [(0, True), (1, False)])
def test_a_level_is_told_from_a_dead_band_where_the_joint_carries_something(
    arm, recorded_arm, joint, hidden
) -> None:
    def friction(more):
        return lambda qd: (LEVELS + more * (np.arange(3) == joint)) * np.tanh(qd / 1e-3) + 2.0 * qd

    runs = [recorded_arm(friction(0.5), 0.1, 3), recorded_arm(friction(0.0), 0.1, 4)]
    evidence = gather(runs, [True, False], arm.model, arm.robot)
    judged = judge(evidence)
    assert [a.score.candidate.key for a in judged.accepted] == [("coulomb_friction", joint)]
    said = hidden_amplifiers(reweighed(evidence, judged.model), judged)
    assert [f"joint {joint + 1}'s" in text for text in said] == [True] * hidden
