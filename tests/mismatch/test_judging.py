"""What is believed: every rule refuses by itself, and one block proves nothing."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from residuum.mismatch.acceptance import EVIDENCE, LARGE, SHARE, objection
from residuum.mismatch.candidates import Candidate
from residuum.mismatch.judging import Accepted, bodies_first, shadow
from residuum.mismatch.masses import unmoved
from residuum.mismatch.naming import APART, Scored
from residuum.mismatch.plausibility import SHIFTED, SYNCHRONOUS, everyones, implausible
from residuum.mismatch.share import Share
from residuum.mismatch.simplest import likelier, told_apart

HERE = Candidate("stribeck", 1, (0,))
HALF = Share(0.3, 0.3)


def scored(gain, evidence: float = 100.0, candidate: Candidate = HERE, consistency: float = 4.5) -> Scored:
    return Scored(candidate, np.asarray(gain, float), evidence, np.ones(1), 0.1 * np.ones(1), consistency)


def test_what_passes_every_rule_is_believed() -> None:
    assert objection(scored([9, 11, 10, 12, 8]), HALF) == ""


@pytest.mark.parametrize(
    ("test", "share", "word"),
    [
        (scored([9, 11, 10], evidence=EVIDENCE - 1), HALF, "nats"),
        (scored([1, 2, 1, 2]), HALF, "nats"),
        (scored([60, -3, 1, -2, 3]), HALF, "steady"),
        (scored([9, 11, 10, 12], consistency=2.9), HALF, "jackknife"),
        (scored([60, -3, -1, -2, 3], consistency=6.0), HALF, "improves only"),
        (scored([9, 11, 10, 12]), Share(SHARE / 2, SHARE / 2), "explains only"),
    ],
    ids=["evidence", "left-out evidence", "one block has it all", "no size", "sure, in few", "too little"],
)
def test_each_rule_refuses(test, share, word) -> None:
    assert word in objection(test, share)


def test_a_sure_size_may_gain_unevenly() -> None:
    """As heat does, which tells in warm blocks alone."""
    uneven = [60.0, -1, 1, -2, 3, 25]
    assert objection(scored(uneven, consistency=6.0), HALF) == ""
    assert "steady" in objection(scored(uneven, consistency=4.5), HALF)


def test_what_the_baseline_imitates_may_gain_little_when_nothing_shakes_it() -> None:
    bent = [1.0, 0.5, 1.5, -0.5, 1.0]
    assert objection(scored(bent, evidence=30.0, consistency=9.0), HALF) == ""
    assert "nats" in objection(scored(bent, evidence=15.0, consistency=9.0), HALF)
    assert "nats" in objection(scored(bent, evidence=30.0, consistency=7.0), HALF)


def test_what_the_baseline_imitates_is_large_by_its_own_torque() -> None:
    """An encoder's offset, say: masses bend until little is left of it, yet nothing shakes its size."""
    gain, large, small = [4.0, 3.0, 5.0, 2.0, 4.0], Share(SHARE / 5, 2 * LARGE), Share(SHARE / 5, LARGE / 2)
    sure = scored(gain, evidence=40.0, consistency=30.0)
    assert objection(sure, large) == ""
    assert "explains" in objection(sure, small)
    assert "explains" in objection(scored([9, 11, 10, 12], evidence=40.0, consistency=4.5), large)


def test_one_block_proves_nothing() -> None:
    """Without a second block there is nothing to be steady over: no name."""
    with np.errstate(all="ignore"):
        alone = scored([100.0], consistency=0.0)
        assert objection(alone, HALF) != ""
        assert not np.isnan(alone.steadiness)


