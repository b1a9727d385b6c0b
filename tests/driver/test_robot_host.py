"""What may be run against a real robot or URSim: it only reads. `pytest tests/driver --robot-host ADDRESS`.

Without an address the virtual controller stands in.
"""

import importlib.util
import socket
import subprocess
import sys
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
from virtual_robot import Robot

import residuum
from residuum.codegen.load import load_file
from residuum.driver import Monitor, record


@dataclass
class Where:
    host: str
    rtde: int = 30004
    dashboard: int = 29999


@pytest.fixture(scope="module")
def where(request):
    host = request.config.getoption("--robot-host")
    if host:
        yield Where(host)
        return
    robot = Robot()
    yield Where("127.0.0.1", robot.ports.rtde, robot.ports.dashboard)
    robot.close()


@pytest.mark.parametrize("rate", [125.0, 500.0])
def test_a_recording_loses_nothing(where, rate) -> None:
    found = record(where.host, 2.0, rate, port=where.rtde)
    assert (len(found.table), found.lost, found.repeated) == (round(2.0 * rate), 0, 0)
    assert np.diff(found.table[:, 0]) == pytest.approx(1.0 / rate, abs=1e-6)


def test_what_is_recorded_is_plausible(where) -> None:
    found = record(where.host, 0.5, port=where.rtde)
    table = dict(zip(found.columns, found.table.T, strict=True))
    for k in range(6):
        assert np.abs(table[f"actual_q_{k}"]).max() < 6.4
        assert np.abs(table[f"actual_qd_{k}"]).max() < 3.5
        assert np.abs(table[f"actual_current_{k}"]).max() < 40.0
        assert 0.0 < table[f"joint_temperatures_{k}"].min() < 100.0


def test_the_monitor_follows(where) -> None:
    observer = load_file(Path(residuum.__file__).parent / "generated" / "ur5e_dof6" / "observer.py")
    last = list(islice(Monitor(where.host, observer, where.rtde).readings(), 60))[-1]
    assert last.lost == 0 and last.packages >= 60
    assert np.isfinite(last.external).all()


def test_the_dashboard_tells_its_state(where) -> None:
    with socket.create_connection((where.host, where.dashboard), 5) as connection:
        answers = connection.makefile("r")
        assert "Universal Robots Dashboard Server" in answers.readline()
        for question, answer in (
            ("robotmode", "Robotmode:"),
            ("safetystatus", "Safetystatus:"),
            ("running", "Program running:"),
        ):
            connection.sendall(question.encode() + b"\n")
            assert answers.readline().startswith(answer)


@pytest.mark.skipif(importlib.util.find_spec("rtde_receive") is None, reason="ur_rtde is not installed")
def test_ur_rtde_reads_too(request) -> None:
    host = request.config.getoption("--robot-host")
    if not host:
        pytest.skip("tests/server/test_ur_rtde.py does it with the virtual controller")
    text = f"import rtde_receive as r; x = r.RTDEReceiveInterface({host!r}); print(len(x.getActualQ()))"
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, timeout=30)
    assert done.stdout.strip() == "6", done.stderr
