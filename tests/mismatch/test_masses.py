"""How far off masses may be: a body stands out of published ones, and not where all of them are off."""

import numpy as np
import pytest

from residuum.mismatch.judging import judge
from residuum.mismatch.masses import MASSES_OFF, all_off, concealed
from residuum.mismatch.naming import TIGHT, nuisance


@pytest.fixture(scope="module")
def recorded(arm, moved):
    """Which number of all six joints, how many times as large -> evidence without a reference."""

    def of(field, times):
        return moved(lambda qd: 5.0 * np.tanh(qd / 1e-3) + 2.0 * qd, 0.15, 6, arm.scaled(field, times))

    return of


def named(evidence) -> set[tuple[str, int | None]]:
    return {a.score.candidate.key for a in judge(evidence).accepted if a.is_finding}


def test_a_rotor_stands_out_of_published_masses(recorded) -> None:
    evidence = recorded("rotor_inertia", (1.0, 1.5, 1.0, 1.0, 1.0, 1.0))
    assert {a.score.candidate.key for a in judge(evidence, masses=(TIGHT,)).accepted} == set()
    assert named(evidence) == {("rotor_inertia", 1)}


def test_masses_that_are_all_off_are_no_body(recorded) -> None:
    evidence = recorded("mass", (0.95, 1.06, 0.92, 1.07, 0.94, 1.08))
    assert all_off(evidence, nuisance(evidence, MASSES_OFF[0]), None, MASSES_OFF)
    judged = judge(evidence)
    assert not [a for a in judged.accepted if a.is_finding]
    assert "1.5 % of a base parameter" in concealed(judged.masses_off)[0]


def test_published_masses_are_not_off(recorded) -> None:
    evidence = recorded("mass", (1.0,) * 6)
    assert not all_off(evidence, nuisance(evidence, MASSES_OFF[0]), None, MASSES_OFF)
    judged = judge(evidence)
    assert judged.accepted == () == concealed(judged.masses_off)


def test_what_masses_that_are_off_conceal_is_said() -> None:
    (some,), (free,) = concealed(0.1), concealed(1.0)
    assert "by less than 5 % of a base parameter" in some
    assert "%" not in free