@pytest.mark.parametrize(
    ("effect", "values", "part", "changed", "believed"),
    [
        ("velocity_lag", (("lag", 0.012),), 0.55, False, False),
        ("velocity_lag", (("lag", 0.012),), 0.65, False, True),
        ("velocity_lag", (("lag", 0.012),), 0.55, True, True),
        ("velocity_lag", (("lag", 0.012),), 0.45, True, False),
        ("presliding_hysteresis", (("zs", 0.003),), 0.3, False, False),
        ("presliding_hysteresis", (("zs", 0.012),), 0.3, False, True),
        ("stribeck", (("vs", 0.04),), 0.05, False, True),
        ("backlash", (("gap", 0.001), ("wider", 0.002)), 0.9 / 8, False, True),
        ("backlash", (("gap", 0.001), ("wider", 0.002)), 0.1 / 8, False, False),
        ("backlash", (("gap", 0.001), ("wider", 0.002)), -0.9 / 8, False, False),
    ],
)
def test_what_every_gear_has_is_no_finding_but_a_change_of_it_is(
    effect, values, part, changed, believed
) -> None:
    level = 8.0
    evidence = SimpleNamespace(
        setup=SimpleNamespace(friction=np.array([[level, 1.0]])), has_reference=changed
    )
    test = Scored(Candidate(effect, 0, (0,), values), np.ones(4), 50.0, np.array([part * level]), np.ones(1))
    assert (implausible(evidence, test) == "") == believed


@pytest.mark.parametrize(("between", "believed"), [(0.55, True), (0.45, False), (0.0, False)])
def test_a_late_sign_counts_by_its_size_where_its_evidence_peaks(between, believed) -> None:
    """A grid's next longer lag needs 45 % of the level to explain what 55 % of it do a little earlier."""
    level, late = 8.0, Candidate("velocity_lag", 0, (0,), (("lag", 0.018),))
    evidence = SimpleNamespace(setup=SimpleNamespace(friction=np.array([[level, 1.0]])), has_reference=True)
    test = Scored(late, np.ones(4), 50.0, np.array([0.45 * level]), np.ones(1), between=between * level)
    assert (implausible(evidence, test) == "") == believed


def test_a_delay_makes_signs_late_and_a_lag_beside_it_is_none() -> None:
    delay = Accepted(scored([9, 11], candidate=Candidate("time_delay", None, (0, 1))), (), (), 0.5)
    late = scored([9, 11], candidate=Candidate("velocity_lag", 1, (2,)))
    short, long = (
        scored([9, 11], candidate=Candidate("presliding_hysteresis", 1, (2,), (("zs", zs),)))
        for zs in (0.001, 0.012)
    )
    assert "delay" in shadow(late, [delay], 6)
    assert "delay" in shadow(short, [delay], 6)
    assert shadow(late, [], 6) == shadow(long, [delay], 6) == ""
    assert "%" in shadow(scored([1, 1], evidence=1.0), [Accepted(scored([9, 11]), (), (), 0.5)], 6)
    surely = scored([1, 1], evidence=1.0, consistency=340.0)
    assert shadow(surely, [Accepted(scored([9, 11]), (), (), 0.5)], 6) == ""


def test_a_delay_of_one_joint_is_longer_than_recorders_have_it_and_covers_that_joint_alone() -> None:
    one = Candidate("time_delay", 1, (0,), (("around", 0.01),))
    for reference, least in ((True, SHIFTED), (False, SYNCHRONOUS)):
        setup = SimpleNamespace(friction=np.ones((2, 2)))
        evidence = SimpleNamespace(setup=setup, has_reference=reference)
        for size, believed in ((0.9 * least, False), (1.1 * least, True)):
            test = Scored(one, np.ones(4), 50.0, np.array([size]), np.ones(1))
            assert (implausible(evidence, test) == "") == believed
    delay = [Accepted(scored([9, 11], candidate=one), (), (), 0.5)]
    here, elsewhere = (scored([9, 11], candidate=Candidate("velocity_lag", j, (2,))) for j in (1, 0))
    clock = [Accepted(scored([9, 11], candidate=Candidate("time_delay", None, (0, 1))), (), (), 0.5)]
    assert "clock" in shadow(scored([9, 11], candidate=one), clock, 6)
    assert "delay" in shadow(here, delay, 6)
    assert shadow(elsewhere, delay, 6) == ""


