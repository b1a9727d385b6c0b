"""The real client library, ur_rtde, against `residuum serve`: it shall not notice."""

import importlib.util
import json
import os
import subprocess
import sys
import textwrap

import pytest
from virtual_robot import fixed_ports, serving

pytestmark = pytest.mark.skipif(
    importlib.util.find_spec("rtde_control") is None, reason="ur_rtde is not installed"
)

HEAD = """
import json, os, sys, time
import dashboard_client, rtde_control, rtde_io, rtde_receive
host, out = "127.0.0.1", {}
def say():
    print(json.dumps(out)); sys.stdout.flush(); os._exit(0)
"""


def play(script: str, seconds: float = 60.0) -> dict:
    """Run a client in a process of its own (it holds Python's lock while it connects); return what it says."""
    text = HEAD + textwrap.dedent(script) + "\nsay()\n"
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, timeout=seconds)
    assert done.returncode == 0, done.stderr[-2000:]
    return json.loads(done.stdout.strip().splitlines()[-1])


@pytest.fixture(scope="module", params=["5.21", "5.25.1"])
def served(request):
    with fixed_ports(), serving("--polyscope", request.param) as process:
        yield request.param, process


def test_it_says_that_it_is_on_loopback(served) -> None:
    assert "127.0.0.1 (this computer only)" in served[1].greeting


def test_receive_and_dashboard(served) -> None:
    said = play(
        """
        r = rtde_receive.RTDEReceiveInterface(host)
        out["q"], out["mode"], out["runtime"] = r.getActualQ(), r.getRobotMode(), r.getRuntimeState()
        out["pose"], out["safety"] = r.getActualTCPPose(), r.getSafetyStatusBits()
        stamps = set()
        end = time.time() + 20  # how many the getter meets in a while is up to the load of the host
        while time.time() < end and len(stamps) < 50:
            stamps.add(round(r.getTimestamp(), 6)); time.sleep(0.0005)
        out["stamps"] = sorted(stamps)
        d = dashboard_client.DashboardClient(host); d.connect()
        out["version"], out["robotmode"], out["running"] = d.polyscopeVersion(), d.robotmode(), d.running()
        d.disconnect(); r.disconnect()
        """
    )
    assert said["q"] == pytest.approx([0, -1.5708, 1.5708, -1.5708, -1.5708, 0], abs=1e-3)
    assert (said["mode"], said["runtime"], said["safety"]) == (7, 1, 1)
    assert (said["robotmode"], said["running"]) == ("Robotmode: RUNNING", False)
    assert said["version"].startswith(served[0])
    assert len(said["stamps"]) == 50
    assert all(round(t / 0.002) == pytest.approx(t / 0.002, abs=1e-3) for t in said["stamps"])


