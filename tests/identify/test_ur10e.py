"""Thirteen real unloaded runs of a UR10e, one left out at a time; published reference figures beside ours.

Rows: four to a period of the 10 Hz zero-phase low-pass on both sides (order 4, momentum form). The norm is
over rows at which any joint is faster than 0.01 rad/s; "with rests" over all. Gains are the published ones,
as in the reference; percentages do not depend on them.
"""

import numpy as np
import pytest

from residuum.codegen.generate import generate
from residuum.codegen.load import load_text
from residuum.identify.baseline import Options, fit_files
from residuum.identify.estimate import held_out
from residuum.identify.gains import unseen_gains
from residuum.identify.model_file import build_model
from residuum.identify.motion import predicted_current, score
from residuum.identify.schedule import scheduler
from residuum.identify.thesis import fit_thesis
from residuum.recordings import read
from residuum.recordings.audit import clean
from residuum.robots import load_robot

PUBLISHED_GAINS = (14.87, 13.26, 11.13, 10.62, 11.03, 11.47)
REFERENCE_PERCENT = np.array([8.8, 4.4, 4.5, 9.3, 14.2, 11.5])
REFERENCE_RMS = np.array([2.24, 3.41, 1.24, 0.389, 0.527, 0.441])


@pytest.fixture(scope="module")
def robot():
    return load_robot("ur10e")


@pytest.fixture(scope="module")
def runs(pytestconfig):
    folder = pytestconfig.rootpath.parent / "shared" / "recordings" / "ur10e"
    if not folder.is_dir():
        pytest.skip("the shared real recordings are not beside this checkout")
    return sorted(folder.glob("unloaded_*.csv"))


@pytest.fixture(scope="module")
def baseline(robot, runs):
    with scheduler(workers=1) as at:
        return fit_files(runs, *robot, 6, Options(gains=PUBLISHED_GAINS), at)


def row(label, values, digits=2):
    return f"{label:34}" + "".join(f"{x:9.{digits}f}" for x in values)


def test_left_out_errors_are_below_the_published_ones(baseline, robot, runs, capsys):
    errors = baseline.held_out
    data, digest = robot
    joints = tuple(
        j.model_copy(update={"torque_constant": g / j.gear})
        for j, g in zip(data.joint, PUBLISHED_GAINS, strict=True)
    )
    thesis = fit_thesis(runs, data.model_copy(update={"joint": joints}), digest)
    with capsys.disabled():
        print(
            f"\n{len(runs)} runs, {errors.count[:, 0].sum():.0f} rows with motion of {errors.count_all[:, 0].sum():.0f}"
        )
        print(row("error / torque, %: reference", REFERENCE_PERCENT, 1))
        print(row("error / torque, %: ours", errors.percent()))
        print(row("  where the joint itself moves", errors.percent("own")))
        print(row("  with rests", errors.percent("all")))
        print(row("  thesis' scheme", thesis.percent))
        print(row("rms, Nm: reference", REFERENCE_RMS, 3))
        print(row("rms, Nm: ours", errors.rms(), 3))
        print(row("  thesis' scheme", thesis.rms, 3))
        print(row("residual memory, s", baseline.fitted.noise.inflation * baseline.step))
    assert (errors.percent() <= REFERENCE_PERCENT).all()
    assert (thesis.percent > errors.percent()[:3]).all()


def test_weights_of_all_runs_do_not_leak_into_the_left_out_error(baseline, robot, runs):
    with scheduler(workers=1) as at:
        strict = fit_files(runs[:4] + runs[5:], *robot, 6, Options(gains=PUBLISHED_GAINS), at)
    theta = strict.fitted.estimate.theta
    kept = baseline.fitted.folds[4]
    errors = [
        np.append(-theta[ix], 1.0) @ s.scored @ np.append(-theta[ix], 1.0)
        for ix, s in zip(baseline.problem.indices, kept, strict=True)
    ]
    np.testing.assert_allclose(np.sqrt(errors), np.sqrt(baseline.held_out.scored[4]), rtol=0.01)


def test_prediction_from_motion_alone_matches_the_held_out_error(baseline, robot, runs):
    """Each run is predicted by a model fitted to the others; filtered alike, the error is fit's own."""
    error, size = np.zeros(6), np.zeros(6)
    for k in (2, 6, 11):
        others = [r for i, r in enumerate(runs) if i != k]
        with scheduler(workers=1) as at:
            found = fit_files(others, *robot, 6, Options(gains=PUBLISHED_GAINS), at)
        model = build_model(found, unseen_gains(found.nominal), None)
        module = load_text(generate(model).files["observer.py"])
        motion, _ = clean(read(runs[k], current=False), motion_only=True)
        predicted = predicted_current(motion, module)
        assert not motion.current.any()
        measured = clean(read(runs[k]))[0]
        assert np.array_equal(measured.timestamp, motion.timestamp)
        sums = score(measured, measured.current, predicted)
        error, size = error + sums[0], size + sums[1]
    expected = baseline.held_out
    folds = [2, 6, 11]
    percent = 100 * np.sqrt(expected.scored[folds].sum(axis=0) / expected.torque[folds].sum(axis=0))
    np.testing.assert_allclose(100 * np.sqrt(error / size), percent, rtol=0.05)


def test_physical_consistency_costs_nothing_of_note(baseline):
    from dataclasses import replace

    free = held_out(baseline.fitted, replace(baseline.problem, mapping=None, positive=()))
    assert (baseline.held_out.percent() < 1.02 * free.percent()).all()
