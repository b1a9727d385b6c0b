"""A load that is held for a moment is told from a push by what one mass explains of all its instants."""

from dataclasses import replace

import numpy as np
import pytest

from residuum.mismatch.physics import forces, levers, physics_of
from residuum.mismatch.weight import Touch, weight_of
from residuum.robots import load_robot
from residuum.symbolic.nominal import nominal_model

STEP, COUNT, NOISE, MASS = 0.02, 100, 0.05, 0.2
GRAVITY = np.array([0.0, 0.0, -9.81])
CENTRE = np.array([0.02, -0.03, 0.1])


@pytest.fixture(scope="module")
def physics():
    robot, digest = load_robot("ur5e")
    return physics_of(nominal_model(robot, digest, 6), robot)


@pytest.fixture(scope="module")
def touched(physics):
    """Torque (n, 6) by place and force -> what is there while an arm moves, slowly enough for statics."""

    def of(force, place, frame=6, count=COUNT):
        q = np.array([0.0, -1.2, 1.3, -1.5, -1.5, 0.0]) + 0.4 * np.sin(
            STEP * np.arange(count)[:, None] * np.ones(6) + np.arange(6)
        )
        at, arms = forces(physics, q, 6), levers(physics, q, 6)
        mass, moments = at @ GRAVITY, np.einsum("tjia,i->tja", arms, GRAVITY)
        columns = np.concatenate([mass[:, :, None], moments, np.zeros((count, 6, 6))], axis=2)
        acts = forces(physics, q, frame) + levers(physics, q, frame) @ np.asarray(place)
        noise = NOISE * np.random.default_rng(1).normal(size=(count, 6))
        left = acts @ np.asarray(force) + noise
        return Touch(q, left, np.full((count, 6), NOISE), columns, np.ones((count, 6), bool), STEP)

    return of


def test_a_load_that_is_held_for_two_seconds_has_its_mass_and_its_centre(physics, touched) -> None:
    weight = weight_of(physics, [touched(MASS * GRAVITY, CENTRE)])
    assert weight is not None
    assert abs(weight.value[0] - MASS) < 4 * np.sqrt(weight.covariance[0, 0])
    assert weight.value[0] == pytest.approx(MASS, rel=0.05)


def test_two_moments_of_one_load_are_as_good(physics, touched) -> None:
    half = touched(MASS * GRAVITY, CENTRE, count=COUNT // 3)
    assert weight_of(physics, [half]) is None  # too short by itself
    assert weight_of(physics, [half, half]) is not None


@pytest.mark.parametrize(
    ("force", "frame"),
    [((0.0, 3.0, 0.0), 6), ((2.0, 0.0, -1.0), 6), ((0.0, 0.0, 2.0), 6), ((1.0, 1.0, -2.0), 4)],
)
def test_a_push_is_no_load(physics, touched, force, frame) -> None:
    assert weight_of(physics, [touched(force, CENTRE, frame)]) is None


def test_what_one_joint_alone_shows_is_no_load(physics, touched) -> None:
    load = touched(MASS * GRAVITY, CENTRE)
    alone = np.zeros_like(load.moving)
    alone[:, 1] = True
    assert weight_of(physics, [replace(load, moving=alone)]) is None


def test_what_is_far_away_is_in_no_gripper(physics, touched) -> None:
    assert weight_of(physics, [touched(MASS * GRAVITY, 8 * CENTRE)]) is None
