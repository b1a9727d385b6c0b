"""Every check: the case that triggers it, and sound recordings that trigger nothing."""

from dataclasses import replace
from math import degrees

import numpy as np
import pytest

from residuum.errors import InputError
from residuum.recordings import read
from residuum.recordings.audit import audit, clean


def kinds(recording):
    return {f.kind: f for f in audit(recording).findings}


def only(recording, kind, severity):
    """The one finding expected: nothing else may be said."""
    found = kinds(recording)
    assert set(found) == {kind}
    assert found[kind].severity == severity
    return found[kind]


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("rate", [25.0, 125.0, 500.0])
def test_sound_recordings_are_good(make, seed, rate):
    report = audit(make(seed=seed, rate=rate))
    assert report.findings == ()
    assert report.verdict == "good"
    assert report.summary["rate"].value == pytest.approx(rate)


def test_sound_without_speeds_and_targets(make):
    made = make().without(["qd", "target_current"])
    assert set(kinds(made)) == {"missing_channel"}


def test_jitter_and_lost_samples_are_no_fault(make):
    made = make(rate=500)
    rng = np.random.default_rng(0)
    kept = np.sort(rng.choice(len(made), size=len(made) // 3, replace=False))
    assert audit(made.take(kept)).verdict == "good"
    late = replace(made, timestamp=made.timestamp + rng.uniform(0, 0.0015, len(made)))
    assert audit(late).verdict == "good"


def test_non_finite_rows_are_dropped(make, changed):
    bad = changed(make(), q=((10, 2), np.nan), current=((20, 0), np.inf))
    finding = only(bad, "not_finite", "dropped")
    assert finding.rows == ((12, 12), (22, 22))
    assert len(clean(bad)[0]) == len(bad) - 2


def test_an_optional_channel_full_of_holes_goes_instead_of_the_rows(make, changed):
    made = replace(make(), joint_temperatures=np.full((2000, 6), np.nan))
    kept, report = clean(made)
    assert kept.joint_temperatures is None
    assert len(kept) == 2000
    assert [f.kind for f in report.findings] == ["channel_unusable"]


@pytest.mark.parametrize(("name", "value"), [("q", 1e290), ("qd", -99.0), ("current", 253.0)])
def test_absurd_values_are_dropped(make, changed, name, value):
    bad = changed(make(), **{name: ((slice(50, 53), 1), value)})
    finding = only(bad, "absurd", "dropped")
    assert (finding.rows, finding.joints) == (((52, 54),), (2,))


def test_the_last_joint_may_turn_without_end(make):
    made = make()
    assert audit(replace(made, q=made.q + np.array([0, 0, 0, 0, 0, 40.0]))).verdict == "good"


def test_plausible_rows_from_elsewhere_are_dropped(make, changed):
    bad = changed(make(), q=((100, slice(None)), 0.3), qd=((100, slice(None)), 0.1))
    assert only(bad, "torn_rows", "dropped").rows == ((102, 102),)


def test_a_jump_between_two_motions_is_noted(make, changed):
    made = make()
    moved = replace(made, q=made.q + np.where(np.arange(len(made)) < 900, 0.0, 0.5)[:, None])
    assert only(moved, "jump", "note").rows == ((901, 902),)


def test_duplicate_rows(make):
    made = make()
    finding = only(made.take(np.sort(np.r_[np.arange(2000), 500])), "duplicate_rows", "dropped")
    assert finding.numbers["rows"].value == 1


def test_time_that_jumps_and_comes_back(make, changed):
    bad = changed(make(), timestamp=(70, 5e9))
    assert only(bad, "time_jumps", "dropped").rows == ((72, 72),)
    bad = changed(make(), timestamp=(70, 100.01))
    assert only(bad, "time_jumps", "dropped").rows == ((72, 72),)


def test_time_that_starts_again_is_refused(make, changed):
    made = make()
    finding = only(
        replace(made, timestamp=np.r_[made.timestamp[:900], made.timestamp[:1100]]), "time_restarts", "refuse"
    )
    assert "902" in finding.text


def test_time_that_stalls(make, changed):
    made = make()
    few = changed(made, timestamp=(slice(71, 73), made.timestamp[70]))
    assert only(few, "time_stalls", "dropped").rows == ((73, 74),)
    coarse = replace(made, timestamp=np.floor(made.timestamp * 20) / 20)
    only(coarse, "time_stalls", "refuse")


def test_gaps_are_noted_with_their_place(make):
    made = make()
    finding = only(made.take(np.r_[0:500, 600:2000]), "gap", "note")
    assert finding.rows == ((501, 602),)
    assert finding.numbers["longest"].value == pytest.approx(1.01)


@pytest.mark.parametrize(
    ("q", "qd", "says"),
    [
        (degrees(1), 1, "positions"),
        (1, degrees(1), "speeds"),
        (degrees(1), degrees(1), "degrees"),
        (1000, 1, "mrad"),
        (degrees(1), None, "degrees"),
    ],
)
def test_units_are_refused(make, q, qd, says):
    made = make()
    finding = only(replace(made, q=made.q * q, qd=made.qd * qd if qd else None), "units", "refuse")
    assert says in finding.text
    assert finding.remedy


def test_time_in_milliseconds_is_refused(make):
    made = make()
    assert "ms" in only(replace(made, timestamp=made.timestamp * 1000), "units", "refuse").text


def test_turned_speeds_are_refused(make, changed):
    made = make()
    assert only(changed(made, qd=((slice(None), 3), -made.qd[:, 3])), "sign", "refuse").joints == (4,)


def test_swapped_joints_are_refused(make):
    made = make()
    order = [0, 2, 1, 3, 4, 5]
    assert only(replace(made, q=made.q[:, order]), "swapped_joints", "refuse").joints == (2, 3)
    by_target = replace(made, q=made.q[:, order], qd=None, target_q=np.array(made.q))
    assert only(by_target, "swapped_joints", "refuse").joints == (2, 3)


def test_contradicting_speeds_are_refused(make, changed):
    made = make()
    noise = np.random.default_rng(1).normal(size=len(made)).cumsum() / 10
    assert only(
        changed(made, qd=((slice(None), 0), np.clip(noise, -3, 3))), "contradiction", "refuse"
    ).joints == (1,)


def test_dead_and_frozen_and_clipped_currents(make, changed):
    made = make()
    assert only(changed(made, current=((slice(None), 1), 0.0)), "stuck", "refuse").joints == (2,)
    found = kinds(changed(made, current=((slice(300, 400), 1), 0.7)))
    assert set(found) == {"stuck", "gap"}  # the rows dropped leave a gap
    assert found["stuck"].rows == ((302, 401),)
    limit = float(np.quantile(made.current[:, 1], 0.97))
    clipped = changed(made, current=((slice(None), 1), np.minimum(made.current[:, 1], limit)))
    assert set(kinds(clipped)) == {"saturated", "gap"}


def test_coarse_currents_are_not_frozen(make):
    made = make()
    assert audit(replace(made, current=np.round(made.current, 1))).verdict == "good"


def test_a_stalled_recorder_is_seen(make):
    made = make(rate=500)
    index = np.arange(len(made))
    index[1000:1050] = 999
    stalled = replace(made.take(index), timestamp=made.timestamp, rows=made.rows)
    found = kinds(stalled)
    assert {"stalled_rows", "torn_rows"} & set(found)
    assert clean(stalled)[0].rows.tolist() == [r for r in made.rows if not 1002 <= r < 1052]


def test_rest_without_noise_is_no_fault(make):
    made = make()
    at = np.minimum(np.arange(len(made)), 1000)
    resting = replace(
        made, q=made.q[at], qd=np.where(np.arange(2000)[:, None] < 1000, made.qd, 0), current=made.current[at]
    )
    assert "stuck" not in kinds(resting)


def test_a_delay_is_noted_with_its_size(make):
    finding = only(make(seconds=40, delay=0.03), "clock_offset", "note")
    assert finding.numbers["delay"].value == pytest.approx(0.03, abs=5 * finding.numbers["std"].value + 1e-3)
    without_target = kinds(make(seconds=40, delay=0.03).without(["target_current"]))
    assert without_target["clock_offset"].numbers["delay"].value == pytest.approx(0.03, abs=0.005)


def test_a_current_spike_is_noted_and_kept(make, changed):
    assert only(changed(make(), current=((800, 2), 30.0)), "current_spike", "note").rows == ((802, 802),)


def test_thin_recordings_are_noted(make):
    still = make()
    still = replace(still, q=np.zeros_like(still.q) + 1e-5, qd=np.zeros_like(still.q))
    assert set(kinds(still)) == {"single_pose"}
    made = make()
    first = np.arange(6) == 0
    assert set(kinds(replace(made, q=made.q * first, qd=made.qd * first))) == {"one_joint_moving"}
    assert set(kinds(make(seconds=1))) == {"short"}
    assert set(kinds(make(rate=10, seconds=60))) == {"slow_rate"}
    assert set(kinds(make(joints=3))) == {"missing_joints"}


def test_nothing_left_is_refused(make, changed):
    only(make().take(slice(0, 5)), "too_few_rows", "refuse")
    bad = changed(make(), current=((slice(0, 1200), 0), np.nan))
    assert kinds(bad)["mostly_bad"].severity == "refuse"
    with pytest.raises(InputError, match="record again"):
        audit(bad).require()


def test_rows_lost_in_reading_are_in_the_report(make, write):
    path = write(make(seconds=3))
    path.write_text(path.read_text() + "1,2,3\n")
    finding = only(read(path), "unreadable_rows", "dropped")
    assert finding.rows == ((302, 302),)
    assert audit(read(path)).rows_read == 301


GOOD = [
    "ur10e/unloaded_*.csv", "ur10e/loaded_*.csv", "ur10e/one_joint_*.csv", "ur10e/still_pose_*.csv",
    "ur10e/pushed*.csv", "ur3e_one_joint/*.csv", "ur10_collisions/*.csv", "awkward/ur3e_174_columns.csv",
]  # fmt: skip
HARMLESS = {"missing_channel", "one_joint_moving", "single_pose", "current_spike"}


@pytest.mark.parametrize("pattern", GOOD)
def test_no_false_alarm_on_real_recordings(shared, pattern):
    files = sorted(shared.glob(pattern))
    assert files
    for file in files:
        report = audit(read(file))
        assert report.verdict == "good", (file.name, report.findings)
        assert {f.kind for f in report.findings} <= HARMLESS, file.name


def test_the_corrupt_rows_of_a_real_recording(shared):
    recording = read(shared / "awkward" / "ur10e_corrupt_rows.csv")
    kept, report = clean(recording)
    assert report.verdict == "usable"
    np.testing.assert_array_equal(kept.rows, np.arange(22, 1141))
