"""The monitor in the browser, against the virtual robot: page, stream, slow clients, and a real Chromium."""

import http.client
import json
import signal
import socket
import subprocess
import threading
import time
from contextlib import contextmanager
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import browser as chromium
import commands
import numpy as np
import pytest
from virtual_robot import Robot, fixed_ports, serving

import residuum
from residuum.codegen.load import load_file
from residuum.driver import Browser, Monitor, Reading
from residuum.driver.browser import event
from residuum.errors import InputError
from residuum.virtual import Plant

OBSERVER = Path(residuum.__file__).parent / "generated" / "ur5e_dof6" / "observer.py"
KEYS = {
    *("time", "q", "external", "threshold", "temperature", "over", "detections"),
    *("latest", "packages", "lost"),
}
READING = Reading(
    time=1.0,
    q=np.zeros(6),
    external=np.ones(6),
    threshold=np.full(6, 5.0),
    temperature=np.full(6, 40.0),
    over=np.zeros(6, dtype=bool),
    detections=np.zeros(6, dtype=int),
    latest=None,
    packages=1,
    lost=0,
)
PUSH = {"start": 1.5, "end": 2.3, "force": (0.0, 0.0, -120.0), "link": 6, "profile": "hold"}


@pytest.fixture
def page():
    with Browser("127.0.0.1", 6, 0) as found:
        yield found


@contextmanager
def watching(robot, page):
    """Feed the page from the robot, in a thread."""
    ended = threading.Event()

    def feed() -> None:
        for reading in Monitor("127.0.0.1", load_file(OBSERVER), robot.ports.rtde).readings():
            page.show(reading)
            if ended.is_set():
                return

    thread = threading.Thread(target=feed, daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join(10)
        assert not thread.is_alive()


def get(page, path, **headers):
    connection = http.client.HTTPConnection("127.0.0.1", page.port, timeout=10)
    connection.request("GET", path, headers=headers)
    return connection.getresponse()


def states(answer, count):
    """Read so many events."""
    for _ in range(count):
        first, second = answer.readline(), answer.readline()
        assert first.startswith(b"data: ") and second == b"\n"
        yield json.loads(first[6:])


def test_page_stands_alone_and_may_load_nothing(page) -> None:
    answer = get(page, "/")
    text = answer.read().decode()
    policy = answer.getheader("Content-Security-Policy")
    assert answer.status == 200
    assert text.count("<canvas") == 6
    assert "//" not in text.replace("  // ", "")
    assert "default-src 'none'" in policy and "connect-src 'self'" in policy and "http" not in policy
    assert get(page, "/elsewhere").status == 404


def test_other_host_names_are_refused(page) -> None:
    assert get(page, "/", Host="localhost:9000").status == 200  # the other end of a tunnel
    assert get(page, "/stream", Host="elsewhere.example").status == 403


def test_stream_follows_the_robot(robot, page) -> None:
    with watching(robot, page):
        answer = get(page, "/stream")
        began = time.monotonic()
        seen = list(states(answer, 8))
        took = time.monotonic() - began
    assert answer.getheader("Content-Type") == "text/event-stream"
    assert all(set(s) == KEYS for s in seen)
    assert all(len(s[name]) == 6 for s in seen for name in ("external", "threshold", "temperature", "over"))
    assert all(b["time"] > a["time"] for a, b in pairwise(seen))
    assert took > 7 / 20  # at most 20 Hz
    assert seen[-1]["lost"] == 0 and sum(seen[-1]["detections"]) == 0
    assert seen[-1]["temperature"] == pytest.approx([43.0] * 6, abs=5.0)


def test_what_is_no_number_is_null() -> None:
    data = event(replace(READING, threshold=np.full(6, np.nan)))
    assert json.loads(data[6:])["threshold"] == [None] * 6


@pytest.fixture
def silent(page, monkeypatch):
    """A client that asked for the stream, which is as fast as the readings, and does not read."""
    monkeypatch.setattr("residuum.driver.browser.PERIOD", 0.0)
    with socket.socket() as client:
        client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2048)
        client.settimeout(10)
        client.connect(("127.0.0.1", page.port))
        client.sendall(b"GET /stream HTTP/1.0\r\nHost: 127.0.0.1\r\n\r\n")
        yield client