def test_around_zero_speed_names_are_known_to_less() -> None:
    """A quarter of the evidence neither parts two of them, nor is it enough for a second one beside the first."""
    bump, late = (Candidate(x, 1, (k,)) for k, x in enumerate(("stribeck", "velocity_lag")))
    drag = Candidate("viscous_friction", 1, (2,))
    best = scored([50.0, 50.0], evidence=100.0, candidate=bump)
    near, far = (scored([40.0, 40.0], evidence=e, candidate=late) for e in (80.0, 70.0))
    assert not told_apart(best, near) and told_apart(best, far)
    assert told_apart(best, scored([40.0, 41.0], evidence=80.0, candidate=drag))
    first = [Accepted(best, (), (), 0.5)]
    assert "%" in shadow(scored([9, 11], evidence=20.0, candidate=late), first, 6)
    delay = Candidate("time_delay", 1, (3,), (("around", 0.01),))
    assert "%" in shadow(scored([9, 11], evidence=20.0, candidate=delay), first, 6)
    assert shadow(scored([9, 11], evidence=20.0, candidate=drag), first, 6) == ""


def test_a_refusal_stands_where_looser_masses_change_its_evidence_by_less_than_tells_names_apart() -> None:
    same, other, gone = (scored([9, 11], candidate=Candidate("stribeck", j, (j,))) for j in range(3))
    before = {s.candidate.key: (60.0, s, "why") for s in (same, other, gone)}
    now = [replace(same, evidence=60.0 + 0.9 * APART), replace(other, evidence=60.0 - 1.1 * APART)]
    assert unmoved(before, now).keys() == {same.candidate.key}


def test_what_friction_rose_by_builds_up_over_a_short_travel_as_all_of_it_does() -> None:
    """A Stribeck peak of one Nm more lets one Nm more build up over a milliradian; no second finding."""
    short, long = (
        scored([40, 50], evidence=60.0, candidate=Candidate("presliding_hysteresis", 1, (2,), (("zs", zs),)))
        for zs in (0.001, 0.012)
    )
    for first in ("stribeck", "coulomb_friction"):
        risen = [Accepted(scored([90, 110], candidate=Candidate(first, 1, (0,))), (), (), 0.5)]
        assert "short travel" in shadow(short, risen, 6)
        assert "short travel" not in shadow(long, risen, 6)
    elsewhere = [Accepted(scored([90, 110], candidate=Candidate("stribeck", 0, (0,))), (), (), 0.5)]
    assert shadow(short, elsewhere, 6) == ""


def test_a_gain_is_no_finding_beside_a_mass_that_scales_with_it() -> None:
    load = Accepted(
        scored([90, 110], evidence=6000.0, candidate=Candidate("payload", None, (0,))), (), (), 0.5
    )
    gain, drag = (Candidate(x, 1, (k,)) for k, x in enumerate(("drive_gain", "viscous_friction"), 1))
    small, large = 80.0, 120.0  # nats; a tenth of the load's on each of six joints is 100
    assert "%" in shadow(scored([9, 11], evidence=small, candidate=gain), [load], 6)
    assert shadow(scored([9, 11], evidence=large, candidate=gain), [load], 6) == ""
    assert shadow(scored([9, 11], evidence=small, candidate=drag), [load], 6) == ""


def test_what_acts_at_reversals_need_not_improve_blocks_without_any() -> None:
    lag, drag = (Candidate(effect, 1, (2,)) for effect in ("velocity_lag", "viscous_friction"))
    gain = [90.0, 0.2, -0.3, 40.0, -0.1, 6.0, -0.2, 0.1]
    assert objection(scored(gain, candidate=lag, consistency=3.5), HALF) == ""
    assert "steady" in objection(scored(gain, candidate=drag, consistency=3.5), HALF)
    assert "steady" in objection(scored([*gain, -20.0, -30.0], candidate=lag, consistency=3.5), HALF)
    assert "steady" in objection(scored([130.0, 0.2, -0.3, -0.1], candidate=lag, consistency=3.5), HALF)


