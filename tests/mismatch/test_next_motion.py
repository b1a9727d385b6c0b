"""Which motion tells rivals apart, where it may go, and the program that makes it."""

from dataclasses import replace

import numpy as np
import pytest

from residuum.mismatch.evidence import gather
from residuum.mismatch.experiments import Experiment, Step, library, path
from residuum.mismatch.naming import APART, nuisance, ranked
from residuum.mismatch.next_motion import next_motion, promises
from residuum.mismatch.physics import physics_of
from residuum.mismatch.rehearsal import RATE, minutes_of, recording_of, rounds_of, trajectory
from residuum.mismatch.room import TOP_SPEED, heights, room_of
from residuum.recordings import Recording
from residuum.robots import load_robot
from residuum.symbolic.nominal import nominal_model
from residuum.urscript import IdleWorld, Machine, check
from residuum.virtual.server import Controller
from residuum.virtual.server.primary import ErrorCode

DOF = 3
ROBOT, DIGEST = load_robot("ur5e")
MODEL = nominal_model(ROBOT, DIGEST, DOF)
PHYSICS = physics_of(MODEL, ROBOT)
GAINS = np.array([j.drive_gain for j in MODEL.joint])


def recorded(name: str, t, q, qd, qdd, seed: int) -> Recording:
    """Torque of the published arm with 2 Nm of offset on joint 1, a gain on joint 2 and Stribeck on joint 3."""
    rigid = np.einsum("tjb,b->tj", PHYSICS.regressor.matrix("torque", q=q, qd=qd, qdd=qdd), PHYSICS.published)
    torque = rigid + 5 * np.sign(qd) + 4 * qd
    torque[:, 2] += 4 * np.exp(-((qd[:, 2] / 0.08) ** 2)) * np.sign(qd[:, 2])
    torque[:, 1] *= 1.1
    torque[:, 0] += 2.0
    torque += 0.3 * np.random.default_rng(seed).standard_normal(torque.shape)
    return Recording(name, t, q, torque / GAINS, qd=qd)


def wandering(seconds: float = 30.0) -> Recording:
    """All joints in sums of sines, hardly ever at rest."""
    rng, t = np.random.default_rng(0), np.arange(0, seconds, 1 / RATE)
    q = np.tile([0.0, -1.2, 1.2], (len(t), 1))
    qd, qdd = np.zeros_like(q), np.zeros_like(q)
    for j in range(DOF):
        for w in rng.uniform(0.4, 2.0, 4):
            a, p = 0.25 * rng.uniform(0.5, 1.5), rng.uniform(0, 2 * np.pi)
            q[:, j] += a * np.sin(w * t + p)
            qd[:, j] += a * w * np.cos(w * t + p)
            qdd[:, j] -= a * w**2 * np.sin(w * t + p)
    return recorded("wandering", t, q, qd, qdd, 1)


@pytest.fixture(scope="module")
def wandered() -> Recording:
    return wandering()


@pytest.fixture(scope="module")
def evidence(wandered):
    return gather([wandered], [True], MODEL, ROBOT)


@pytest.fixture(scope="module")
def model(evidence):
    return nuisance(evidence)


@pytest.fixture(scope="module")
def named(evidence, model):
    """Each name's hypothesis at the value that fits best."""
    found = {c.key: c for c in evidence.found.each if dict(c.values).get("delta", 2.0) == 2.0}
    return found | {s.candidate.key: s.candidate for s in ranked(evidence, model)}


@pytest.fixture(scope="module")
def room(evidence):
    return room_of(evidence)


@pytest.fixture(scope="module")
def rate(evidence, model, named, room):
    """Nats a minute by motion, for the pair that it parts least."""

    def of(*keys):
        found = promises(evidence, model, [named[k] for k in keys], room)
        return {p.experiment.name: p.rate for p in found}

    return of


@pytest.fixture(scope="module")
def offset(evidence, model, named):
    return next_motion(
        evidence, model, [named["current_offset", 0], named["friction_asymmetry", 0]], np.full(DOF, np.pi)
    )


def test_one_name_needs_no_motion(evidence, model, named) -> None:
    assert next_motion(evidence, model, []) is None
    assert next_motion(evidence, model, [named["stribeck", 2], named["stribeck", 2]]) is None


def test_offset_against_asymmetry_is_seen_where_the_joint_rests_or_turns_back(rate) -> None:
    found = rate(("current_offset", 0), ("friction_asymmetry", 0))
    steady = max(found["slow_constant_speed"], found["full_range_sweep"])
    assert found["still_poses"] > 1.5 * steady
    assert found["stop_and_ring"] > 1.5 * steady


