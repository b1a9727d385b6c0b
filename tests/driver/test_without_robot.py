"""The commands when nobody answers."""

import pytest
from commands import residuum
from virtual_robot import fixed_ports


@pytest.mark.parametrize(
    "arguments",
    [
        ("record", "--host", "127.0.0.1", "--seconds", "1", "--out", "x.csv"),
        ("monitor", "--host", "127.0.0.1"),
    ],
)
def test_without_a_robot_it_is_one_line(arguments) -> None:
    with fixed_ports():
        done = residuum(*arguments, timeout=60)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert "no RTDE at port 30004" in done.stderr
