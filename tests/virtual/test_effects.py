"""Effects of bodies, gears, drives, sensors and contact change what they should, by as much, and nothing else."""

import mujoco
import numpy as np
import pytest
from effect_runs import FREE, GAIN, MOTION, POSE, QUIET, ROBOT, change, only, rms

from residuum.virtual import Contact, Plant, Simulator, Torque, simulate
from residuum.virtual import effects as e
from residuum.virtual.model import build_model, tilted_gravity
from residuum.virtual.motions import still, sweep
from residuum.virtual.plant import BaseFriction


def inverse(model, q, qd, qdd):
    data, rows = mujoco.MjData(model), []
    for a, b, c in zip(q, qd, qdd, strict=True):
        data.qpos[:], data.qvel[:], data.qacc[:] = a, b, c
        mujoco.mj_inverse(model, data)
        rows.append(data.qfrc_inverse.copy())
    return np.array(rows)


def test_switched_off_means_off():
    assert rms(change().torque).max() == 0.0


def test_healthy_arm_obeys_the_nominal_model():
    run = simulate(ROBOT, Plant(**FREE), MOTION)
    torque = run.recording["actual_current"] * GAIN
    np.testing.assert_allclose(rms(torque - run.recording["target_moment"]), 0.0, atol=0.05)


def test_truth_adds_up_to_the_last_digit():
    """Motor torque - friction = rigid body with rotors at the true motion (one substep: qdd is exact)."""
    rows = simulate(ROBOT, Plant(**QUIET, substeps=1), MOTION).truth.rows
    qdd = np.diff(rows.link_qd, axis=0) / 0.002
    rigid = inverse(build_model(ROBOT), rows.link_q[:-1], rows.link_qd[:-1], qdd)
    np.testing.assert_allclose((rows.motor - rows.friction)[:-1], rigid, atol=1e-8)
    assert rms(rows.friction).min() > 1.0


def height(q, payload) -> float:
    return Simulator(ROBOT, start=q).where(6, payload.centre_of_mass)[2]


def test_payload_adds_its_static_moment_to_proximal_joints():
    payload = e.Payload(mass=2.0, centre_of_mass=(0.0, 0.02, 0.06), inertia=(0.01, 0.01, 0.01, 0, 0, 0))
    plants = (Plant(friction=BaseFriction(kind="none"), payload=p) for p in (None, payload))
    bare, loaded = (simulate(ROBOT, plant, still(POSE, 2.0), seed=4).recording for plant in plants)
    added = (loaded["actual_current"] - bare["actual_current"]).mean(0) * GAIN
    weight, h = 2.0 * 9.81, 1e-3
    expected = [
        weight * (height(POSE + h * axis, payload) - height(POSE - h * axis, payload)) / (2 * h)
        for axis in np.eye(6)
    ]
    noise = 4.0 * np.array(Plant().sensing.current_noise) * GAIN * np.sqrt(2 / 1000)
    assert np.all(np.abs(added - expected) < noise + 1e-3)
    assert abs(expected[1]) > 5.0
    force = loaded["actual_TCP_force"].mean(0)
    arm = Simulator(ROBOT, start=np.array(POSE)).frame(6)[1] @ np.array(payload.centre_of_mass)
    np.testing.assert_allclose(force[:3], [0, 0, -weight], atol=0.2)
    np.testing.assert_allclose(force[3:], np.cross(arm, [0, 0, -weight]), atol=0.01)


def test_declared_payload_is_expected_by_the_controller():
    payload = e.Payload(mass=2.0, centre_of_mass=(0, 0, 0.05), declared=True)
    run = simulate(ROBOT, Plant(**FREE, payload=payload), still(POSE, 0.5)).recording
    np.testing.assert_allclose(run["actual_current"][-1], run["target_current"][-1], atol=1e-3)
    np.testing.assert_allclose(run["actual_TCP_force"], 0.0, atol=1e-9)


def test_payload_is_taken_and_left_in_time():
    payload = e.Payload(mass=1.5, intervals=((1.0, 2.0),))
    run = simulate(ROBOT, Plant(**FREE, payload=payload), still(POSE, 3.0))
    current, force = run.recording["actual_current"][:, 1], run.recording["actual_TCP_force"][:, 2]
    assert abs(current[950] - current[450]) > 0.3
    assert current[1490] == pytest.approx(current[450], abs=5e-3)
    np.testing.assert_allclose(force[[450, 980, 1490]], [0, -1.5 * 9.81, 0], atol=0.05)


def test_link_inertial_is_the_altered_model():
    c = change(link_inertial=(e.LinkInertial(link=3, mass=0.4, centre_of_mass=(0.02, 0.0, 0.01)),))
    data = ROBOT.joint[2]
    altered = data.model_copy(update={"mass": data.mass + 0.4, "centre_of_mass": (0.17, 0.0, 0.0365)})
    robot = ROBOT.model_copy(update={"joint": (*ROBOT.joint[:2], altered, *ROBOT.joint[3:])})
    difference = inverse(build_model(robot), c.q, c.qd, c.qdd) - inverse(build_model(ROBOT), c.q, c.qd, c.qdd)
    assert rms(c.torque - difference).max() < 0.03 * rms(difference).max()
    only(c.torque, (1, 2, 3))


