"""A load that is picked up and put down: when it is there, what it weighs, and what is no such load."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from rows_by_hand import rows, scales

from residuum.mismatch.carried import carried, handled, unloaded
from residuum.mismatch.evidence import Evidence, gather, renewed
from residuum.mismatch.explain import Task, explain
from residuum.mismatch.load_checks import LONG, _beside_one_joint, _longest, _on_each_joint
from residuum.mismatch.physics import forces
from residuum.mismatch.quantities import payload_directions, payload_numbers
from residuum.mismatch.segments import first_guesses, joined, segmented, stretches, sums_of, two_levels
from residuum.robots import load_robot
from residuum.virtual import Plant, simulate
from residuum.virtual import effects as e
from residuum.virtual.motions import pick_and_place

ROBOT, DIGEST = load_robot("ur5e")
#: s; when the load of the synthetic rows is held.
SPANS = ((6.0, 14.0), (20.0, 25.0))
#: kg and kg m: mass and first moments of that load at the last frame.
LOAD = np.array([1.5, 0.05, -0.04, 0.2, 0.01, 0.01, 0.01, 0.0, 0.0, 0.0])


def within(time, spans=SPANS):
    return np.any([(time >= a) & (time < b) for a, b in spans], axis=0)


@pytest.fixture(scope="module")
def healthy(arm, along) -> Evidence:
    """A recording of 40 s in which the arm is the published one with Coulomb and viscous friction, and noise."""
    time, rng = np.arange(0.0, 40.0, 0.008), np.random.default_rng(2)
    q, qd, qdd = along(time)
    torque = (
        arm.observer.inverse_dynamics(q, qd, qdd) + np.array([5.0, 6.0, 4.0]) * np.tanh(qd / 1e-3) + 2.0 * qd
    )
    recording = arm.recording(time, torque + 0.5 * rng.standard_normal(q.shape))
    return gather([recording], [True], arm.model, arm.robot)


def with_torque(evidence: Evidence, added) -> Evidence:
    """The evidence of rows (one run) whose torque is larger by `added` (n, N), Nm."""
    (rows,) = evidence.runs
    return renewed(evidence, [replace(rows, torque=rows.torque + added)])


def held_load(evidence: Evidence, held, value=LOAD):
    """Torque (n, N) of a load that is held in some rows."""
    space, (rows,) = evidence.setup.space, evidence.runs
    lifted = payload_directions(evidence) @ value
    each = [rows.columns[j] @ lifted[space.indices[j]] for j in range(space.dof)]
    return np.stack(each, axis=1) * held[:, None]


def test_nothing_is_carried_by_a_healthy_arm(healthy) -> None:
    assert carried(healthy) is None


def test_a_load_that_comes_and_goes_is_found_with_its_times_and_its_mass(arm, healthy) -> None:
    (rows,) = healthy.runs
    found = carried(with_torque(healthy, held_load(healthy, within(rows.time))))
    assert found is not None
    assert np.ravel(found.intervals) == pytest.approx(np.ravel(SPANS), abs=0.1)
    mass = payload_numbers(found.value, found.covariance, arm.model)["mass"]
    assert mass["value"] == pytest.approx(1.5, rel=0.03)
    assert mass["std"] == pytest.approx(0.15 * 1.5, rel=0.1)  # the gains' doubt
    (torque,) = found.torque
    assert np.abs(torque[~within(rows.time, [(a - 0.5, b + 0.5) for a, b in SPANS])]).max() == 0.0
    close = handled(healthy, found)[0]
    ends = np.ravel(SPANS)
    np.testing.assert_array_equal(close[[np.argmin(np.abs(rows.time - t)) for t in ends]], True)
    assert not close[np.abs(rows.time[:, None] - ends).min(axis=1) > 1.0].any()


def test_a_short_stretch_of_something_lighter_is_not_of_the_load(healthy) -> None:
    (rows,) = healthy.runs
    long, short = within(rows.time, [(20.0, 28.0)]), within(rows.time, [(9.0, 10.4)])
    found = carried(with_torque(healthy, held_load(healthy, long) + held_load(healthy, short, 0.55 * LOAD)))
    assert found is not None
    assert np.ravel(found.intervals) == pytest.approx([20.0, 28.0], abs=0.1)


def test_without_its_load_the_arm_is_healthy_again(healthy) -> None:
    (rows,) = healthy.runs
    loaded = with_torque(healthy, held_load(healthy, within(rows.time)))
    found = carried(loaded)
    rest = unloaded(loaded, found)
    assert carried(rest) is None
    assert rest.scales.sigma[:, 0] == pytest.approx(healthy.scales.sigma[:, 0], rel=0.1)


def test_a_load_that_is_held_all_the_time_is_not_carried(healthy) -> None:
    assert carried(with_torque(healthy, held_load(healthy, np.ones(len(healthy.runs[0]), bool)))) is None


@pytest.mark.parametrize("way", [(25.0, 0.0, 0.0), (0.0, -20.0, 15.0), (0.0, 0.0, -30.0)])
def test_a_push_is_no_load(healthy, way) -> None:
    (rows,) = healthy.runs
    pushed = np.zeros((len(rows), 3))
    for start in (8.0, 22.0):
        inside = within(rows.time, [(start, start + 2.0)])
        profile = np.sin(np.pi * (rows.time[inside] - start) / 2.0)
        pushed[inside] = forces(healthy.setup.physics, rows.q[inside], 3) @ np.array(way) * profile[:, None]
    assert carried(with_torque(healthy, pushed)) is None


@pytest.mark.parametrize("joint", [0, 1, 2])
def test_a_brake_that_drags_on_one_joint_is_no_load(healthy, joint) -> None:
    (rows,) = healthy.runs
    dragged = np.zeros((len(rows), 3))
    dragged[:, joint] = 8.0 * np.sign(rows.qd[:, joint]) * within(rows.time)
    assert carried(with_torque(healthy, dragged)) is None


def test_what_is_always_wrong_is_no_load(healthy) -> None:
    """Friction that the plain arm does not have: with load, with speed, with the angle."""
    (rows,) = healthy.runs
    sign = np.sign(rows.qd)
    strange = (
        0.2 * np.abs(rows.load) * sign
        + 8.0 * sign * np.exp(-((rows.qd / 0.2) ** 2))
        + 6.0 * sign * np.sin(rows.q)
    )
    assert carried(with_torque(healthy, strange)) is None


def test_states_follow_what_rows_gain_and_not_their_noise() -> None:
    rng = np.random.default_rng(3)
    true = np.zeros(2000, bool)
    true[300:700] = true[1200:1900] = True
    gain = np.where(true, 0.5, -0.5) + 1.5 * rng.standard_normal(len(true))
    found = segmented(gain)
    assert len(stretches(found)) == 2
    assert np.mean(found != true) < 0.02


@pytest.mark.parametrize(
    ("gain", "state"), [(np.ones(50), True), (-np.ones(50), False), (np.zeros(0), False)]
)
def test_one_state_all_the_time(gain, state) -> None:
    assert (segmented(gain) == state).all()


def test_short_pauses_are_closed_and_short_stretches_dropped() -> None:
    held = np.zeros(100, bool)
    held[10:40] = held[43:60] = held[80:84] = True
    assert stretches(joined(held, 10)) == [slice(10, 60)]
    assert stretches(joined(~np.zeros(5, bool), 10)) == []


def test_first_guesses_are_the_stretches_that_explain_most() -> None:
    rng = np.random.default_rng(4)
    columns, target = rng.standard_normal((1000, 2, 3)), 0.5 * rng.standard_normal((1000, 2))
    target[400:600] += columns[400:600] @ np.array([1.0, -2.0, 0.5])
    target[800:900] += columns[800:900] @ np.array([-1.0, 0.5, 0.5])
    sums = sums_of(columns, np.full((1000, 2), 4.0), target, 100)
    still = sums_of(columns[:50], np.ones((50, 2)), 0 * target[:50], 100)
    first, second, third = first_guesses([sums, still], np.ones(3), 3)
    assert first[:2] == (0, slice(400, 600))
    assert second[:2] == (0, slice(800, 900))
    assert first[2] > second[2] > 100 > third[2]


def test_two_levels_are_weighted_means_of_two_classes() -> None:
    values, weight = np.array([1.0, -0.2, 0.2, 1.4, 0.0]), np.array([3.0, 1.0, 1.0, 1.0, 2.0])
    assert two_levels(values, weight) == pytest.approx((0.0, 1.1))


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """(kind, seed) -> CSV of picks and places at 125 Hz, with a load of 1.5 kg while it grips or without."""
    folder = tmp_path_factory.mktemp("carried")

    def of(kind: str, seed: int):
        motion = pick_and_place(ROBOT, cycles=3, seed=seed)
        load = e.Payload(mass=1.5, centre_of_mass=(0.0, 0.02, 0.05), intervals=motion.grips)
        plant = Plant(payload=load) if kind == "carried" else Plant()
        path = folder / f"{kind}_{seed}.csv"
        if not path.exists():
            simulate(ROBOT, plant, motion, 125, seed).recording.write_csv(path)
        return path, motion.grips

    return of


@pytest.mark.slow
@pytest.mark.parametrize("with_reference", [False, True])
def test_explain_names_a_load_that_is_picked_up_and_put_down(recorded, with_reference) -> None:
    path, grips = recorded("carried", 1)
    reference = tuple(recorded("free", k)[0] for k in (2, 3)) if with_reference else ()
    answer = explain(Task((path,), reference, ROBOT, DIGEST, 6, propose=False, thresholds=False))
    first = answer.findings["findings"][0]
    assert (first["effect"], first["joints"]) == ("payload", [1, 2, 3, 4, 5, 6])
    assert np.ravel(first["intervals"]) == pytest.approx(np.ravel(grips), abs=0.3)
    mass, centre = (first["parameters"][k] for k in ("mass", "centre_of_mass"))
    assert mass["value"] == pytest.approx(1.5, rel=0.05)
    assert centre["value"] == pytest.approx([0.0, 0.02, 0.05], abs=0.02)
    assert f"held in {len(grips)} stretches of time" in answer.sentence
    assert first["share"]["2"] > 0.5
    assert "external_contact" not in [f["effect"] for f in answer.findings["findings"]]
    assert [f["effect"] for f in answer.findings["findings"]].count("payload") == 1


@pytest.mark.slow
def test_a_robot_that_picks_nothing_up_carries_nothing(recorded) -> None:
    answer = explain(Task((recorded("free", 2)[0],), (), ROBOT, DIGEST, 6, propose=False, thresholds=False))
    assert "payload" not in [f["effect"] for f in answer.findings["findings"]]


def test_what_one_joint_in_motion_tells_is_no_load() -> None:
    """Nats are half the weighted squares of its torque, where a joint moves, less those of the joint with most."""
    moving = np.ones((400, 3))
    moving[:, 2] = 0.0
    which = rows(400, joints=3, moving=moving)
    held = SimpleNamespace(
        runs=(SimpleNamespace(rows=which),),
        load=[np.tile([3.0, 0.3, 30.0], (400, 1))],
        evidence=SimpleNamespace(noise=scales(3)),
    )
    assert _beside_one_joint(held) == pytest.approx(0.5 * 400 / 4 * (0.3 / 0.3) ** 2)


@pytest.mark.parametrize(("shown", "longest"), [(1.0, 4.0), (0.02, 2.0)])
def test_a_stretch_is_as_long_as_it_shows_the_load(shown, longest) -> None:
    """Of 2 s and of 4 s, in which the arm hardly feels the load where shown is small."""
    which, rng = rows(360, joints=3, moving=np.ones((360, 3))), np.random.default_rng(4)
    columns = rng.standard_normal((360, 3, 10))
    columns[120:] *= shown
    run = SimpleNamespace(rows=which, columns=columns)
    events = [(run, part, columns[part] @ LOAD) for part in (slice(0, 120), slice(120, 360))]
    held = SimpleNamespace(events=events, evidence=SimpleNamespace(noise=scales(3)))
    assert which.step == pytest.approx(1 / 60)
    assert _longest(held) == pytest.approx(longest)
    assert (longest < LONG) == (shown < 1.0)


@pytest.mark.parametrize(("aside", "joint"), [(0.0, ""), (13.0, "joint 1"), (1.0, "")])
def test_a_load_explains_every_joint_that_shows_it(aside, joint) -> None:
    """A push that mostly points down pushes joint 1 aside, which no load does; a little of it is noise."""
    which, rng = rows(600, joints=3, moving=np.ones((600, 3))), np.random.default_rng(5)
    there = np.arange(600) % 200 < 60
    load = np.tile([0.1, 26.0, 19.0], (600, 1)) * there[:, None]
    left = load + aside * np.outer(there, [1.0, 0.0, 0.0]) + rng.normal(size=(600, 3))
    found = SimpleNamespace(runs=(SimpleNamespace(rows=which),), held=(there,), left=[left], load=[load])
    why = _on_each_joint(found)
    assert why.endswith(joint) if joint else why == ""
