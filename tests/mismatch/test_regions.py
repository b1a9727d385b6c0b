"""Places of what is left: the variable, its range, and silence about noise."""

import numpy as np
from rows_by_hand import ar1, rows

from residuum.mismatch.regions import regions

LONG = 4000


def test_a_bump_at_one_angle_is_found_there() -> None:
    run = rows(LONG)
    left = 0.2 * ar1(LONG, 0.5, np.random.default_rng(1))
    left[:, 1] += 2.0 * (np.abs(run.q[:, 1] - 0.8) < 0.25)
    (found,) = regions([run], ["a.csv"], [left], 101.0)
    assert (found.joint, found.variable, found.unit, found.recording) == (2, "q", "rad", "a.csv")
    assert found.share > 0.6
    assert 0.3 < found.low < 0.8 < found.high < 1.3
    assert all(a <= b for a, b in found.intervals)


def test_friction_that_is_missing_sits_along_speed() -> None:
    run = rows(LONG)
    left = 0.2 * ar1(LONG, 0.5, np.random.default_rng(2))
    left[:, 0] += run.qd[:, 0] * np.abs(run.qd[:, 0])
    assert [(r.joint, r.variable) for r in regions([run], ["a"], [left], 101.0)] == [(1, "qd")]


def test_noise_has_no_place() -> None:
    for seed in range(4):
        noise = ar1(LONG, 0.9, np.random.default_rng(seed))
        shares = [r.share for r in regions([rows(LONG)], ["a"], [noise], 101.0) if r.variable != "t"]
        assert not shares or max(shares) < 0.1


def test_the_stronger_recording_is_named() -> None:
    """What is there for a part of the time only sits along time, in the recording that has it."""
    runs = [rows(LONG), rows(LONG)]
    left = [0.2 * ar1(LONG, 0.5, np.random.default_rng(k)) for k in (3, 4)]
    left[1][:, 0] += 3.0
    (found,) = [r for r in regions(runs, ["one", "two"], left, 101.0) if r.joint == 1]
    assert (found.variable, found.recording) == ("t", "two")


def test_a_variable_that_never_changes_is_no_place() -> None:
    """A constant torque sits everywhere; the temperature of these rows is one number."""
    left = 3.0 + 0.2 * ar1(LONG, 0.5, np.random.default_rng(5))
    assert "temperature" not in {r.variable for r in regions([rows(LONG)], ["a"], [left], 101.0)}


def test_a_joint_that_hardly_moves_has_none() -> None:
    moving = np.zeros((LONG, 2))
    assert regions([rows(LONG, moving=moving)], ["a"], [np.ones((LONG, 2))], 101.0) == []