def test_base_tilt_gives_joint_1_a_torque():
    c = change(base_tilt=e.BaseTilt(roll=0.03, pitch=0.02))
    turned = ROBOT.model_copy(update={"gravity": tuple(tilted_gravity(ROBOT.gravity, 0.03, 0.02))})
    difference = inverse(build_model(turned), c.q, c.qd, c.qdd) - inverse(
        build_model(ROBOT), c.q, c.qd, c.qdd
    )
    assert rms(difference)[0] > 0.3
    assert rms(c.torque - difference).max() < 0.03 * rms(difference).max()


def test_rotor_inertia_follows_acceleration():
    c = change(rotor_inertia=(e.RotorInertia(joint=2, share=0.3),))
    expected = 0.3 * ROBOT.joint[1].reflected_inertia * c.qdd[:, 1]
    assert rms(c.torque[:, 1] - expected) < 0.05 * rms(expected)
    only(c.torque, (2,))


def test_drive_gain_scales_one_joint():
    weak = simulate(ROBOT, Plant(**FREE, drive_gain=(e.DriveGain(joint=3, error=-0.1),)), MOTION).recording
    right = simulate(ROBOT, Plant(**FREE), MOTION).recording
    np.testing.assert_allclose(0.9 * weak["actual_current"][:, 2], right["actual_current"][:, 2], atol=0.02)
    np.testing.assert_allclose(weak["actual_current"][:, 1], right["actual_current"][:, 1], atol=0.01)


@pytest.mark.parametrize(("speed", "order"), [(0.2, 2.0), (0.5, 1.0)])
def test_ripple_frequency_follows_speed(speed, order):
    motion = sweep(1, POSE, 0.0, 0.8, (speed,))
    effect = (e.TorqueRipple(joint=1, torque=0.6, order=order),)
    rows = simulate(ROBOT, Plant(**FREE, torque_ripple=effect), motion).truth.rows
    steady = np.flatnonzero(motion.qd[:, 0] > speed - 1e-6)[50:-5]
    wave = rows.motor[steady, 0]
    power = np.abs(np.fft.rfft((wave - wave.mean()) * np.hanning(len(wave)), 8 * len(wave)))
    frequency = np.fft.rfftfreq(8 * len(wave), 0.002)[np.argmax(power)]
    assert frequency == pytest.approx(order * 101 * speed / (2 * np.pi), rel=0.02)
    assert np.ptp(wave) / 2 == pytest.approx(0.6, rel=0.35)


def one_elastic_joint(**effect):
    """Joint 1 alone, with 5 kg at 0.5 m: gravity does not act on it."""
    robot = ROBOT.model_copy(update={"joint": ROBOT.joint[:1]})
    load = e.Payload(mass=5.0, centre_of_mass=(0.5, 0.0, 0.0))
    simulator = Simulator(robot, Plant(**FREE, payload=load, **effect), np.zeros(1))
    full = np.zeros((1, 1))
    mujoco.mj_fullM(simulator._model, simulator._data, full)
    return simulator, float(full[0, 0] - simulator._model.dof_armature[0])


def test_elastic_joint_rings_at_its_natural_frequency():
    stiffness = 4000.0
    gear = (e.JointElasticity(joint=1, stiffness=stiffness, damping=0.0),)
    simulator, link = one_elastic_joint(joint_elasticity=gear)
    rotor = ROBOT.joint[0].reflected_inertia
    for _ in range(5):
        simulator.step(Torque((20.0,)))
    load = np.array([simulator.step(Torque((0.0,))).truth["gear"][0] for _ in range(2000)])
    spectrum = np.abs(np.fft.rfft(load * np.hanning(len(load)), 16 * len(load)))
    frequency = np.fft.rfftfreq(16 * len(load), 0.002)[np.argmax(spectrum)]
    assert frequency == pytest.approx(np.sqrt(stiffness * (1 / rotor + 1 / link)) / (2 * np.pi), rel=0.01)
    assert np.ptp(load[-200:]) > 0.95 * np.ptp(load[:200])  # an undamped spring loses nothing


def test_elastic_joint_winds_up_by_torque_over_stiffness():
    gear = tuple(e.JointElasticity(joint=j, stiffness=5000.0, damping=150.0) for j in (1, 2, 3, 4, 5, 6))
    run = simulate(ROBOT, Plant(**QUIET, joint_elasticity=gear), still(POSE, 1.0))
    rows = run.truth.rows
    np.testing.assert_allclose(rows.q[-1] - rows.link_q[-1], rows.gear[-1] / 5000.0, atol=1e-6)
    np.testing.assert_allclose(run.recording["actual_q"][-1], POSE, atol=1e-4)