def test_slack_shows_in_blows_and_those_are_rare() -> None:
    slack = Candidate("backlash", 1, (2, 3), (("gap", 0.001), ("wider", 0.002)))
    gain = [1.2, 21.1, 12.4, 28.6, -40.1, 24.8, 153.2, 3.5]
    assert objection(scored(gain, candidate=slack, consistency=1.3), HALF) == ""
    assert "evidence" in objection(scored([1.2, 8.0, 12.0], evidence=20.0, candidate=slack), HALF)
    assert "improves" in objection(scored([-1.0, -2.0, -1.0, 90.0], candidate=slack), HALF)
    assert "explains" in objection(scored(gain, candidate=slack), Share(0.001, 0.001))
    mistimed = [-18.0, -13.1, 94.4, 17.5, -6.7, -1.5, 100.3]
    assert objection(scored(mistimed, candidate=slack, consistency=5.8), HALF) == ""
    assert "improves" in objection(scored(mistimed, candidate=slack, consistency=4.0), HALF)
    loud = [5 * x for x in mistimed]
    assert objection(scored(loud, evidence=900.0, candidate=slack, consistency=4.0), HALF) == ""
    assert "improves" in objection(scored(loud, evidence=900.0, candidate=slack, consistency=2.0), HALF)


@pytest.mark.parametrize(
    ("own", "theirs", "believed"),
    [(0.013, 0.009, False), (0.013, 0.005, True), (0.02, 0.0, True)],
)
def test_a_late_sign_that_other_joints_show_is_everyones(own, theirs, believed) -> None:
    assert (everyones(own, theirs) == "") == believed


@pytest.mark.parametrize(
    ("name", "simpler", "term"),
    [
        ("temperature_dependent_friction", "coulomb_friction", "temperature_dependent"),
        ("cable_spring", "current_offset", "spring"),
        ("nonlinear_viscous", "viscous_friction", "quadratic"),
        ("nonlinear_viscous", "stribeck", "power"),
    ],
)
def test_a_simpler_name_comes_first_where_it_explains_as_much(name, simpler, term) -> None:
    best_of, level = Candidate(name, 1, (0,), terms=(term,)), Candidate(simpler, 1, (1,))
    gain = [30.0, 40.0, 35.0]
    best = scored(gain, evidence=104.0, candidate=best_of)
    alike = scored(gain, evidence=100.0, candidate=level)
    worse = scored([1.0, 2.0, 1.0], evidence=60.0, candidate=level)
    elsewhere = scored(gain, evidence=100.0, candidate=Candidate(simpler, 2, (1,)))
    assert likelier([best, alike]) is alike
    assert likelier([best, worse]) is likelier([best, elsewhere]) is best


def test_freed_base_parameters_are_no_name_where_bodies_do_as_much() -> None:
    free, load, rotor = (
        Candidate(x, None, (k,)) for k, x in enumerate(("base_free", "payload", "rotor_inertia"))
    )
    best = scored([30.0, 40.0], evidence=100.0, candidate=free)
    most, some = (scored([30.0, 40.0], evidence=e, candidate=load) for e in (95.0, 70.0))
    other = scored([10.0, 15.0], evidence=40.0, candidate=rotor)
    assert bodies_first([best, most], lambda *_: 0.0)[0] is most
    assert bodies_first([best, some, other], lambda *_: 5.0) == [best, some, other]
    assert bodies_first([best, some, other], lambda *_: 25.0) == [some, best, other]
    assert bodies_first([most, best], lambda *_: 25.0) == [most, best]


@pytest.mark.parametrize(("stiffness", "believed"), [(8e3, True), (1.5e3, True), (300.0, False)])
def test_no_gear_is_softer_than_a_gear(stiffness, believed) -> None:
    soft = Candidate("joint_elasticity", 0, (0,), positive=True)
    test = Scored(soft, np.ones(4), 50.0, np.array([1 / stiffness]), np.ones(1))
    evidence = SimpleNamespace(setup=SimpleNamespace(friction=np.ones((1, 2))), has_reference=True)
    assert (implausible(evidence, test) == "") == believed