def test_control_moves_the_arm(served) -> None:
    said = play(
        """
        c, r = rtde_control.RTDEControlInterface(host), rtde_receive.RTDEReceiveInterface(host)
        out["movej"] = c.moveJ([0.3, -1.4, 1.4, -1.5, -1.5, 0.2], 2.0, 4.0)
        time.sleep(0.1); out["q"] = r.getActualQ()
        up = r.getActualTCPPose(); out["before"] = list(up); up[2] += 0.05
        out["movel"] = c.moveL(up, 0.5, 2.0)
        time.sleep(0.1); out["after"] = r.getActualTCPPose()
        out["speedj"] = c.speedJ([0.3, 0, 0, 0, 0, 0], 4.0)
        time.sleep(0.4); out["qd"] = r.getActualQd(); out["stop"] = c.speedStop()
        q = r.getActualQ(); start = q[0]
        for k in range(150):
            t = c.initPeriod(); q[0] = start + 0.1 * k / 150
            out["servoj"] = c.servoJ(q, 0, 0, 0.002, 0.1, 300); c.waitPeriod(t)
        time.sleep(0.4); out["servostop"] = c.servoStop(); out["servoed"] = r.getActualQ()[0] - start
        out["freedrive"] = c.freedriveMode(); out["status"] = c.getFreedriveStatus()
        out["end"] = c.endFreedriveMode()
        c.moveJ([0.0, -1.5, 1.5, -1.5, -1.5, 0.0], 1.0, 1.0, True); time.sleep(0.15); c.stopJ(4.0)
        out["still"] = r.getActualQd()
        for _ in range(3): out["torques"] = c.getJointTorques(); time.sleep(0.02)
        out["near"] = r.getActualQ()
        out["back"] = c.getInverseKinematics(c.getForwardKinematics(), out["near"])
        out["running"] = c.isProgramRunning(); c.stopScript(); time.sleep(0.1); out["ended"] = c.isProgramRunning()
        """
    )
    assert [
        said[k] for k in ("movej", "movel", "speedj", "stop", "servoj", "servostop", "freedrive", "end")
    ] == [True] * 8
    assert said["q"] == pytest.approx([0.3, -1.4, 1.4, -1.5, -1.5, 0.2], abs=2e-3)
    assert said["after"][2] - said["before"][2] == pytest.approx(0.05, abs=2e-3)
    assert said["after"][:2] == pytest.approx(said["before"][:2], abs=2e-3)
    assert said["qd"][0] == pytest.approx(0.3, abs=0.03)
    assert said["servoed"] == pytest.approx(0.1, abs=0.01)
    assert said["status"] == 1
    assert max(map(abs, said["still"])) < 0.02
    assert 0.0 < max(map(abs, said["torques"])) < 30.0
    assert said["back"] == pytest.approx(said["near"], abs=1e-3)
    assert (said["running"], said["ended"]) == (True, False)


def test_inputs_and_outputs(served) -> None:
    said = play(
        """
        r, io = rtde_receive.RTDEReceiveInterface(host), rtde_io.RTDEIOInterface(host)
        out["ok"] = [io.setStandardDigitalOut(3, True), io.setSpeedSlider(0.5), io.setInputIntRegister(20, 7)]
        time.sleep(0.5); out["bits"], out["slider"] = r.getActualDigitalOutputBits(), r.getSpeedScaling()
        io.setStandardDigitalOut(3, False); io.setSpeedSlider(1.0)
        time.sleep(0.2); out["cleared"] = r.getActualDigitalOutputBits()
        io.disconnect(); r.disconnect()
        """
    )
    assert said["ok"] == [True, True, True]
    assert (said["bits"], said["cleared"], said["slider"]) == (8, 0, pytest.approx(0.5))


def test_after_its_client_vanished_the_next_one_takes_over(served) -> None:
    for _ in range(2):  # each ends without a word, its script still running
        said = play("c = rtde_control.RTDEControlInterface(host); out['ok'] = c.isProgramRunning()")
        assert said["ok"]


CYCLE = """
    r = rtde_receive.RTDEReceiveInterface(host); c = rtde_control.RTDEControlInterface(host)
    io = rtde_io.RTDEIOInterface(host); d = dashboard_client.DashboardClient(host); d.connect()
    target = [0.02 * (k % 2), -1.57, 1.57, -1.57, -1.57, 0.0]
    good += c.moveJ(target, 3.0, 10.0) and d.running() and r.isConnected() and io.setStandardDigitalOut(0, True)
    c.stopScript(); c.disconnect(); io.disconnect(); d.disconnect(); r.disconnect()
"""


@pytest.mark.slow
def test_connect_run_and_disconnect_many_times(served) -> None:
    """Some 1.4 s each; RESIDUUM_CYCLES=200 does it at length."""
    times = int(os.environ.get("RESIDUUM_CYCLES", "20"))
    said = play(f"good = 0\nfor k in range({times}):{CYCLE}\nout['good'] = good", 600.0)
    assert said["good"] == times
