"""The one large URScript program in wide use: what ur_rtde uploads parses, checks clean and runs."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from virtual_robot import fixed_ports, taken

from residuum.urscript import Dialect, IdleWorld, Machine, check, parse_program

PORTS = (30004, 29999, 30003)
FAKE = Path(__file__).with_name("fake_controller.py")
CLIENT = "import os, rtde_control; rtde_control.RTDEControlInterface('127.0.0.1'); os._exit(0)"


@contextmanager
def _controller(version: str, file: Path) -> Iterator[None]:
    process = subprocess.Popen([sys.executable, str(FAKE), version, str(file)])
    try:
        for _ in range(100):
            if all(map(taken, PORTS)):
                break
            time.sleep(0.05)
        yield
    finally:
        process.kill()
        process.wait()


@pytest.fixture(scope="module", params=["5.11.0.0", "5.25.1.0"])
def control(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[str, str]:
    """Version and text of the control script for it."""
    if importlib.util.find_spec("rtde_control") is None:
        pytest.skip("ur_rtde is not installed")
    file = tmp_path_factory.mktemp("ur_rtde") / "control.script"
    with fixed_ports(), _controller(request.param, file):
        subprocess.run([sys.executable, "-c", CLIENT], timeout=20, check=False, capture_output=True)
    if not file.exists():
        pytest.fail("ur_rtde uploaded nothing to the fake controller")
    return request.param, file.read_text()


def test_it_is_the_whole_script(control: tuple[str, str]) -> None:
    _, text = control
    program = parse_program(text)
    assert program.name == "rtde_control"
    assert len(text.splitlines()) > 1000
    assert "\n0    global " in text, "an expression continues over a newline and a comment"


def test_it_checks_clean(control: tuple[str, str]) -> None:
    version, text = control
    assert [d for d in check(text, version) if d.severity != "note"] == []


def test_an_older_controller_is_told(control: tuple[str, str]) -> None:
    _, text = control
    assert "version" in {d.code for d in check(text, "5.4") if d.severity == "error"}


def test_it_moves_the_robot(control: tuple[str, str]) -> None:
    version, text = control
    world = IdleWorld()
    machine = Machine(text, world, Dialect(version=version))
    machine.run(5)
    assert world.outputs["integer", 0] == 1, "ready"
    for joint in range(6):
        world.inputs["float", joint] = 0.1 * joint
    world.inputs["float", 6], world.inputs["float", 7] = 1.05, 1.4
    world.inputs["integer", 0] = 1  # movej
    machine.run(5)
    assert world.motions == [("movej", (tuple(0.1 * joint for joint in range(6)), 1.4, 1.05, 0, 0))]
    assert world.outputs["integer", 0] == 2, "done"
    world.inputs["integer", 0] = 0
    machine.run(3)
    world.inputs["integer", 0] = 255  # stop script
    machine.run(5)
    assert machine.finished
    assert world.messages[-1] == "RTDE Control Script Terminated"
