"""Rows against recordings whose torque is known: columns @ the true parameters is the torque."""

import mujoco
import numpy as np
import pytest
from terms_by_hand import built_up_by_hand, torque_by_hand

from residuum.mismatch.columns import DELAYS, LATE, WIDTH
from residuum.mismatch.physics import forces, levers, tilts
from residuum.mismatch.rows import make_rows
from residuum.mismatch.speed import calm_speeds
from residuum.robots import load_robot
from residuum.symbolic.terms import CATALOGUE
from residuum.symbolic.tilt import tilted
from residuum.virtual.model import build_model, link_frame

BY_RATE = {"125 Hz": (125.0, 0.0, 2e-3), "jittered": (125.0, 0.2, 2e-3), "500 Hz": (500.0, 0.0, 5e-4)}


def instants(rate: float = 125.0, jitter: float = 0.0, seconds: float = 8.0):
    rng = np.random.default_rng(0)
    time = np.arange(0.0, seconds, 1 / rate)
    return time + jitter / rate * rng.uniform(-1, 1, len(time))


def rms(x) -> float:
    return float(np.sqrt(np.mean(x**2)))


@pytest.mark.parametrize(("rate", "jitter", "limit"), BY_RATE.values(), ids=BY_RATE)
def test_the_rigid_body_is_explained_by_its_parameters(arm, along, rate, jitter, limit) -> None:
    time = instants(rate, jitter)
    rows = make_rows(arm.recording(time, arm.observer.inverse_dynamics(*along(time))), arm.setup)
    space = arm.setup.space
    theta = np.concatenate([arm.physics.published, np.zeros(space.size - len(space.base))])
    for j in range(3):
        error = rows.torque[:, j] - rows.columns[j] @ theta[space.indices[j]]
        assert rms(error) < limit * rms(rows.torque[:, j])


@pytest.mark.parametrize("jitter", [0.0, 0.2])
@pytest.mark.parametrize(
    ("term", "linear", "nonlinear"),
    [
        ("coulomb", {"Fc": 6.0}, {}),
        ("viscous", {"Fv": 3.0}, {}),
        ("quadratic", {"F2": 1.5}, {}),
        ("cubic", {"F3": 0.7}, {}),
        ("asymmetric", {"Fa": 0.4}, {}),
        ("stribeck", {"Fs": 2.0}, {"vs": 0.02, "delta": 2.0}),
        ("stribeck", {"Fs": 2.0}, {"vs": 0.08, "delta": 2.0}),
        ("stribeck", {"Fs": 2.0}, {"vs": 0.08, "delta": 1.0}),
        ("position_dependent", {"A": 0.6, "B": -0.3}, {"n": 2.0}),
        ("presliding", {"A": 5.0}, {"zs": 0.012}),
        ("lag", {"A": 5.0}, {"lag": 0.01}),
    ],
)
def test_a_term_is_explained_to_round_off(arm, along, term, linear, nonlinear, jitter) -> None:
    """The torque is the term's own SymPy expression, sample by sample in plain Python, of smoothed speeds.

    What raises friction's level builds up after a reversal, as that level does.
    """
    time, joint = instants(125.0, jitter, 5.0), 1
    q = along(time)[0]
    qd = calm_speeds(arm.recording(time, np.zeros((len(time), 3))))
    steps = np.diff(time, prepend=time[0] - np.median(np.diff(time)))
    defaults = {n: p.default for n, p in CATALOGUE[term].parameters.items()}
    values = defaults | linear | nonlinear | {"width": WIDTH}
    none = np.zeros(len(time))
    own = torque_by_hand(term, values, q[:, joint], qd[:, joint], none, none + 35, steps)
    space, mine = arm.setup.space, []
    for k, column in enumerate(space.own):
        same = {n: v for n, v in column.values if n != "width"} == nonlinear
        if column.term == term and same and not column.soft:
            mine.append((k, column))
    if mine[0][1].builds_up:
        short = next(c.value for c in space.own if c.short)
        built = built_up_by_hand(short, q[:, joint], qd[:, joint], steps)
        sign = torque_by_hand("coulomb", {"Fc": 1.0, **short}, q[:, joint], qd[:, joint], none, none, steps)
        own = own * built * sign
    torque = np.zeros((len(time), 3))
    torque[:, joint] = own
    rows = make_rows(arm.recording(time, torque), arm.setup)
    explained = np.zeros(len(rows))
    for k, column in mine:
        explained += rows.columns[joint][:, len(space.seen[joint]) + k] * linear[column.parameter]
    assert rms(rows.torque[:, joint]) > 0.05
    np.testing.assert_allclose(explained, rows.torque[:, joint], atol=1e-9 * np.abs(torque).max())


def difference(arm, time, torque):
    """Rows of a torque alone: what a cause adds, low-passed."""
    return make_rows(arm.recording(time, torque), arm.setup)


@pytest.mark.parametrize("joint", [1, 2, 3])
def test_encoder_offset_against_the_observer(arm, along, joint) -> None:
    time, step = instants(500.0), 1e-4
    q, qd, qdd = along(time)
    moved = q + step * np.eye(3)[joint - 1]
    torque = (
        arm.observer.inverse_dynamics(moved, qd, qdd) - arm.observer.inverse_dynamics(q, qd, qdd)
    ) / step
    rows = difference(arm, time, torque)
    for row in range(3):
        error = rows.torque[:, row] - arm.column(rows, f"encoder{joint}", row)
        assert rms(error) < 5e-3 * max(rms(rows.torque), 1.0)


