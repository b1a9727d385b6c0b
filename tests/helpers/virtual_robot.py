"""A virtual robot on free ports, in a thread of its own; and the real ports, one test at a time."""

import asyncio
import contextlib
import fcntl
import socket
import subprocess
import tempfile
import threading
import time
from pathlib import Path

import pytest
from commands import RESIDUUM

from residuum.robots import load_robot
from residuum.virtual.server import Controller, Ports, Server

FREE = Ports(0, 0, 0, 0, 0)
FIXED = (30004, 29999, 30001, 30002, 30003)


class Robot:
    """A server in a thread. ports: where; said: what it told its operator."""

    def __init__(self, speed=1.0, **options) -> None:
        self.said: list[str] = []
        self.controller = Controller(load_robot("ur5e")[0], say=self.said.append, **options)
        self._speed, self._ready = speed, threading.Event()
        self._thread = threading.Thread(target=lambda: asyncio.run(self._main()), daemon=True)
        self._thread.start()
        assert self._ready.wait(10)

    async def _main(self) -> None:
        self._loop = asyncio.get_running_loop()
        self.server = Server(self.controller, ports=FREE, speed=self._speed)
        self.ports = await self.server.open()
        self._task = asyncio.ensure_future(self.server.run())
        self._ready.set()
        with contextlib.suppress(asyncio.CancelledError):
            await self._task
        self.server.close()
        await asyncio.sleep(0.05)

    def close(self) -> None:
        self._loop.call_soon_threadsafe(self._task.cancel)
        self._thread.join(10)
        assert not self._thread.is_alive()

    def connect(self, port: str) -> socket.socket:
        return socket.create_connection(("127.0.0.1", getattr(self.ports, port)), 5)

    def until(self, condition, seconds=5.0) -> None:
        end = time.monotonic() + seconds
        while not condition():
            assert time.monotonic() < end, f"not so within {seconds} s; it said {self.said}"
            time.sleep(0.01)

    def heard(self, words: str, seconds=5.0) -> None:
        self.until(lambda: any(words in line for line in self.said), seconds)


@pytest.fixture
def robot():
    """A robot of its own for every test."""
    running = Robot()
    yield running
    running.close()


@pytest.fixture
def controller():
    """The controller alone, without ports."""
    return Controller(load_robot("ur5e")[0])


def taken(port: int) -> bool:
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(("127.0.0.1", port))
        except OSError:
            return True
    return False


def _acquire(lock, seconds: float) -> None:
    end = time.monotonic() + seconds
    while True:
        try:
            return fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            if time.monotonic() > end:
                pytest.skip(f"other tests held the fixed ports for {seconds:.0f} s")
            time.sleep(0.05)


@contextlib.contextmanager
def fixed_ports():
    """The ports that ur_rtde insists on, for one test at a time on this computer."""
    with (Path(tempfile.gettempdir()) / "residuum_controller_ports.lock").open("w") as lock:
        _acquire(lock, 120.0)
        if busy := [port for port in FIXED if taken(port)]:
            pytest.skip(f"ports {busy} are taken; ur_rtde uses no others")
        yield


@contextlib.contextmanager
def serving(*arguments: str):
    """`residuum serve` as a process; yields it once it listens."""
    process = subprocess.Popen(
        [*RESIDUUM, "serve", *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    try:
        process.greeting = process.stdout.readline()
        assert "RTDE 30004" in process.greeting, process.stderr.read()
        yield process
    finally:
        process.terminate()
        process.communicate(timeout=10)
