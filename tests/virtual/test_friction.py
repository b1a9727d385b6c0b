"""Friction: the sheet's numbers, sticking, and closed loops."""

import numpy as np
import pytest

from residuum.robots import load_robot
from residuum.virtual import NOISELESS, Plant, Position, Simulator, Torque
from residuum.virtual.assembly import MAXWELL
from residuum.virtual.friction import Bristle, Curve, Dahl, Drag, Friction, Stick, curves
from residuum.virtual.plant import BaseFriction

ROBOT, _ = load_robot("ur5e")
POSE = (0.0, -1.2, 1.4, -1.5, -1.4, 0.3)
DT = 1e-3


def joint_2(bristle=None, lag=0.0):
    curve = curves(ROBOT, BaseFriction())[1]
    return Friction(Drag(curve), curve.high, -curve.low, bristle or Stick(6.5, 3e-4), DT, lag)


def slide(friction, speed, seconds=0.2):
    return [friction.torque(0.0, speed, 0.0) for _ in range(int(seconds / DT))][-1]


@pytest.mark.parametrize(
    ("speed", "motor_torque"),
    [(-3.2, -0.219), (-1.5, -0.158), (-0.5, -0.106), (0.5, 0.107), (1.5, 0.160), (3.2, 0.210)],
)
def test_sliding_gives_the_factory_sheet_of_joint_2(speed, motor_torque):
    assert slide(joint_2(), speed) == pytest.approx(101 * motor_torque, abs=2e-3)


@pytest.mark.parametrize(("speed", "motor_torque"), [(-1e-3, -0.06557), (1e-3, 0.06376)])
def test_creeping_gives_the_factory_stiction(speed, motor_torque):
    assert slide(joint_2(), speed, 2.0) == pytest.approx(101 * motor_torque, abs=0.02)


def test_drag_never_falls_with_speed():
    for curve in curves(ROBOT, BaseFriction()):
        speed = np.linspace(-6, 6, 2001)
        assert np.diff(curve.drag(speed)).min() > -1e-12


def test_a_given_curve_is_met_at_its_points():
    curve = Curve(np.array([-1.0, 0.5, 2.0]), np.array([-4.0, 2.5, 5.0]), (-3.0, 2.0))
    np.testing.assert_allclose(curve.drag(np.array([-1.0, 0.0, 0.5, 2.0])), [-1.0, 0.0, 0.5, 3.0])


@pytest.mark.parametrize(
    "bristle",
    [Stick(6.0, 1e-3), Bristle(6.0, tuple((s, 0.02 * x) for s, x in MAXWELL))],
    ids=["stick", "maxwell"],
)
def test_closed_path_closes_its_loop_and_costs_work(bristle):
    path = 0.01 * np.sin(np.linspace(0, 6 * np.pi, 6001))
    torque = np.array([bristle.torque(step, 0.0, 6.0, 6.0) for step in np.diff(path)])
    turn = len(torque) // 3
    np.testing.assert_allclose(torque[turn : 2 * turn], torque[2 * turn :], atol=1e-9)
    assert np.sum(torque[turn : 2 * turn] * np.diff(path)[turn : 2 * turn]) > 0.01


def test_dahl_follows_its_equation():
    travel, steps = 0.01, 2000
    bristle, z, dx = Dahl(travel), 0.0, 1e-5
    for _ in range(steps):
        z += dx * (1 - z) / travel
        torque = bristle.torque(dx, 0.0, 5.0, 5.0)
    assert torque == pytest.approx(5.0 * z, rel=2e-3)
    assert bristle.torque(-1.0, 0.0, 5.0, 5.0) == pytest.approx(-5.0)


def test_presliding_depends_on_travel_not_on_rate():
    slow, fast = Stick(6.0, 1e-3), Stick(6.0, 1e-3)
    for _ in range(100):
        slow.torque(5e-6, 0.0, 6.0, 6.0)
    for _ in range(10):
        fast.torque(5e-5, 0.0, 6.0, 6.0)
    assert (
        slow.torque(0.0, 0.0, 6.0, 6.0)
        == pytest.approx(fast.torque(0.0, 0.0, 6.0, 6.0))
        == pytest.approx(3.0)
    )


def test_lag_keeps_the_old_direction():
    speeds = 20.0 * (0.1 - np.arange(0, 0.2, DT))
    crossings = []
    for lag in (0.0, 0.02):
        friction = joint_2(lag=lag)
        torque = np.array([friction.torque(0.0, v, 0.0) for v in speeds])
        crossings.append(np.flatnonzero(torque > 0)[-1] * DT)
    assert crossings[1] - crossings[0] == pytest.approx(0.02, abs=0.006)


def test_stiction_holds_without_creep():
    """Motors carry gravity and up to 80 % of stiction beside it: for 5 s nothing moves."""
    simulator = Simulator(ROBOT, Plant(sensing=NOISELESS), np.array(POSE))
    held = simulator.step(Position(POSE, (0.0,) * 6, (0.0,) * 6)).rtde["target_moment"]
    command = Torque(tuple(held + np.array([4.0, -5.0, 4.0, 1.1, -0.9, 0.9])))
    angles = np.array([simulator.step(command).truth["link_q"] for _ in range(3000)])
    assert np.abs(angles[-1] - angles[500]).max() < 1e-7
    assert np.abs(angles[-1] - angles[0]).max() < 1e-3


def test_beyond_stiction_it_slides():
    simulator = Simulator(ROBOT, Plant(sensing=NOISELESS), np.array(POSE))
    held = simulator.step(Position(POSE, (0.0,) * 6, (0.0,) * 6)).rtde["target_moment"]
    command = Torque(tuple(held + np.array([8.0, 0.0, 0.0, 0.0, 0.0, 0.0])))
    states = [simulator.step(command) for _ in range(500)]
    assert states[-1].truth["link_q"][0] - states[0].truth["link_q"][0] > 0.05
