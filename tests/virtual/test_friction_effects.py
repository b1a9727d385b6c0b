"""Effects of friction change what they should, by as much as they should, and nothing else."""

import numpy as np
import pytest
from effect_runs import POSE, QUIET, ROBOT, change, only, rms

from residuum.codegen.columns import columns
from residuum.virtual import Plant, simulate
from residuum.virtual import effects as e
from residuum.virtual.friction import curves
from residuum.virtual.motions import join, move, point_to_point, small_reversals, sweep
from residuum.virtual.plant import BaseFriction, Thermal

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


def test_velocity_lag_shows_at_reversals():
    motion = point_to_point(np.array([POSE, (1.0, *POSE[1:]), POSE]), 0.0, 1.0, 3.0)
    effect = (e.VelocityLag(joint=1, lag=0.02),)
    rows = [simulate(ROBOT, Plant(**QUIET, velocity_lag=p), motion).truth.rows for p in ((), effect)]
    flips = [np.flatnonzero((r.friction[:-1, 0] > 0) & (r.friction[1:, 0] <= 0))[-1] * 0.002 for r in rows]
    assert 0.004 < flips[1] - flips[0] < 0.03


def test_a_late_sign_is_what_the_term_says():
    """The simulator shares no formula with the term, whose jump builds up over a travel as well."""
    c = change(QUIET, velocity_lag=(e.VelocityLag(joint=2, lag=0.015),))
    none, dt = np.zeros_like(c.qd), np.full(len(c.qd), 0.002)
    own, late = c.torque[:, 1], columns("lag", {"lag": 0.015}, none, c.qd, none, None, dt)["A"][:, 1]
    size = own @ late / (late @ late)
    assert rms(own - size * late) ** 2 < 0.2 * rms(own) ** 2
    level = curves(ROBOT, BaseFriction())[1].high
    assert 0.6 * level < size < level


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
