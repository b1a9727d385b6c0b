"""`residuum check`: output, exit codes, bad input."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from residuum.cli.check import check

GOOD = "def p():\n  while True:\n    sync()\n  end\nend\n"


def run(*arguments: object) -> Result:
    return CliRunner().invoke(check, [str(argument) for argument in arguments])


@pytest.fixture
def script(tmp_path: Path) -> Path:
    return tmp_path / "guard.script"


def test_nothing_to_say_is_exit_0(script: Path) -> None:
    script.write_text(GOOD)
    result = run(script)
    assert (result.exit_code, result.output) == (0, "")


def test_errors_are_exit_1_and_have_their_place(script: Path) -> None:
    script.write_text(GOOD.replace("sync()", "x = abs(1)"))
    result = run(script)
    assert result.exit_code == 1
    assert f"{script}:3:9: error: no function is called 'abs'" in result.output


def test_warnings_alone_are_exit_0(script: Path) -> None:
    script.write_text(GOOD.replace("\n", "\r\n"))
    result = run(script)
    assert result.exit_code == 0
    assert ": warning: " in result.output


def test_json(script: Path) -> None:
    script.write_text(GOOD.replace("sync()", "set_target_payload(1.0, [0, 0, 0])"))
    result = run(script, "--json", "--target-version", "5.4")
    found = json.loads(result.output)
    assert result.exit_code == 1
    assert {(item["line"], item["code"]) for item in found} >= {(3, "version")}


@pytest.mark.parametrize("content", [None, b"\xff\xfe\x00bad"])
def test_unreadable_files_are_exit_2(script: Path, content: bytes | None) -> None:
    if content is not None:
        script.write_bytes(content)
    result = run(script)
    assert result.exit_code == 2
    assert len(result.stderr.strip().splitlines()) == 1 and str(script) in result.stderr


def test_an_unknown_version_is_exit_2(script: Path) -> None:
    script.write_text(GOOD)
    result = run(script, "--target-version", "4.1")
    assert result.exit_code == 2
    assert "5.4" in result.stderr


def test_help_has_an_example() -> None:
    assert "Example:" in run("--help").output
