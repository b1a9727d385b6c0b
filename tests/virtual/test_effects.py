"""Every effect changes what it should, by as much as it should, and nothing else."""

from dataclasses import dataclass

import mujoco
import numpy as np
import pytest

from residuum.robots import load_robot
from residuum.virtual import NOISELESS, Contact, Plant, Simulator, Torque, simulate
from residuum.virtual import effects as e
from residuum.virtual.model import build_model, tilted_gravity
from residuum.virtual.motions import fourier, join, move, point_to_point, small_reversals, still, sweep
from residuum.virtual.plant import BaseFriction, Thermal

ROBOT, _ = load_robot("ur5e")
GAIN = np.array([joint.drive_gain for joint in ROBOT.joint])
POSE = (0.3, -1.2, 1.4, -1.5, -1.4, 0.3)
FREE = {"sensing": NOISELESS, "friction": BaseFriction(kind="none")}
QUIET = {"sensing": NOISELESS}
MOTION = fourier(ROBOT, 4.0, seed=2, period=6.0)


@dataclass
class Change:
    """What an effect changes along MOTION: motor torque (T, 6) Nm, with the motion's own columns."""

    torque: np.ndarray
    q: np.ndarray
    qd: np.ndarray
    qdd: np.ndarray


def change(base=FREE, **effect) -> Change:
    """Run with and without; the servo holds both to the same path."""
    base_run, run = (simulate(ROBOT, Plant(**base, **extra), MOTION) for extra in ({}, effect))
    torque = (run.recording["actual_current"] - base_run.recording["actual_current"]) * GAIN
    return Change(torque, MOTION.q, MOTION.qd, MOTION.qdd)


def rms(values) -> np.ndarray:
    return np.sqrt(np.mean(np.square(values), axis=0))


def only(torque, joints, share=0.02):
    """The other joints feel next to nothing."""
    size = rms(torque)
    others = [k for k in range(6) if k + 1 not in joints]
    assert size[others].max() < share * max(size[[j - 1 for j in joints]].max(), 1e-9), size


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


FRICTION_SHAPES = {
    "coulomb_friction": (e.CoulombFriction(joint=2, torque=2.0), lambda v: 2.0 * np.sign(v)),
    "viscous_friction": (e.ViscousFriction(joint=2, damping=5.0), lambda v: 5.0 * v),
    "friction_asymmetry": (e.FrictionAsymmetry(joint=2, torque=1.0), np.ones_like),
    "stribeck": (
        e.Stribeck(joint=2, torque=3.0, speed=0.3),
        lambda v: 3.0 * np.exp(-((v / 0.3) ** 2)) * np.sign(v),
    ),
    "nonlinear_viscous": (
        e.NonlinearViscous(joint=2, shape="quadratic", coefficient=8.0),
        lambda v: 8.0 * v * np.abs(v),
    ),
}


@pytest.mark.parametrize("name", FRICTION_SHAPES)
def test_friction_terms_follow_their_law_where_the_joint_slides(name):
    effect, law = FRICTION_SHAPES[name]
    c = change(QUIET, **{name: (effect,)})
    v = c.qd[:, 1]
    since = np.convolve(np.abs(v) < 0.05, np.ones(200))[: len(v)]  # 0.4 s since the last reversal or rest
    sliding = since == 0
    assert sliding.sum() > 300
    assert rms((c.torque[:, 1] - law(v))[sliding]) < 0.06 * rms(law(v)[sliding]) + 0.02
    only(c.torque, (2,), 0.05)


@pytest.mark.parametrize(
    ("shape", "law"),
    [
        ("cubic", lambda v: v**3),
        ("power", lambda v: np.sign(v) * abs(v) ** 0.65),
        ("tanh", lambda v: np.tanh(v)),
    ],
)
def test_other_viscous_shapes(shape, law):
    c = change(nonlinear_viscous=(e.NonlinearViscous(joint=5, shape=shape, coefficient=2.0),))
    expected = 2.0 * law(c.qd[:, 4])
    assert rms(c.torque[:, 4] - expected) < 0.05 * rms(expected)


def test_load_widens_the_friction_of_a_loaded_joint():
    motion = sweep(2, POSE, -1.6, -0.6, (0.5,))
    runs = [
        simulate(ROBOT, Plant(**QUIET, load_dependent_friction=mu), motion).truth.rows
        for mu in ((), (e.LoadDependentFriction(joint=2, coefficient=0.06),))
    ]
    moving = np.convolve(np.abs(motion.qd[:, 1]) < 0.4999, np.ones(11), mode="same") == 0
    added = (runs[1].friction - runs[0].friction)[moving, 1]
    expected = 0.06 * np.abs(runs[1].gear[moving, 1]) * np.sign(motion.qd[moving, 1])
    np.testing.assert_allclose(added, expected, atol=0.15)
    assert np.abs(expected).max() > 1.5


