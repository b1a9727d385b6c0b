"""The generated URScript guard in closed loop: interpreter and physics in lock step, nothing in between."""

import pytest

from residuum.collisions.cells import Cell
from residuum.collisions.in_script import guard_run

STATES = {1: (1, 2, 3, 5), 2: (1, 2, 3, 6), 3: (1, 2, 3, 4, 6)}


@pytest.mark.slow
@pytest.mark.parametrize("strategy", [1, 2, 3])
def test_it_guards_detects_and_reacts(robot, model, strategy) -> None:
    run = guard_run(robot, Cell(1, "slow"), strategy, model)
    assert run.states == STATES[strategy]
    assert not run.figures.early
    assert run.figures.joint == 1
    assert 0.0 < run.figures.delay < 0.0725
    assert run.figures.peak < 60.0