def test_stribeck_against_presliding_is_seen_when_slow(rate) -> None:
    found = rate(("stribeck", 2), ("presliding_hysteresis", 2))
    assert found["small_reversals"] > found["full_range_sweep"]
    assert found["slow_ramps"] > found["full_range_sweep"]
    assert max(found, key=found.get) in ("small_reversals", "slow_ramps", "slow_constant_speed")


def test_drive_gain_against_payload_is_seen_with_a_known_load(rate) -> None:
    found = rate(("drive_gain", 1), ("payload", None))
    assert max(found, key=found.get) == "known_load"


def test_names_with_the_same_column_cannot_be_told_by_any_motion(evidence, model, named) -> None:
    one = named["stribeck", 2]
    found = next_motion(evidence, model, [one, replace(one, effect="its_double")])
    assert found is not None
    assert found.text.startswith("None of ")
    assert "ramps of speed" in found.text
    assert found.script == ""
    assert found.waypoints.shape == (0, DOF)


def test_the_chosen_motion_tells_in_fact(wandered, evidence, model, named, offset, room) -> None:
    """Made with the true arm and added to the recordings, it leads by what settles it; before, it did not."""

    def lead(some, fitted) -> float:
        score = {s.candidate.key: s.evidence for s in ranked(some, fitted)}
        return score["current_offset", 0] - score["friction_asymmetry", 0]

    chosen = next(x for x in library(room, [0]) if np.array_equal(x.waypoints, offset.waypoints))
    t, q, qd = trajectory(chosen.steps)
    made = recorded("made", t, q, qd, np.gradient(qd, t, axis=0), 2)
    both = gather([wandered, made], [True, True], MODEL, ROBOT)
    before, after = lead(evidence, nuisance(evidence)), lead(both, nuisance(both))
    assert after > before + APART


def test_motions_stay_where_the_recordings_were(evidence, room) -> None:
    q = evidence.runs[0].q
    for joint in range(DOF):
        for e in library(room, [joint]):
            way = path(e.steps)
            assert np.all(way >= np.minimum(room.low, q.min(axis=0)) - 1e-9), e.name
            assert np.all(way <= np.maximum(room.high, q.max(axis=0)) + 1e-9), e.name
            assert np.all(heights(PHYSICS, room.home, way) >= room.floor - 0.0101), e.name
            assert e.speed <= TOP_SPEED + 1e-9


def test_speeds_follow_the_joints_limits(evidence) -> None:
    room = room_of(evidence, np.array([1.0, 1.0, 2.0]))
    for e in library(room, [0]):
        _, _, qd = trajectory(e.steps)
        assert np.abs(qd).max() <= 0.8001, e.name  # what is set by the joint's limit is at most 0.6
    sweep = next(e for e in library(room, [0]) if e.name == "full_range_sweep")
    assert sweep.speed == pytest.approx(0.6)


def test_heights_are_those_of_elbow_and_last_frame(room) -> None:
    lengths = -np.array([ROBOT.joint[1].a, ROBOT.joint[2].a])
    q = np.random.default_rng(0).uniform(-2, 2, (50, DOF))

    def above_shoulder(q):
        elbow = -lengths[0] * np.sin(q[:, 1])
        return np.stack([elbow, elbow - lengths[1] * np.sin(q[:, 1] + q[:, 2])], axis=1)

    want = above_shoulder(q) - above_shoulder(room.home[None])
    assert heights(PHYSICS, room.home, q) == pytest.approx(want, abs=1e-6)


def test_a_path_below_what_was_recorded_is_drawn_in(room) -> None:
    high = replace(room, floor=np.full(2, -0.05))
    sweeps = {e.name: e for e in library(high, [1])}
    whole = {e.name: e for e in library(room, [1])}
    assert np.ptp(sweeps["still_poses"].waypoints[:, 1]) < np.ptp(whole["still_poses"].waypoints[:, 1])
    assert all(high.clear(path(e.steps)) for e in sweeps.values())


def test_trajectories_are_closed_trapezoids() -> None:
    steps = (
        Step(np.zeros(2), 0.5),
        Step(np.array([1.0, -0.5]), 0.8, 2.0),
        Step(np.array([0.01, 0.0]), 0.4, 2.0),
    )
    t, q, qd = trajectory(steps)
    assert q[-1] == pytest.approx(q[0])
    assert np.abs(qd).max() == pytest.approx(0.8, rel=0.02)
    assert np.abs(np.gradient(qd, t, axis=0)).max() <= 2.0 * 1.01
    assert np.abs(np.gradient(q, t, axis=0) - qd).max() < 0.02
    assert np.abs(np.diff(q, axis=0)).max() < 0.8 / RATE * 1.05
    assert len(recording_of(steps, np.full(2, 30.0))) == len(t)