def test_a_client_that_never_reads_holds_nobody_up(page, silent) -> None:
    answer, longest = None, 0.0
    for k in range(300):  # 100 kB; a tenth of it fills what the silent one may leave lying
        began = time.monotonic()
        page.show(replace(READING, time=float(k)))
        longest = max(longest, time.monotonic() - began)
        answer = answer or get(page, "/stream")
        assert next(states(answer, 1))["time"] == k
    assert longest < 1.0


def test_a_slow_client_skips_what_it_did_not_take(page, silent) -> None:
    count = 1000
    answer = None
    for k in range(count):
        page.show(replace(READING, time=float(k)))
        answer = answer or get(page, "/stream")
        next(states(answer, 1))  # so that every one was there to be sent
    taken = b""
    while f'"time": {count - 1}.0'.encode() not in taken:
        taken += silent.recv(1 << 16)
    times = [
        json.loads(line[6:])["time"]
        for line in taken.split(b"\n")
        if line.startswith(b"data: ") and line.endswith(b"}")
    ]
    assert times == sorted(set(times))
    assert len(times) < count / 4


def test_a_port_in_use_is_one_line(page) -> None:
    with pytest.raises(InputError, match=rf"^--port {page.port}: .*; choose another$"):
        Browser("127.0.0.1", 6, page.port)


def test_close_frees_the_port_and_ends_the_streams() -> None:
    with Browser("127.0.0.1", 6, 0) as page:
        page.show(READING)
        answer = get(page, "/stream")
        next(states(answer, 1))
    assert answer.read() == b""
    Browser("127.0.0.1", 6, page.port).close()


def test_command_prints_the_address_and_ctrl_c_ends_it() -> None:
    command = [*commands.RESIDUUM, "monitor", "--host", "127.0.0.1", "--browser", "--port", "0"]
    with fixed_ports(), serving():
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        line = process.stdout.readline()
        assert line.startswith("http://127.0.0.1:") and "Ctrl-C" in line, process.stderr.read()
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
        rest, errors = process.communicate(timeout=20)
    assert (process.returncode, errors) == (0, "")
    assert "0 detection(s)" in rest


def test_a_port_without_the_browser_is_one_line() -> None:
    done = commands.residuum("monitor", "--host", "127.0.0.1", "--port", "8070", timeout=60)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert "--browser" in done.stderr


@pytest.mark.slow
@pytest.mark.skipif(chromium.CHROMIUM is None, reason="no Chromium here: apt-get install chromium")
def test_page_draws_in_chromium(page) -> None:
    robot = Robot(plant=Plant(external_contact=(PUSH,)))
    try:
        with chromium.chromium() as tab, watching(robot, page):
            tab.call(
                "Emulation.setDeviceMetricsOverride", width=360, height=740, deviceScaleFactor=1, mobile=True
            )
            tab.call("Page.navigate", url=page.address)
            tab.wait("document.readyState === 'complete' && states.length > 20")
            drawn = tab.run(
                "joints.map(j => j.canvas.getContext('2d').getImageData(0, 0, j.canvas.width, j.canvas.height)"
                ".data.some(x => x > 0))"
            )
            words = tab.run("document.body.innerText")
            width = tab.run("document.documentElement.scrollWidth")
            assert tab.errors == []
            blocked = tab.run(
                "new Promise(done => { addEventListener('securitypolicyviolation', e => done(e.violatedDirective));"
                " fetch('http://127.0.0.1:9/').then(() => done('let through'), () => 0); })"
            )
    finally:
        robot.close()
    assert drawn == [True] * 6
    assert width <= 360
    assert "°C" in words and "threshold" in words and "packages lost" in words
    assert blocked == "connect-src"
    assert all(r.startswith((page.address, "data:")) for r in tab.requests if ":9/" not in r)