def test_a_turned_base_against_the_tilted_model(arm, along) -> None:
    from residuum.codegen.generate import generate
    from residuum.codegen.load import load_text

    q, step = along(instants(20.0))[0], 1e-4
    slopes = tilts(arm.physics, q)
    for k, (roll, pitch) in enumerate(((step, 0.0), (0.0, step))):
        turned = load_text(generate(tilted(arm.model, arm.robot, roll, pitch)).files["observer.py"])
        found = (turned.gravity(q) - arm.observer.gravity(q)) / step
        np.testing.assert_allclose(slopes[:, :, k], found, atol=2e-2)


@pytest.mark.parametrize("joint", [1, 2, 3])
def test_a_soft_gear_lets_the_links_lag_and_not_the_rotor(arm, along, joint) -> None:
    """Motor side: torque = Jm qdd + load(q - load/K); positions are recorded on the motor side."""
    fine, time, stiffness = np.arange(-1.0, 9.0, 1 / 2000), instants(125.0), 1e5
    q, qd, qdd = along(fine)
    rotors = np.array([x.reflected_inertia for x in arm.robot.joint[:3]])
    load = arm.observer.inverse_dynamics(q, qd, qdd) - rotors * qdd
    own = np.eye(3)[joint - 1]
    wound = own * load / stiffness
    first = np.gradient(wound, fine, axis=0)
    second = np.gradient(first, fine, axis=0)
    change = arm.observer.inverse_dynamics(q - wound, qd - first, qdd - second) + rotors * second
    change -= arm.observer.inverse_dynamics(q, qd, qdd)
    torque = stiffness * np.stack([np.interp(time, fine, x) for x in change.T], axis=1)
    rows = difference(arm, time, torque)
    for row in range(3):
        column = arm.column(rows, f"elasticity{joint}", row)
        assert rms(rows.torque[:, row] - column) < 0.05 * rms(rows.torque[:, row]), row


@pytest.mark.parametrize("k", range(len(DELAYS)))
def test_a_delay_is_the_torques_slope_at_its_own_instant(arm, along, k) -> None:
    """Over its own length, half before and half after: noise of a row has nothing in common with it."""
    time, delay = instants(500.0), DELAYS[k]
    late, early = (arm.observer.inverse_dynamics(*along(time + x)) for x in (-0.5 * delay, 0.5 * delay))
    torque = late - early
    rows = difference(arm, time, torque / delay)
    inner = slice(10, None)  # the first samples have nothing before them
    for row in range(3):
        error = rows.torque[inner, row] - arm.column(rows, f"delay{k + 1}", row)[inner]
        assert rms(error) < 0.02 * rms(rows.torque[inner, row])


@pytest.mark.parametrize("k", range(len(DELAYS)))
def test_a_current_that_comes_late_on_one_joint(arm, along, k) -> None:
    time, delay, joint = instants(500.0), DELAYS[k], 1
    dry, viscous = arm.setup.friction[joint]
    short = next(c.value for c in arm.setup.space.own if c.short)

    def friction_at(t):
        """A Coulomb level that builds up after a reversal, as in every gear, and drag."""
        q, speed = (x[:, joint] for x in along(t)[:2])
        steps = np.diff(t, prepend=t[0] - t[1] + t[0])
        return dry * built_up_by_hand(short, q, speed, steps) + viscous * speed

    late, there = (arm.observer.inverse_dynamics(*along(t)) for t in (time - delay, time))
    late[:, joint] += friction_at(time - delay)
    there[:, joint] += friction_at(time)
    rows = difference(arm, time, (late - there) / delay)
    space = arm.setup.space
    own = next(i for i, c in enumerate(space.own) if c.term == LATE and c.value["around"] == delay)
    column = rows.columns[joint][:, len(space.seen[joint]) + own]
    inner = slice(10, None)  # the first samples have nothing before them
    assert rms((rows.torque[:, joint] - column)[inner]) < 0.05 * rms(rows.torque[inner, joint])


def test_a_force_needs_the_torque_of_mujocos_jacobian(arm) -> None:
    robot, rng = load_robot("ur5e")[0], np.random.default_rng(3)
    model = build_model(robot)
    data = mujoco.MjData(model)
    for frame in (1, 2, 3):
        q = rng.uniform(-2, 2, (5, 3))
        away = rng.uniform(-0.2, 0.2, 3)  # m, from the frame's origin along the axes of the link
        found = forces(arm.physics, q, frame) + levers(arm.physics, q, frame) @ away
        for k, pose in enumerate(q):
            data.qpos[:] = 0.0
            data.qpos[:3] = pose
            mujoco.mj_forward(model, data)
            body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, f"link_{frame}")
            point = data.xpos[body] + data.xmat[body].reshape(3, 3) @ (link_frame(robot, frame)[1] + away)
            jacobian = np.zeros((3, model.nv))
            mujoco.mj_jac(model, data, jacobian, None, point, body)
            np.testing.assert_allclose(found[k], -jacobian[:, :3].T, atol=1e-9)


def test_the_median_step_says_the_rate(arm) -> None:
    time = instants(125.0, 0.2)
    assert arm.recording(time, np.zeros((len(time), 3))).rate == pytest.approx(125.0, rel=0.02)


def test_nothing_crosses_a_gap_and_short_stretches_give_no_rows(arm) -> None:
    time = instants(125.0)
    torque = np.zeros((len(time), 3))
    whole = make_rows(arm.recording(time, torque), arm.setup)
    later = time + 2.0 * (time > 4.0)
    cut = make_rows(arm.recording(later, torque), arm.setup)
    assert np.sum(np.diff(cut.time) > 1.5 * cut.step) == 1 and len(cut) < len(whole)
    assert not np.any((cut.time > 4.0) & (cut.time < 6.0))
    assert not len(make_rows(arm.recording(time[:20], torque[:20]), arm.setup))