def test_rounds_fill_the_minutes() -> None:
    steps = Step(np.zeros(1), 0.5, dwell=1.0), Step(np.ones(1), 0.5, dwell=1.0)
    short = Experiment("short", "short", steps, np.zeros(1))
    assert rounds_of(short) == round(180 / len(trajectory(short.steps)[0]) * RATE)
    assert minutes_of(short) == pytest.approx(3.0, abs=0.1)


@pytest.mark.parametrize("version", ["5.4", "5.11", "5.23", "10.7"])
def test_the_program_passes_the_checker_without_a_remark(offset, version) -> None:
    assert check(offset.script, version) == []


def test_the_program_goes_through_the_waypoints(offset) -> None:
    world = IdleWorld(q=[9.0, 9.0, 9.0, 0.4, 0.5, 0.6])
    machine = Machine(offset.script, world)
    machine.run(500 * 600)
    moves = [arguments for name, arguments in world.motions if name == "movej"]
    poses = np.array([[float(x) for x in m[0]] for m in moves])
    k = len(offset.waypoints)
    assert poses[:k, :DOF] == pytest.approx(offset.waypoints, abs=1e-4)
    assert poses[k, :DOF] == pytest.approx(offset.waypoints[0], abs=1e-4)
    assert (len(moves) - 1) % k == 0
    assert np.all(poses[:, DOF:] == [0.4, 0.5, 0.6])
    assert max(float(m[2]) for m in moves) == pytest.approx(offset.speed, abs=1e-3)
    assert any("path" in text for text in world.messages)
    assert machine.threads == ()


def test_the_program_moves_the_virtual_arm_as_rehearsed(offset, room) -> None:
    first = tuple(round(float(x), 5) for x in offset.waypoints[0])
    controller = Controller(ROBOT, start=(*first, -1.5, -1.5, 0.0))
    controller.programs.start(offset.script)
    steps = next(x.steps for x in library(room, [0]) if x.name in offset.script)
    t, q, _ = trajectory(steps)
    for _ in range(round(500 * t[-1])):
        controller.tick()
    assert not any(isinstance(m, ErrorCode) for m in controller.messages)
    assert np.array(controller.arm.target[0])[:DOF] == pytest.approx(q[-1], abs=0.02)


@pytest.mark.slow
def test_payload_against_a_link_is_seen_with_the_wrist_turned() -> None:
    robot, digest = load_robot("ur5e")
    model = nominal_model(robot, digest, 6)
    physics = physics_of(model, robot)
    t = np.arange(0, 40, 1 / RATE)
    w, p = np.random.default_rng(2).uniform(0.4, 2.0, (2, 6, 1))
    q = np.array([0.0, -1.2, 1.2, -1.5, -1.5, 0.0]) + 0.5 * np.sin(w * t + 3 * p).T
    qd, qdd = 0.5 * (w * np.cos(w * t + 3 * p)).T, -0.5 * (w**2 * np.sin(w * t + 3 * p)).T
    held = physics.published + 0.5 * physics.map.links[:, 50] + 0.05 * physics.map.links[:, 53]
    torque = physics.regressor.matrix("torque", q=q, qd=qd, qdd=qdd) @ held + 5 * np.sign(qd) + 4 * qd
    torque += 0.3 * np.random.default_rng(1).standard_normal(torque.shape)
    recording = Recording("held", t, q, torque / [j.drive_gain for j in model.joint], qd=qd)
    some = gather([recording], [True], model, robot)
    fitted = nuisance(some)
    named = {s.candidate.key: s.candidate for s in ranked(some, fitted)}
    found = promises(some, fitted, [named["payload", None], named["link_inertial", 2]], room_of(some))
    order = [p.experiment.name for p in sorted(found, key=lambda p: -p.rate)]
    assert "wrist_turned" in order[:2]
    assert order.index("wrist_turned") < order.index("full_range_sweep")


def test_the_answer_says_what_to_do(offset) -> None:
    assert "current_offset on joint 1 and friction_asymmetry on joint 1" in offset.text
    assert "check the path" in offset.text
    assert "residuum record" in offset.script
    assert offset.waypoints.shape[1] == DOF
    assert min(offset.separation.values()) > 0
