"""Thresholds of a refined model: from its own observer, on motion that nothing touched."""

from dataclasses import replace

import numpy as np
import pytest

from residuum.mismatch import limits
from residuum.mismatch.limits import with_thresholds
from residuum.mismatch.proof import FALSE_ALARMS
from residuum.recordings import read
from residuum.robots import load_robot
from residuum.symbolic.nominal import nominal_model

ROBOT, DIGEST = load_robot("ur5e")
ONE = np.ones(6)


@pytest.fixture(scope="module")
def recordings(simulated):
    return [read(simulated("clean", seed)) for seed in (1, 2)]


@pytest.fixture(scope="module")
def model():
    return nominal_model(ROBOT, DIGEST, 6)


def test_they_are_of_one_false_alarm_an_hour_and_grow_with_the_held_out_error(recordings, model) -> None:
    plain, doubled = (with_thresholds(model, recordings, k * ONE, []).thresholds for k in (1.0, 2.0))
    assert plain.false_alarms_per_hour == FALSE_ALARMS
    assert min(plain.static) > 0
    np.testing.assert_allclose(doubled.static, 2 * np.array(plain.static), rtol=1e-4)
    assert plain.hours == pytest.approx(1 / 60, rel=0.1)


def test_a_touch_is_no_free_motion(recordings, model) -> None:
    """A blow of 100 Nm on joint 1 raises its limit, unless its time is left out."""
    first = recordings[0]
    begin = float(first.timestamp[0]) + 10.0
    struck = first.current.copy()
    struck[(first.timestamp > begin) & (first.timestamp < begin + 0.2), 0] += (
        100.0 / ROBOT.joint[0].drive_gain
    )
    touched = [replace(first, current=struck), recordings[1]]
    free, seen, left_out = (
        with_thresholds(model, some, ONE, spans).thresholds.static[0]
        for some, spans in ((recordings, []), (touched, []), (touched, [(begin, begin + 0.2)]))
    )
    assert seen > 2 * free
    assert left_out == pytest.approx(free, rel=0.2)


def test_of_long_recordings_the_middle_is_enough(recordings, model, monkeypatch) -> None:
    whole = with_thresholds(model, recordings, ONE, []).thresholds
    monkeypatch.setattr(limits, "_MOST", 5000)
    middle = with_thresholds(model, recordings, ONE, []).thresholds
    assert middle.hours == pytest.approx(5000 / recordings[0].rate / 3600, rel=0.15)
    assert middle.hours < whole.hours
    np.testing.assert_allclose(middle.static, whole.static, rtol=0.7)


def test_too_little_motion_gives_none(recordings, model) -> None:
    start = float(recordings[0].timestamp[0])
    assert with_thresholds(model, recordings[:1], ONE, [(start, start + 20.0)]) is model
