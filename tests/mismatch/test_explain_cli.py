"""`residuum explain` on wrong options and on bad or thin recordings: an honest answer, or one line."""

import csv
import sys
from pathlib import Path

import numpy as np
import pytest
from answers import FILES, check, findings, names
from commands import residuum

from residuum.cli.main import main
from residuum.robots import load_robot
from residuum.virtual import Plant, simulate
from residuum.virtual.motions import HOME, fourier, still, sweep

ROBOT = load_robot("ur5e")[0]
MODEL = Path(__file__).resolve().parents[2] / "generated" / "ur5e_dof6" / "model.toml"


def table(path):
    with path.open() as file:
        return list(csv.reader(file))


def save(path, rows):
    with path.open("w", newline="") as file:
        csv.writer(file).writerows(rows)
    return path


@pytest.fixture(scope="session")
def thin(simulated, tmp_path_factory):
    """Name -> a recording that lacks something."""
    folder = tmp_path_factory.mktemp("thin")

    def run(name, motion, rate=125):
        simulate(ROBOT, Plant(), motion, rate, 1).recording.write_csv(folder / f"{name}.csv")

    run("one_pose", still(HOME, 20.0))
    run("one_joint", sweep(2, HOME, -2.2, -1.0, (0.2, 0.5, 1.0, 0.5, 0.7)))
    run("three_seconds", fourier(ROBOT, 3.0, seed=1))
    run("ten_hertz", fourier(ROBOT, 60.0, seed=1), 10)
    whole = table(simulated("clean", 3))
    header = whole[0]
    without = [k for k, n in enumerate(header) if not n.startswith("actual_qd")]
    save(folder / "no_speed.csv", [[r[k] for k in without] for r in whole])
    save(folder / "two_rows.csv", whole[:3])
    k = header.index("actual_q_2")
    stuck = [r if i < 1001 else [*r[:k], whole[1000][k], *r[k + 1 :]] for i, r in enumerate(whole)]
    save(folder / "stuck.csv", stuck)
    return folder


@pytest.fixture(scope="session")
def wrong(simulated, tmp_path_factory):
    """A folder of files that are no recordings of six joints."""
    folder = tmp_path_factory.mktemp("wrong")
    whole = table(simulated("clean", 3))
    three = [k for k, n in enumerate(whole[0]) if n == "timestamp" or n[-1] in "012"]
    save(folder / "three_joints.csv", [[r[k] for k in three] for r in whole])
    save(folder / "no_rows.csv", whole[:1])
    (folder / "empty.csv").write_text("")
    (folder / "garbage.csv").write_bytes(bytes(range(256)) * 20)
    return folder


def answered(out, *arguments):
    """Exit 0, nothing on stderr, a whole and strict answer: the findings and what was printed."""
    done = residuum("explain", *arguments, "--out", out)
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
    assert done.stderr == ""
    assert {p.name for p in out.iterdir()} >= FILES
    found = findings(out)
    check(found, int(arguments[arguments.index("--dof") + 1]) if "--dof" in arguments else 6)
    return found, done.stdout


@pytest.mark.slow
def test_one_pose_names_nothing_and_says_why(thin, tmp_path) -> None:
    found, said = answered(tmp_path / "o", thin / "one_pose.csv")
    assert found["findings"] == []
    assert "no joint moves" in said
    assert "explains these recordings to within their noise" not in said  # that cannot be known


@pytest.mark.slow
def test_one_joint_names_nothing_on_the_others(thin, tmp_path) -> None:
    found, said = answered(tmp_path / "o", thin / "one_joint.csv")
    assert "friction and inertia of joint" in said
    local = [f for f in found["findings"] if len(f["joints"]) == 1]
    assert {j for f in local for j in f["joints"]} <= {2}


@pytest.mark.slow
def test_three_seconds_are_too_few(thin, tmp_path) -> None:
    found, said = answered(tmp_path / "o", thin / "three_seconds.csv")
    assert (found["verdict"], found["findings"]) == ("bad_data", [])
    assert "too few to name anything" in said


@pytest.mark.slow
def test_no_speed_column_is_said(thin, tmp_path) -> None:
    _, said = answered(tmp_path / "o", thin / "no_speed.csv")
    assert "speeds were not recorded" in said


@pytest.mark.slow
def test_ten_hertz_names_nothing_fast(thin, tmp_path) -> None:
    found, said = answered(tmp_path / "o", thin / "ten_hertz.csv")
    assert "10 Hz is too slow" in said
    fast = {"time_delay", "joint_elasticity", "backlash", "velocity_lag", "presliding_hysteresis"}
    assert fast.isdisjoint(names(found))


@pytest.mark.slow
def test_a_stuck_encoder_is_a_fault_of_the_data(thin, tmp_path) -> None:
    found, said = answered(tmp_path / "o", thin / "stuck.csv")
    assert found["verdict"] == "bad_data"
    assert names(found) == ["data_fault"]
    assert found["findings"][0]["joints"] == [3]
    assert "stuck.csv" in said


@pytest.mark.slow
def test_two_rows_are_no_recording(thin, tmp_path) -> None:
    found, _ = answered(tmp_path / "o", thin / "two_rows.csv")
    assert found["verdict"] == "bad_data"


@pytest.mark.slow
def test_a_file_given_again_is_refused_or_said(simulated, tmp_path) -> None:
    """Its copy would prove on left-out blocks what was fitted to the same samples."""
    path = simulated("clean", 3)
    done = residuum("explain", path, path, "--out", tmp_path / "o")
    assert done.returncode == 2 or "twice" in done.stdout + done.stderr


