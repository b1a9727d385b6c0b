"""`residuum serve` as a process: how it ends, and what it says."""

import signal
import socket

import pytest
from commands import residuum
from virtual_robot import fixed_ports, serving


def test_ctrl_c_ends_it_cleanly() -> None:
    with fixed_ports(), serving() as process, socket.create_connection(("127.0.0.1", 30004)):
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=10)
    assert (process.returncode, err) == (0, "")
    assert "stopped after" in out


def test_a_taken_port_is_one_line_and_two() -> None:
    with fixed_ports(), serving(), pytest.raises(AssertionError, match="port 30004"), serving():
        pass


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (("--speed", "0"), "'0' is neither a number above 0 nor max"),
        (("--polyscope", "3.15"), "'3.15' is not one of"),
        (("--robot", "ur7"), "no such robot"),
        (("--plant", "nowhere.toml"), "nowhere.toml"),
    ],
)
def test_bad_options_are_one_line(arguments, reason) -> None:
    done = residuum("serve", *arguments, timeout=30)
    assert (done.returncode, done.stdout) == (2, "")
    assert reason in done.stderr and done.stderr.count("\n") == 1
