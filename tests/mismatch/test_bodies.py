"""A change of masses is one that a body can make, or no name."""

from dataclasses import replace

import numpy as np
import pytest

from residuum.identify.physical import unlike_a_body
from residuum.mismatch import naming
from residuum.mismatch.bodies import bodiless
from residuum.mismatch.evidence import renewed
from residuum.mismatch.judging import judge

BALL = np.array([2.0, 0.1, 0.0, 0.2, 0.03, 0.04, 0.02, 0.0, -0.01, 0.0])  # kg, kg m, kg m^2
SURE = np.diag([1e4] * 4 + [1e6] * 6)


@pytest.mark.parametrize("part", [-0.5, 0.0, 3.0])
def test_a_body_may_lose_a_part_of_itself_or_grow(part) -> None:
    assert unlike_a_body(part * BALL, SURE, np.eye(10), BALL, 10.0) == pytest.approx(0.0, abs=0.01)


def test_what_is_not_there_cannot_be_taken_away() -> None:
    """Of 3 kg taken from 2 kg, at a known std of 0.01 kg, 2 kg are possible."""
    information = np.diag([1e4] + [1e-6] * 9)
    change = np.array([-3.0] + [0.0] * 9)
    assert unlike_a_body(change, information, np.eye(10), BALL, 10.0) == pytest.approx(
        0.5 * 1e4 * 1.0, rel=0.01
    )
    assert unlike_a_body(-0.1 * BALL, SURE, np.eye(10), np.zeros(10), 10.0) > 1.0


GROWN = np.array([15.0, 6.0, 0.0, 0.3, 1.0, 4.0, 4.0, 0.0, 0.0, 0.0])


@pytest.mark.parametrize(
    ("change", "believed"),
    [(GROWN, True), (-20 * np.array([0, 0, 0, 0, 1, 1, 1, 0, 0, 0]), False)],
    ids=["grown", "loses more inertia than it has"],
)
def test_a_link_can_lose_only_what_it_has(healthy, change, believed) -> None:
    setup, (rows,), link = healthy.setup, healthy.runs, 1
    assert setup.physics.links[link][0] == pytest.approx(8.058)  # kg, of UR's file
    moved = np.zeros(setup.space.size)
    moved[: len(setup.space.base)] = setup.physics.map.links[:, 10 * link : 10 * link + 10] @ change
    seen = [rows.columns[j] @ moved[setup.space.indices[j]] for j in range(setup.space.dof)]
    evidence = renewed(healthy, [replace(rows, torque=rows.torque + np.stack(seen, axis=1))])
    candidate = next(c for c in evidence.found.each if c.key == ("link_inertial", link))
    model = naming.nuisance(evidence)
    test, weighed = naming.tested(evidence, model, candidate)
    assert test.evidence > 20
    assert (bodiless(weighed, model, test) == "") == believed
    names = [a.score.candidate.effect for a in judge(evidence).accepted]
    assert ("link_inertial" in names) <= believed