@pytest.mark.slow
def test_a_recording_is_not_its_own_reference(simulated, tmp_path) -> None:
    path = simulated("clean", 3)
    done = residuum("explain", path, "--reference", path, "--out", tmp_path / "o")
    assert done.returncode == 2 or "twice" in done.stdout + done.stderr


@pytest.mark.slow
def test_several_files_after_one_reference_option(simulated, tmp_path) -> None:
    """As the help has it; otherwise the second healthy one counts as observed, without a word."""
    out = tmp_path / "o"
    arguments = (simulated("payload", 3), "--reference", simulated("clean", 1), simulated("clean", 2))
    done = residuum("explain", *arguments, "--out", out)
    assert done.returncode == 0, done.stderr
    assert names(findings(out)) == ["payload"]
    assert {p["recording"] for p in findings(out)["where"]} <= {"payload_3.csv"}


@pytest.mark.slow
def test_a_joint_that_was_left_out_does_not_make_a_name_for_another_cause(simulated, tmp_path) -> None:
    """The wrist moves and the model of three joints holds it still: that is frozen_joint_coupling."""
    found, _ = answered(tmp_path / "o", simulated("clean", 3), "--dof", 3)
    assert "time_delay" not in names(found)


@pytest.mark.slow
def test_terms_of_the_given_model_are_kept(simulated, tmp_path) -> None:
    """What an earlier answer named is in its model: explained, and not named again."""
    observed, reference = simulated("load", 3), ("--reference", simulated("clean", 1))
    answered(tmp_path / "first", observed, *reference)
    model = tmp_path / "first" / "model.toml"
    answered(tmp_path / "second", simulated("load", 4), "--model", model)
    assert "load_dependent" in model.read_text()
    assert 'name = "load_dependent"' in (tmp_path / "second" / "model.toml").read_text()
    second = findings(tmp_path / "second")["findings"]
    assert ("load_dependent_friction", [2]) not in [(f["effect"], f["joints"]) for f in second]


BAD = {
    "missing file": (["{wrong}/none.csv"], "none.csv: cannot be read"),
    "missing reference": (["{good}", "--reference", "{wrong}/none.csv"], "none.csv"),
    "empty": (["{wrong}/empty.csv"], "empty.csv: the file is empty"),
    "no rows": (["{wrong}/no_rows.csv"], "no_rows.csv: there are no rows"),
    "garbage": (["{wrong}/garbage.csv"], "garbage.csv"),
    "too few joints": (["{wrong}/three_joints.csv"], "--dof 3"),
    "robot and model": (["{good}", "--robot", "ur5e", "--model", "{model}"], "exclude each other"),
    "no such robot": (["{good}", "--robot", "ur99"], "ur99"),
    "no such model": (["{good}", "--model", "{wrong}/none.toml"], "none.toml"),
    "model is no TOML": (["{good}", "--model", "{good}"], "not valid TOML"),
    "dof beside the model's": (["{good}", "--model", "{model}", "--dof", "3"], "--dof 3"),
    "dof out of range": (["{good}", "--dof", "9"], "--dof"),
    "no recording": ([], "REC"),
    "no such option": (["{good}", "--bogus"], "--bogus"),
    "a folder": (["{wrong}"], "wrong"),
}


@pytest.mark.parametrize(("arguments", "words"), BAD.values(), ids=BAD)
def test_bad_input_is_one_line(arguments, words, simulated, wrong, tmp_path, capsys, monkeypatch) -> None:
    """In this process, as the installed script calls it."""
    named = {"wrong": wrong, "good": simulated("clean", 3), "model": MODEL}
    out = tmp_path / "o"
    given = ["residuum", "explain", *(a.format(**named) for a in arguments), "--out", str(out)]
    monkeypatch.setattr(sys, "argv", given)
    with pytest.raises(SystemExit) as ended:
        main()
    said = capsys.readouterr().err
    assert ended.value.code == 2
    assert len(said.splitlines()) == 1, said
    assert words in said
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
@pytest.mark.parametrize("inside", [False, True], ids=["under a file", "a file of ours is a folder"])
def test_an_out_that_cannot_be_written(simulated, tmp_path, inside) -> None:
    out = tmp_path / "o"
    if inside:
        (out / "report.html").mkdir(parents=True)
    else:
        out = out / "below"
        out.parent.write_text("a file")
    done = residuum("explain", simulated("clean", 3), "--out", out)
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1
    assert "--out" in done.stderr
    assert not (out / "findings.json").exists()
    assert [p.name for p in tmp_path.iterdir()] == ["o"]


def test_help_has_an_example() -> None:
    done = residuum("explain", "--help")
    assert done.returncode == 0
    assert "Example: residuum explain" in done.stdout


@pytest.mark.slow
def test_jitter_and_a_gap_change_no_answer(simulated, tmp_path) -> None:
    """Two seconds are lost and stamps jitter by a millisecond; still the payload."""
    whole = table(simulated("payload", 3))
    rng = np.random.default_rng(1)
    kept = [whole[0]]
    for k, row in enumerate(whole[1:]):
        if not 1500 <= k < 1750:
            kept.append([f"{float(row[0]) + 1e-3 * rng.uniform(-1, 1):.6f}", *row[1:]])
    path = save(tmp_path / "holes.csv", kept)
    found, _ = answered(tmp_path / "o", path, "--reference", simulated("clean", 1))
    assert names(found)[:1] == ["payload"]
