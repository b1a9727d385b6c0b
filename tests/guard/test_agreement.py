"""The text that is uploaded, executed, against the NumPy observer and the same detectors in NumPy."""

from functools import cache

import numpy as np
import pytest
from guarding import WITHOUT_LIMIT, Printer, first_detection, model_of, real, scores, simulated, track

from residuum.recordings import read
from residuum.urscript import Dialect

DETECTORS = ("static", "speed", "cusum", "velocity", "vote")
SOURCES = ("modbus", "rtde")


@cache
def printer(robot: str, dof: int, static: float, per_speed: float = 0.0) -> Printer:
    return Printer(model_of(robot, dof, static, per_speed))


def compare(made: Printer, rows, source: str, detector: str, encoding: str = "signed"):
    """Run the guard over the rows; return its track, and the (step, joint) of NumPy's first detection."""
    observer = made.observer
    dof = observer.DOF
    text = made.guard(current_source=source, detector=detector)
    found = track(text, rows.world(encoding=encoding), len(rows.q), dof)
    seen = rows.back(1) if source == "rtde" else rows
    at = np.arange(found.frames[0], len(rows.q))
    residual = observer.Observer().run(seen.q[at, :dof], seen.qd[at, :dof], seen.current[at, :dof])
    told = len(found.frames)
    assert np.array_equal(found.frames, at[:told]), "the guard missed a step"
    assert np.abs(residual[:told] - found.residual).max() < 1e-9
    guarded = at[found.begin :]
    speed = seen.qd[guarded, :dof]
    limit = observer.THRESHOLDS + (detector != "static") * observer.THRESHOLDS_PER_SPEED * np.abs(speed)
    score = scores(detector, residual[found.begin :], limit, speed, seen.target_qd[guarded, :dof])
    assert np.abs(score[: told - found.begin] - found.score[found.begin :]).max() < 1e-6
    step, joint = first_detection(score)
    return found, (step + found.begin if step >= 0 else -1, joint)


@pytest.mark.parametrize("detector", DETECTORS)
@pytest.mark.parametrize("source", SOURCES)
@pytest.mark.parametrize("dof", [3, 6])
def test_simulated_collision_is_detected_in_numpys_step(dof, source, detector) -> None:
    made = printer("ur5e", dof, 25.0, 8.0)
    rows = simulated(made.observer, dof=dof)
    found, (step, joint) = compare(made, rows, source, detector)
    assert joint == found.joint == 2
    assert step == len(found.frames) - 1
    assert 1320 < found.frames[-1] < 1420, "the push begins in frame 1320"


@pytest.mark.parametrize("encoding", ["signed", "unsigned"])
def test_both_register_encodings_are_understood(encoding) -> None:
    made = printer("ur5e", 3, 25.0, 8.0)
    rows = simulated(made.observer, dof=3)
    found, (step, joint) = compare(made, rows, "modbus", "speed", encoding)
    assert (rows.current < 0).any() and (step, joint) == (len(found.frames) - 1, found.joint)


@pytest.mark.parametrize(
    "choice",
    [
        {"strict_numbers": True},
        {"integer_division": "whole"},
        {"slice": 100},
        {"budget": 2000},
    ],
    ids=str,
)
def test_what_is_unknown_of_the_language_does_not_matter(choice) -> None:
    made = printer("ur5e", 3, 25.0, 8.0)
    rows, text = simulated(made.observer, dof=3), made.guard(detector="vote")
    usual = track(text, rows.world(), len(rows.q), 3)
    other = track(text, rows.world(), len(rows.q), 3, Dialect(**choice))
    assert np.array_equal(usual.frames, other.frames) and usual.joint == other.joint == 2
    assert np.array_equal(usual.residual, other.residual)


@pytest.mark.parametrize("source", SOURCES)
def test_real_motion_gives_numpys_residual(source, real_recordings) -> None:
    made = printer("ur10e", 6, WITHOUT_LIMIT)
    rows = real(made.observer, read(real_recordings / "ur10e" / "unloaded_03.csv"), seconds=4.0)
    found, (step, _) = compare(made, rows, source, "speed")
    assert step == -1 and len(found.frames) > 2000
    assert np.abs(found.residual).max() > 1.0, "a real motion has a residual"


@pytest.mark.parametrize("detector", DETECTORS)
def test_real_deviation_is_detected_in_numpys_step(detector, real_recordings) -> None:
    made = printer("ur10e", 6, 7.5, 2.0)
    rows = real(made.observer, read(real_recordings / "ur10e" / "one_joint_3.csv"), seconds=12.0)
    found, (step, joint) = compare(made, rows, "modbus", detector)
    print(detector, step, joint, found.begin)
    assert joint == found.joint > 0
    assert step == len(found.frames) - 1 > found.begin + 200


@pytest.mark.slow
@pytest.mark.parametrize("name", ["unloaded_10", "one_joint_2", "pushed_by_hand_at_rest", "still_pose_04"])
@pytest.mark.parametrize("source", SOURCES)
def test_whole_recordings_give_numpys_residual(name, source, real_recordings) -> None:
    made = printer("ur10e", 6, WITHOUT_LIMIT)
    rows = real(made.observer, read(real_recordings / "ur10e" / f"{name}.csv"))
    found, (step, _) = compare(made, rows, source, "vote")
    assert step == -1 and found.frames[-1] == len(rows.q) - 1


def test_subtracted_bias_is_the_mean_at_rest() -> None:
    made = printer("ur5e", 3, 25.0, 8.0)
    rows = simulated(made.observer, dof=3)
    rows.current[:, 1] += 0.8
    text = made.guard(bias="subtract", detector="static")
    found = track(text, rows.world(), len(rows.q), 3)
    bias = found.residual[found.begin - 90 : found.begin].mean(axis=0)
    assert abs(bias[1] + 0.8 * made.observer.GAINS[1]) < 0.2
    assert np.allclose(
        found.score[found.begin :], np.abs(found.residual[found.begin :] - bias) / 25.0, atol=1e-9
    )
