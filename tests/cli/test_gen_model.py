"""gen-model as a user meets it: what it writes, and one line for every kind of bad input."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from commands import gen_model

from residuum.robots import load_robot

FILES = {
    "__init__.py",
    "observer.py",
    "observer.c",
    "observer.h",
    "collision_guard.script",
    "model.md",
    "model.toml",
}
UR5E = Path(__file__).resolve().parents[2] / "robots" / "ur5e.toml"


def refused(done: subprocess.CompletedProcess[str]) -> str:
    """One line on stderr, exit 2, no traceback; return the line."""
    assert done.returncode == 2
    assert done.stdout == ""
    lines = done.stderr.strip().splitlines()
    assert len(lines) == 1
    assert "Traceback" not in lines[0]
    return lines[0]


def test_writes_the_tree_and_says_so(tmp_path) -> None:
    done = gen_model("--dof", 2, "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    assert {p.name for p in (tmp_path / "ur5e_dof2").iterdir()} >= FILES
    assert "operations" in done.stdout
    assert done.stderr == ""
    assert [p.name for p in tmp_path.iterdir()] == ["ur5e_dof2"]


def test_help_has_an_example() -> None:
    done = gen_model("--help")
    assert done.returncode == 0
    assert "Example: gen-model --dof 3" in done.stdout


@pytest.mark.parametrize("dof", [0, 7, -1])
def test_wrong_number_of_joints(dof, tmp_path) -> None:
    line = refused(gen_model("--dof", dof, "--out", tmp_path))
    assert f"--dof {dof}" in line
    assert "1 to 6" in line
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--dof", "3", "--robot", "ur5"], "did you mean ur5e"),
        (["--dof", "3", "--robot", "panda"], "known: ur10e, ur16e, ur3e, ur5e"),
        (["--dof", "three"], "three"),
        (["--robot", "ur5e"], "--dof"),
        (["--dof", "3", "--robot", "missing.toml"], "missing.toml: cannot be read"),
        (["--dof", "3", "--model", "missing.toml"], "leave --dof out"),
        (["--model", "missing.toml"], "missing.toml: cannot be read"),
        (["--dof", "4", "--variant", "thesis"], "--dof 3"),
        (["--dof", "3", "--locked-angles", "1,2"], "3 joints are left out, 2 angles given"),
        (["--dof", "3", "--locked-angles", "a,b,c"], "--locked-angles"),
        (["--dof", "3", "--gravity", "0,0"], "--gravity"),
        (["--dof", "3", "--gravity", "0,nan,1"], "finite"),
        (["--dof", "3", "--gain", "-1"], "--gain"),
        (["--dof", "3", "--reaction", "run"], "run"),
        (["--frobnicate"], "frobnicate"),
    ],
)
def test_bad_options_get_one_line(arguments, words, tmp_path) -> None:
    assert words in refused(gen_model(*arguments, "--out", tmp_path / "out", cwd=tmp_path))
    assert not (tmp_path / "out").exists()


def edited(tmp_path: Path, old: str, new: str) -> Path:
    text = UR5E.read_text()
    assert old in text
    path = tmp_path / "mine.toml"
    path.write_text(text.replace(old, new, 1))
    return path


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("mass = 8.058", "mass = 0.0", ["line 34", "link 2", "mass"]),
        (
            "inertia = [0.004095, 0.031209368,",
            "inertia = [0.004, 0.05,",
            ["line 49", "link 3", "triangle inequality"],
        ),
        ("gear = 101.0", "geer = 101.0", ["joint 1", "gear", "missing"]),
        ("gear = 101.0", "gear = 101.0\nteeth = 7", ["line 25", "teeth", "not a known key"]),
        ("gear = 101.0", "gear = ", ["line 24", "not valid TOML"]),
        ('alpha = "pi/2"', 'alpha = "half a turn"', ["line 20", "alpha", "multiple of pi"]),
        ("d = 0.1625", "d = inf", ["line 19", "finite"]),
        ("rotor_inertia = 'j", "rotor = 'j", ["rotor_inertia"]),
    ],
)
def test_robot_file_errors_name_line_and_key(old, new, words, tmp_path) -> None:
    line = refused(gen_model("--dof", 3, "--robot", edited(tmp_path, old, new), "--out", tmp_path / "out"))
    assert "mine.toml" in line
    for word in words:
        assert word in line


def test_a_robot_of_ones_own(tmp_path) -> None:
    path = edited(tmp_path, 'name = "ur5e"', 'name = "mine"')
    done = gen_model("--dof", 2, "--robot", path, "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert "mine_dof2_momentum" in (tmp_path / "out" / "mine_dof2" / "observer.c").read_text()


def test_model_file_generates_the_same_code(tmp_path) -> None:
    assert gen_model("--dof", 2, "--out", tmp_path / "a").returncode == 0
    folder = tmp_path / "a" / "ur5e_dof2"
    done = gen_model("--model", folder / "model.toml", "--out", tmp_path / "b")
    assert done.returncode == 0, done.stderr
    for name in FILES - {"model.md"}:
        assert (tmp_path / "b" / "ur5e_dof2" / name).read_bytes() == (folder / name).read_bytes()


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_folder_without_permission_stays_whole(tmp_path) -> None:
    assert gen_model("--dof", 1, "--out", tmp_path).returncode == 0
    folder = tmp_path / "ur5e_dof1"
    before = {p.name: p.read_bytes() for p in folder.iterdir()}
    folder.chmod(0o500)
    try:
        line = refused(gen_model("--dof", 1, "--gain", 30, "--out", tmp_path))
    finally:
        folder.chmod(0o700)
    assert "--out" in line
    assert {p.name: p.read_bytes() for p in folder.iterdir()} == before


def test_output_that_cannot_be_written_leaves_the_old_one_whole(tmp_path) -> None:
    assert gen_model("--dof", 1, "--out", tmp_path).returncode == 0
    folder = tmp_path / "ur5e_dof1"
    (folder / "model.md").unlink()
    (folder / "model.md").mkdir()
    before = {p.name: p.read_bytes() for p in folder.iterdir() if p.is_file()}
    line = refused(gen_model("--dof", 1, "--gain", 30, "--out", tmp_path))
    assert "--out" in line
    assert "nothing was changed" in line
    assert {p.name: p.read_bytes() for p in folder.iterdir() if p.is_file()} == before
    assert [p.name for p in tmp_path.iterdir()] == ["ur5e_dof1"]


def test_out_below_a_file_is_said(tmp_path) -> None:
    (tmp_path / "file").write_text("x")
    assert "--out" in refused(gen_model("--dof", 1, "--out", tmp_path / "file" / "deep"))
    assert (tmp_path / "file").read_text() == "x"


def test_other_files_in_the_folder_stay(tmp_path) -> None:
    assert gen_model("--dof", 1, "--out", tmp_path).returncode == 0
    (tmp_path / "ur5e_dof1" / "notes.txt").write_text("mine")
    assert gen_model("--dof", 1, "--out", tmp_path).returncode == 0
    assert (tmp_path / "ur5e_dof1" / "notes.txt").read_text() == "mine"


def test_every_built_in_robot_names_a_source_for_every_number() -> None:
    for name in ("ur3e", "ur5e", "ur10e", "ur16e"):
        robot, digest = load_robot(name)
        assert len(digest) == 64
        assert all(len(text) > 10 for text in robot.source.values())
        assert all(j.mass > 0 and 5 < j.drive_gain < 20 for j in robot.joint)


def test_runs_on_a_terminal_with_a_progress_bar(tmp_path) -> None:
    if shutil.which("script") is None:
        pytest.skip("no program `script` to make a terminal with")
    command = (
        f"{sys.executable} -c 'from residuum.cli.gen_model import main; main()' --dof 3 --out {tmp_path}"
    )
    done = subprocess.run(
        ["script", "-qec", command, "/dev/null"],
        capture_output=True,
        text=True,
        env=os.environ | {"TERM": "xterm", "COLUMNS": "100"},
    )
    assert done.returncode == 0
    for stage in ("deriving", "reducing", "checking against SymPy"):
        assert stage in done.stdout