def test_backlash_jumps_when_the_load_changes_sign():
    gap = 2e-3
    simulator, _ = one_elastic_joint(backlash=(e.Backlash(joint=1, gap=gap),))
    apart = []
    for torque in (10.0, -10.0):
        states = [simulator.step(Torque((torque,))) for _ in range(150)]
        apart.append(np.mean([s.rtde["actual_q"][0] - s.truth["link_q"][0] for s in states[100:]]))
    assert apart[0] - apart[1] == pytest.approx(2 * gap, rel=0.25)
    assert min(apart[0], -apart[1]) > gap


def test_cable_spring_depends_on_angle_alone():
    c = change(cable_spring=(e.CableSpring(joint=4, stiffness=0.8, rest=-1.0, constant=0.2),))
    np.testing.assert_allclose(c.torque[:, 3], 0.8 * (c.q[:, 3] + 1.0) - 0.2, atol=0.03)
    only(c.torque, (4,), 0.05)


def test_encoder_offset_moves_the_arm_not_the_reading():
    offset = 0.02
    run = simulate(
        ROBOT, Plant(**FREE, encoder_offset=(e.EncoderOffset(joint=2, offset=offset),)), still(POSE, 1.0)
    )
    rows, recorded = run.truth.rows, run.recording
    np.testing.assert_allclose(recorded["actual_q"][-1], POSE, atol=1e-5)
    assert rows.link_q[-1, 1] == pytest.approx(POSE[1] - offset, abs=1e-5)
    true = inverse(build_model(ROBOT), rows.link_q[-1:], np.zeros((1, 6)), np.zeros((1, 6)))[0]
    np.testing.assert_allclose(recorded["actual_current"][-1] * GAIN, true, atol=0.02)


def test_current_offset_is_there_at_rest_too():
    c = change(QUIET, current_offset=(e.CurrentOffset(joint=6, offset=0.1),))
    np.testing.assert_allclose(c.torque / GAIN, np.tile([0, 0, 0, 0, 0, 0.1], (len(c.torque), 1)), atol=1e-12)


def test_loose_cable_crackles_near_its_pose_only():
    effect = e.Outside(loose_cable=(e.LooseCable(joint=1, torque=0.5, at=0.3, width=0.2),))
    for pose, heard in ((POSE, True), ((1.5, *POSE[1:]), False)):
        motor = simulate(ROBOT, Plant(**FREE, outside=effect), still(pose, 2.0)).truth.rows.motor[:, 0]
        assert (np.std(motor) > 0.2) == heard


def test_dead_amplifier_needs_more_current_for_the_same_torque():
    effect = e.Outside(amplifier=(e.Amplifier(joint=2, deadband=0.2),))
    recordings = [
        simulate(ROBOT, Plant(**FREE, outside=o), still(POSE, 0.5)).recording for o in (e.Outside(), effect)
    ]
    currents = [recording["actual_current"][-1, 1] for recording in recordings]
    assert abs(currents[1]) - abs(currents[0]) == pytest.approx(0.2, abs=1e-3)


def test_limited_amplifier_saturates():
    effect = e.Outside(amplifier=(e.Amplifier(joint=2, limit=4.5),))
    run = simulate(ROBOT, Plant(**FREE, outside=effect), MOTION).recording
    assert np.abs(run["actual_current"][:, 1]).max() <= 4.5 + 1e-12


def test_loaded_cogging_grows_with_load():
    effect = e.Outside(loaded_cogging=(e.LoadedCogging(joint=2, coefficient=0.03, order=1.0),))
    sizes = []
    for payload in (None, e.Payload(mass=5.0)):
        motion = sweep(2, POSE, -1.4, -1.0, (0.1,))
        motor = simulate(ROBOT, Plant(**FREE, outside=effect, payload=payload), motion).truth.rows.motor[:, 1]
        steady = motor[np.abs(motion.qd[:, 1]) > 0.099][100:]
        smooth = np.convolve(steady, np.ones(311) / 311, mode="valid")
        sizes.append(np.std(steady[155:-155] - smooth))
    assert sizes[1] > 1.5 * sizes[0] > 0.1


def test_contact_is_felt_as_jacobian_transpose_times_force():
    push = Contact(start=0.5, end=1.5, force=(0.0, 30.0, 0.0), link=3, point=(0.1, 0.0, 0.0))
    run = simulate(ROBOT, Plant(**QUIET, external_contact=(push,)), still(POSE, 2.0))
    rows = run.truth.rows
    assert np.abs(rows.external[(rows.time <= 0.5) | (rows.time >= 1.5)]).max() == 0.0
    middle = rows.external[np.argmin(np.abs(rows.time - 1.0))]
    simulator = Simulator(ROBOT, start=np.array(POSE))
    point = simulator.where(3, push.point)
    assert middle[0] == pytest.approx(30.0 * point[0], rel=1e-3)
    assert np.abs(middle[3:]).max() < 1e-9
    assert np.abs(run.recording["actual_TCP_force"]).max() == 0.0  # above the wrist sensor
