"""The arm's own controller in lock step: servo, speed control, stop, freedrive."""

import numpy as np
import pytest

from residuum.robots import load_robot
from residuum.virtual import (
    NOISELESS,
    Contact,
    Freedrive,
    Plant,
    Position,
    Simulator,
    Speed,
    Stop,
    Torque,
    foam,
    simulate,
)
from residuum.virtual import effects as e
from residuum.virtual.motions import fourier

ROBOT, _ = load_robot("ur5e")
POSE = (0.3, -1.2, 1.4, -1.5, -1.4, 0.3)
REST = (0.0,) * 6
HOLD = Position(POSE, REST, REST)
GAIN = np.array([joint.drive_gain for joint in ROBOT.joint])


def arm(**plant):
    return Simulator(ROBOT, Plant(sensing=NOISELESS, **plant), np.array(POSE))


def test_servo_follows_within_a_milliradian_like_a_real_arm():
    recording = simulate(ROBOT, Plant(), fourier(ROBOT, 6.0, seed=4)).recording
    error = np.abs(recording["target_q"] - recording["actual_q"])
    assert 1e-4 < error.max() < 1e-3


def test_servo_removes_the_sag_of_an_unknown_payload():
    simulator = arm(payload=e.Payload(mass=3.0, centre_of_mass=(0, 0, 0.05)))
    state = simulator.step(HOLD)
    np.testing.assert_allclose(state.rtde["actual_q"], POSE, atol=5e-5)


def test_targets_are_the_nominal_model():
    state = arm(payload=e.Payload(mass=3.0)).step(HOLD)
    np.testing.assert_allclose(state.rtde["target_current"] * GAIN, state.rtde["target_moment"], atol=1e-9)
    np.testing.assert_allclose(state.rtde["target_q"], POSE)


def test_torque_saturates():
    simulator = arm()
    far = Position((POSE[0] + 1.0, *POSE[1:]), REST, REST)
    simulator.step(far)
    assert simulator.step(far).truth["motor"][0] == pytest.approx(ROBOT.joint[0].max_torque)


def test_speed_ramps_and_stop_stops_and_holds():
    simulator = arm()
    speed = Speed((0.5, 0.0, 0.0, 0.0, 0.0, 0.0), acceleration=2.0)
    states = [simulator.step(speed) for _ in range(400)]
    ramp = [s.rtde["target_qd"][0] for s in states]
    assert np.argmax(np.array(ramp) > 0.499) * 0.002 == pytest.approx(0.25, abs=0.006)
    assert states[-1].truth["link_qd"][0] == pytest.approx(0.5, abs=2e-3)
    states = [simulator.step(Stop(deceleration=5.0)) for _ in range(500)]
    stopped = np.argmax([abs(s.truth["link_qd"][0]) < 2e-3 for s in states]) * 0.002
    assert 0.08 < stopped < 0.2
    assert abs(states[-1].truth["link_q"][0] - states[300].truth["link_q"][0]) < 2e-5


def test_limited_speed_pushes_no_harder_than_told():
    simulator = arm()
    tip = simulator.where(6)
    way = np.cross([0.0, 0.0, 1.0], tip) / np.hypot(*tip[:2])
    simulator.add_obstacle(foam(tuple(tip + 0.01 * way), tuple(-way)))
    command = Speed((0.3, 0, 0, 0, 0, 0), 2.0, torque=(25.0,) * 6)
    states = [simulator.step(command) for _ in range(1500)]
    beside = [(s.truth["motor"] - s.rtde["target_current"] * GAIN)[0] for s in states]
    assert max(np.abs(beside)) <= 25.0 + 1e-9 and beside[-1] > 24.9
    pushed = np.array([s.truth["external"][0] for s in states])
    assert -40.0 < pushed[-1] < -15.0  # friction and its feed-forward come on top
    assert abs(pushed[-1] - pushed[-200]) < 0.5


def test_freedrive_stays_where_it_is_and_yields_to_a_hand():
    push = Contact(start=1.0, end=2.5, force=(0.0, 25.0, 0.0), profile="hold", edge=0.2)
    simulator = arm(external_contact=(push,))
    angle = np.array([simulator.step(Freedrive()).truth["link_q"][0] for _ in range(2500)])
    assert abs(angle[490] - angle[100]) < 1e-4
    assert abs(angle[1250] - angle[500]) > 0.1
    assert abs(angle[-1] - angle[-250]) < 1e-3


def test_freedrive_with_an_unknown_payload_sinks():
    simulator = arm(payload=e.Payload(mass=5.0, centre_of_mass=(0, 0, 0.1)))
    height = simulator.where(6)[2]
    for _ in range(500):
        simulator.step(Freedrive())
    assert simulator.where(6)[2] < height - 0.02


def test_taking_over_from_freedrive_does_not_jump():
    simulator = arm()
    for _ in range(50):
        simulator.step(Freedrive())
    before = simulator.step(Freedrive())
    states = [simulator.step(Stop()) for _ in range(100)]
    moved = max(np.abs(s.truth["link_q"] - before.truth["link_q"]).max() for s in states)
    assert moved < 1e-3


def test_bare_torque_is_bare():
    state = arm().step(Torque((1.0, 2.0, 3.0, 0.4, 0.5, 0.6)))
    np.testing.assert_allclose(state.truth["motor"], (1.0, 2.0, 3.0, 0.4, 0.5, 0.6), atol=1e-12)


def test_leaving_physics_is_an_error():
    simulator = arm(friction={"kind": "none"})
    with pytest.raises(FloatingPointError, match="left physics at"):
        for _ in range(5000):
            simulator.step(Torque((0.0, 0.0, 0.0, 0.0, 0.0, 28.0)))
