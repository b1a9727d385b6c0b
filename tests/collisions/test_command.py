"""`residuum collide`: what it writes, and one line for bad input."""

import pytest
from commands import residuum


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        ((), "--out is missing"),
        (("--out", "x", "--detector", "nose"), "--detector nose: give one of thesis"),
        (("--out", "x", "--robot", "ur7"), "no such robot"),
        (("--out", "x", "--model", "guess"), "--model guess: give one of rigid, plain, refined"),
        (("--out", "x", "--repeats", "0"), "repeats"),
        (("--recordings", "nowhere.csv"), "nowhere.csv"),
    ],
)
def test_bad_input_is_one_line(arguments, reason) -> None:
    done = residuum("collide", *arguments, timeout=60)
    assert done.returncode == 2
    assert reason in done.stderr and done.stderr.count("\n") == 1


@pytest.mark.slow
def test_a_quick_campaign(tmp_path) -> None:
    done = residuum("collide", "--out", tmp_path / "out", "--quick", "--workers", 1, timeout=600)
    assert done.returncode == 0, done.stderr
    assert "18 runs: 18 detected after contact, 0 alarms before it" in done.stdout
    assert done.stdout.count("at most half") == 2
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert names == {"runs.csv", "tables.md", "report.html", "refined.toml"}
    assert len((tmp_path / "out" / "runs.csv").read_text().splitlines()) == 1 + 18 + 18
