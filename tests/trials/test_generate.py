"""Outlines, draws and cases: shares, sizes, and that the same seed gives the same files."""

from collections import Counter

import numpy as np
import pytest
from commands import residuum

from residuum.errors import InputError
from residuum.recordings import read
from residuum.robots import load_robot
from residuum.trials import catalogue, healthy, paths
from residuum.trials.answering import CaseFiles, case_files
from residuum.trials.case import make
from residuum.trials.files import read_json, sha256
from residuum.trials.plan import Outline, outlines
from residuum.trials.scene import Scene, add
from residuum.trials.stages import Trial, answer_stage, generate_stage, score_stage
from residuum.virtual import Plant, Simulator, motions

SHORT = (10.0, 12.0)


def nothing(files: CaseFiles):
    """Answer that nothing is missing, once all files are there."""
    assert all(read(path).time.size for path in files.recordings)
    return {"schema": 1, "verdict": "nothing_missing", "findings": []}


def broken(files: CaseFiles):
    raise RuntimeError(f"no answer for {files.robot}")


@pytest.mark.parametrize("cases", [1, 20, 200])
def test_shares_of_the_outlines(cases) -> None:
    found = outlines(cases, 3)
    kinds = Counter(o.kind for o in found)
    assert len(found) == cases and found == outlines(cases, 3)
    assert kinds["clean"] >= 0.27 * cases
    if cases > 1:
        assert kinds["outside"] >= 0.16 * cases and kinds["catalogue"] >= 0.5 * cases
        for part in (lambda o: o.reference, lambda o: o.rate == 500):
            assert abs(sum(map(part, found)) - cases / 2) <= 2
        assert all(o.kind == "catalogue" for o in found if o.two)


@pytest.fixture(scope="module")
def scene():
    robot, _ = load_robot("ur5e")
    path = motions.fourier(robot, 10.0, seed=3)
    return Scene(robot, (path, path), healthy.factory(robot), np.random.default_rng(5), True)


@pytest.mark.parametrize("name", [*catalogue.CATALOGUE, *catalogue.OUTSIDE])
def test_every_draw_makes_a_plant_at_its_bounds(name, scene) -> None:
    for _ in range(2):
        drawn = (catalogue.CATALOGUE | catalogue.OUTSIDE)[name](scene)
        assert drawn.name == name and drawn.low <= drawn.start <= drawn.high
        assert name.startswith("outside.") or all(1 <= j <= 6 for j in drawn.joints)
        for size in (drawn.start, drawn.high):
            plants = [add(Plant(), drawn.build(size, k)) for k in range(2)]
            assert name in plants[0].effects() or name in plants[1].effects()
            assert drawn.truth(size)
        Simulator(scene.robot, plants[0], scene.motions[0].q[0])


def test_plain_robots_have_straight_friction_and_rich_ones_do_not() -> None:
    from residuum.virtual.friction import curves

    robot, _ = load_robot("ur10e")
    speed, rng = np.array([0.2, 0.7, 1.2, 1.7]), np.random.default_rng(0)
    for kind, straight in ((healthy.plain, True), (healthy.rich, False)):
        for curve in curves(robot, kind(robot, rng).friction):
            bend = np.abs(np.diff(curve.drag(speed), 2)).max()
            assert bool(bend < 1e-9) is straight


def test_recordings_are_as_long_as_asked() -> None:
    robot, _ = load_robot("ur5e")
    path = paths.recording(robot, np.random.default_rng(1), (20.0, 22.0))
    assert 20.0 <= path.duration <= 22.0
    assert np.abs(np.diff(path.q, axis=0)).max() < 0.01  # no jumps between parts


def test_a_case_hides_what_it_says() -> None:
    case = make(Outline(3, 8, "catalogue", False, True, 125, "ur5e", SHORT))
    (effect,) = case.truth["effects"]
    assert effect["size"] == case.truth["size"] >= 0.15
    assert effect["limited"] or abs(effect["size"] / effect["target"] - 1.0) < 0.35
    assert case.truth["reference"] and len(case.reference) in (2, 3)
    assert effect["effect"] in {n for run in case.observed for n in run.truth.effects}


def test_the_command_says_what_is_wrong_in_one_line(tmp_path) -> None:
    command = ("trial", "--cases", 2, "--seed", 1, "--out", tmp_path / "new")
    for options, remedy in ((["--seconds", "20", "12"], "shorter"), (["--stage", "answer"], "generate")):
        done = residuum(*command, *options)
        assert done.returncode == 2 and remedy in done.stderr and done.stderr.count("\n") == 1


@pytest.mark.slow
def test_a_trial_from_seed_to_score(tmp_path) -> None:
    trial = Trial(4, 11, SHORT)
    for name, workers in (("one", 1), ("two", 2)):
        generate_stage(tmp_path / name, trial, workers)
    assert (tmp_path / "one" / "seal.txt").read_text() == (tmp_path / "two" / "seal.txt").read_text()
    files = sorted((tmp_path / "one" / "cases").rglob("*.*"))
    assert files and all(
        sha256(f) == sha256(tmp_path / "two" / f.relative_to(tmp_path / "one")) for f in files
    )
    answer_stage(tmp_path / "one", nothing)
    before = (tmp_path / "one" / "answers" / "001.json").stat().st_mtime_ns
    answer_stage(tmp_path / "one", broken)  # all are answered, so nothing is asked again
    assert (tmp_path / "one" / "answers" / "001.json").stat().st_mtime_ns == before
    found = score_stage(tmp_path / "one")
    assert found["cases"] == 4 and found["clean"]["all"]["named"]["count"] == 0
    answer_stage(tmp_path / "two", broken)
    assert len(score_stage(tmp_path / "two")["failures"]) == 4
    with pytest.raises(InputError, match="another trial"):
        generate_stage(tmp_path / "one", Trial(4, 12, SHORT))
    assert "effects" not in read_json(tmp_path / "one" / "cases" / "001" / "case.json")
    assert case_files(tmp_path / "one" / "cases" / "001").recordings[0].suffix == ".parquet"


def test_effects_come_up_equally_often() -> None:
    for reference in (True, False):
        tried = Counter(
            o.first for o in outlines(400, 1) if o.kind == "catalogue" and o.reference is reference
        )
        assert set(tried) == set(catalogue.names(reference))
        assert max(tried.values()) - min(tried.values()) <= 1
