"""The commands when nobody answers."""

import subprocess
import sys

import pytest
from virtual_robot import fixed_ports

CALL = "from residuum.cli.run import run; from residuum.cli.{0} import {0}; run({0}, 'residuum {0}')"


@pytest.mark.parametrize(
    "arguments",
    [
        ("record", "--host", "127.0.0.1", "--seconds", "1", "--out", "x.csv"),
        ("monitor", "--host", "127.0.0.1"),
    ],
)
def test_without_a_robot_it_is_one_line(arguments) -> None:
    with fixed_ports():
        command = [sys.executable, "-c", CALL.format(arguments[0]), *arguments[1:]]
        done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert "no RTDE at port 30004" in done.stderr