def test_warm_joint_has_less_friction_and_warms_by_its_losses():
    effect = (e.TemperatureDependentFriction(joint=1, coulomb=-0.01, viscous=-0.02),)
    motion = sweep(1, POSE, -0.5, 0.5, (0.8,))
    widths = []
    for start in (23.0, 43.0, 53.0):
        thermal = Thermal(start=(start,) * 6)
        plant = Plant(**QUIET, thermal=thermal, temperature_dependent_friction=effect)
        widths.append(rms(simulate(ROBOT, plant, motion).truth.rows.friction)[0])
    assert widths[0] > widths[1] > widths[2]
    assert widths[0] / widths[1] == pytest.approx(1.25, abs=0.06)
    heated = Plant(**QUIET, thermal=Thermal(capacity=20.0))
    warm = simulate(ROBOT, heated, motion).recording["joint_temperatures"]
    assert warm[-1, 0] - warm[0, 0] > warm[-1, 5] - warm[0, 5] + 0.3


def test_presliding_shows_in_small_reversals_only():
    motion = small_reversals(1, POSE, widths=(0.002, 0.1), speed=0.05, times=2)
    effect = (e.PreslidingHysteresis(joint=1, travel=0.01),)
    plain, soft = (
        simulate(ROBOT, Plant(**QUIET, presliding_hysteresis=p), motion).truth.rows for p in ((), effect)
    )
    near = motion.q[:, 0] < POSE[0] + 0.0021
    first = np.arange(len(near)) < 900
    assert np.ptp(soft.friction[first & near, 0]) < 0.6 * np.ptp(plain.friction[first & near, 0])
    far = motion.q[:, 0] > POSE[0] + 0.08
    rising = far & (motion.qd[:, 0] > 0.04)
    np.testing.assert_allclose(soft.friction[rising, 0], plain.friction[rising, 0], atol=0.1)


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


def test_position_dependent_friction_follows_the_angle():
    effect = (e.PositionDependentFriction(joint=1, sine=2.0, cosine=1.0, order=3.0),)
    motion = sweep(1, POSE, -1.0, 1.0, (0.8,))
    rows = [
        simulate(ROBOT, Plant(**QUIET, position_dependent_friction=p), motion).truth.rows
        for p in ((), effect)
    ]
    moving = np.abs(motion.qd[:, 0]) > 0.79
    q, v = motion.q[moving, 0], motion.qd[moving, 0]
    expected = np.sign(v) * (2.0 * np.sin(3 * q) + np.cos(3 * q))
    np.testing.assert_allclose((rows[1].friction - rows[0].friction)[moving, 0], expected, atol=0.15)


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


def test_velocity_lag_shows_at_reversals():
    motion = point_to_point(np.array([POSE, (1.0, *POSE[1:]), POSE]), 0.0, 1.0, 3.0)
    effect = (e.VelocityLag(joint=1, lag=0.02),)
    rows = [simulate(ROBOT, Plant(**QUIET, velocity_lag=p), motion).truth.rows for p in ((), effect)]
    flips = [np.flatnonzero((r.friction[:-1, 0] > 0) & (r.friction[1:, 0] <= 0))[-1] * 0.002 for r in rows]
    assert 0.004 < flips[1] - flips[0] < 0.03


def test_tooth_defect_is_a_narrow_bump():
    motion = sweep(1, POSE, -1.0, 1.0, (0.8,))
    effect = e.Outside(tooth_defect=(e.ToothDefect(joint=1, torque=3.0, at=0.4, width=0.02),))
    rows = [simulate(ROBOT, Plant(**QUIET, outside=o), motion).truth.rows for o in (e.Outside(), effect)]
    moving = motion.qd[:, 0] > 0.79
    added = (rows[1].friction - rows[0].friction)[moving, 0]
    q = motion.q[moving, 0]
    assert added.max() == pytest.approx(3.0, rel=0.15)
    assert np.abs(added[np.abs(q - 0.4) > 0.15]).max() < 0.2


def test_slipping_brake_drags_while_it_drags():
    motion = join(move(np.array(POSE), np.array((2.3, *POSE[1:])), 0.5, 2.0))
    brake = e.Outside(slipping_brake=(e.SlippingBrake(joint=1, torque=8.0, intervals=((1.5, 2.5),)),))
    rows = [simulate(ROBOT, Plant(**QUIET, outside=o), motion).truth.rows for o in (e.Outside(), brake)]
    added = (rows[1].friction - rows[0].friction)[:, 0]
    time = rows[0].time
    assert 3.9 < added[(time > 1.6) & (time < 2.4)].min() < added.max() < 8.2
    assert np.abs(added[time < 1.49]).max() < 1e-9


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
