"""Contacts and obstacles: the stated law, in the stated units."""

import numpy as np
import pytest
from pydantic import ValidationError

from residuum.robots import load_robot
from residuum.virtual import (
    NOISELESS,
    Contact,
    Obstacle,
    Plant,
    Simulator,
    Speed,
    Stop,
    clamped_hand,
    foam,
)

ROBOT, _ = load_robot("ur5e")
POSE = (0.3, -1.2, 1.4, -1.5, -1.4, 0.3)


def test_profiles_are_smooth_and_end():
    smooth, hold = (Contact(start=1.0, end=2.0, profile=p, edge=0.1) for p in ("smooth", "hold"))
    time = np.linspace(0.9, 2.1, 1201)
    for contact in (smooth, hold):
        strength = np.array([contact.strength(t) for t in time])
        assert strength.max() == pytest.approx(1.0)
        assert strength[0] == strength[-1] == 0.0
        assert np.abs(np.diff(strength)).max() < 0.02
    assert hold.strength(1.15) == 1.0 > smooth.strength(1.15)


def test_obstacle_pushes_and_never_pulls():
    thing = Obstacle(place=(0, 0, 0), normal=(1, 0, 0), stiffness=1e4, damping=100.0, thickness=0.02)
    assert thing.force(0.0, 1.0) == thing.force(-0.01, 0.0) == 0.0
    assert thing.force(0.01, 0.0) == pytest.approx(100.0)
    assert thing.force(0.01, 0.5) == pytest.approx(150.0)
    assert thing.force(0.001, 0.5) == pytest.approx(10.0 + 25.0)
    assert thing.force(0.01, -5.0) == 0.0
    assert thing.force(0.021, 0.0) == pytest.approx(210.0 + 100.0)


@pytest.mark.parametrize(
    "wrong", [{"normal": (0, 0, 0)}, {"stiffness": -1.0}, {"damping": -1.0}, {"colour": 1}]
)
def test_impossible_obstacles_are_refused(wrong):
    with pytest.raises(ValidationError):
        Obstacle(**({"place": (0, 0, 0), "normal": (1, 0, 0), "stiffness": 1.0} | wrong))


def collide(make, distance=0.02):
    simulator = Simulator(ROBOT, Plant(sensing=NOISELESS), np.array(POSE))
    way = np.cross([0, 0, 1.0], simulator.where(6))
    way /= np.linalg.norm(way)
    face = simulator.where(6) + distance * way
    simulator.add_obstacle(make(tuple(face), tuple(-way)))
    states = []
    for _ in range(600):
        hit = bool(states) and abs(states[-1].truth["external"][0]) > 10.0
        stopping = hit or (bool(states) and isinstance(command, Stop))  # noqa: F821
        command = Stop(10.0) if stopping else Speed((0.25, 0, 0, 0, 0, 0), 1.0)
        states.append(simulator.step(command))
    return simulator, states, face, way


@pytest.mark.parametrize("make", [foam, clamped_hand])
def test_collision_obeys_the_stated_law(make):
    simulator, states, face, way = collide(make)
    force = np.array([s.truth["flange"][:3] @ -way for s in states])
    first = np.argmax(force > 0)
    reach = np.linalg.norm(np.cross([0, 0, 1.0], simulator.where(6)))
    assert np.abs(force[: first - 1]).max() == 0.0 < force.max() < 400.0
    depth = float((simulator.where(6) - face) @ way)
    assert force[-1] == pytest.approx(
        make(tuple(face), tuple(-way)).stiffness * max(depth, 0.0), rel=0.02, abs=0.1
    )
    torque = np.array([s.truth["external"][0] for s in states])
    np.testing.assert_allclose(torque[-1], -reach * force[-1], rtol=0.02, atol=0.1)


def test_a_hard_thing_is_hit_harder():
    peaks = [max(abs(s.truth["external"][0]) for s in collide(make)[1]) for make in (foam, clamped_hand)]
    assert peaks[1] > 1.5 * peaks[0]


def test_contact_takes_energy_out_of_the_arm():
    _, states, _, _ = collide(foam)
    power = np.array([s.truth["external"] @ s.truth["link_qd"] for s in states])
    assert power.sum() * 0.002 < -1e-3


def test_obstacles_can_be_taken_away():
    simulator, states, _, _ = collide(foam)
    assert abs(states[-1].truth["external"][0]) > 1.0
    simulator.clear_obstacles()
    assert np.abs(simulator.step(Stop()).truth["external"]).max() == 0.0