@pytest.mark.parametrize(
    ("parts", "believed"),
    [((0.4, 0.5), True), ((0.9, -0.1), True), ((0.1, 0.1), False), ((-1.1, 2.2), False), ((1.0, 1.0), False)],
)
def test_a_gear_that_swings_does_so_at_its_own_stiffness(parts, believed) -> None:
    soft = Candidate("joint_elasticity", 0, (0, 1), (("stiffness", 9e3), ("stiffer", 1.2e4)), whole=True)
    test = Scored(soft, np.ones(4), 50.0, np.array(parts), np.ones(2))
    evidence = SimpleNamespace(setup=SimpleNamespace(friction=np.ones((1, 2))), has_reference=True)
    assert (implausible(evidence, test) == "") == believed


def test_a_gear_that_swings_shakes_the_other_joints() -> None:
    soft, other, drag = (
        Candidate(x, j, (j,)) for j, x in enumerate(("joint_elasticity", "backlash", "viscous_friction"))
    )
    first = [Accepted(scored([90, 110], evidence=1000.0, candidate=soft), (), (), 0.5)]
    assert "moves the arm" in shadow(scored([9, 11], evidence=200.0, candidate=other), first, 6)
    assert shadow(scored([9, 11], evidence=400.0, candidate=other), first, 6) == ""
    assert shadow(scored([9, 11], evidence=200.0, candidate=drag), first, 6) == ""


@pytest.mark.parametrize(
    ("published", "change", "believed"), [(2.0, -1.6, True), (2.0, -1.9, False), (0.0, -1.9, True)]
)
def test_a_rotor_does_not_lose_nearly_all_of_its_inertia(published, change, believed) -> None:
    test = Scored(Candidate("rotor_inertia", 0, (0,)), np.ones(4), 50.0, np.array([change]), np.ones(1))
    physics = SimpleNamespace(reflected=np.array([published]))
    evidence = SimpleNamespace(setup=SimpleNamespace(physics=physics, friction=np.ones((1, 2))))
    assert (implausible(evidence, test) == "") == believed


@pytest.mark.parametrize(
    ("level", "viscous", "believed"),
    [(-0.02, -0.03, True), (-0.02, -0.25, False), (0.008, -0.03, True), (0.035, -0.03, False)],
)
def test_friction_falls_as_a_gear_warms_and_not_by_much(level, viscous, believed) -> None:
    """Parts of it a degree, of which two standard deviations are 0.5 % and 2 %."""
    warm = Candidate("temperature_dependent_friction", 0, (0, 1))
    size, std = np.array([level * 8.0, viscous * 5.0]), np.array([0.02, 0.05])
    evidence = SimpleNamespace(setup=SimpleNamespace(friction=np.array([[8.0, 5.0]])))
    test = Scored(warm, np.ones(4), 50.0, size, std)
    assert (implausible(evidence, test) == "") == believed


def test_a_gear_that_gives_way_turns_the_links_of_other_joints() -> None:
    soft = Candidate("joint_elasticity", 2, (0, 1), whole=True)
    gear = [Accepted(scored([900, 1100], evidence=2000.0, candidate=soft), (), (), 0.5)]
    cable, link = Candidate("cable_spring", 1, (2,)), Candidate("link_inertial", 1, (3,))
    drag = Candidate("nonlinear_viscous", 1, (4,))
    for pose in (cable, link):
        assert "gear" in shadow(scored([50, 50], candidate=pose), gear, 6)
        assert shadow(scored([250, 250], evidence=500.0, candidate=pose), gear, 6) == ""
    assert shadow(scored([50, 50], candidate=drag), gear, 6) == ""


def test_what_a_long_delay_leaves_is_no_body() -> None:
    late = Candidate("time_delay", None, (0, 1), (("around", 0.02), ("jerk", 1.0)))
    lighter = scored([150, 150], evidence=300.0, candidate=Candidate("rotor_inertia", 2, (2,)))
    for delay, told in ((0.02, "%"), (0.005, "")):
        first = replace(scored([2500, 2500], evidence=5000.0, candidate=late), size=np.array([delay, delay]))
        said = shadow(lighter, [Accepted(first, (), (), 0.5)], 6)
        assert told in said if told else said == ""
