"""Garbage on all ports at once, for RESIDUUM_FUZZ_SECONDS (20): the server goes on and the robot holds.

A steady stream, a piece every 5 ms on each port; how much of a flood the clock stands is another question.
"""

import os
import random
import struct
import threading
import time

import numpy as np
import pytest
from virtual_robot import Robot

from residuum.driver import Rtde

PAUSE = 0.005
PORTS = ("rtde", "dashboard", "primary", "secondary", "realtime")
WORDS = (b"def f():\n", b"end\n", b"while True:\n", b"movej(", b"p[1,2", b"]", b"\n", b"robotmode\n", b"play\n",
         b"sec s():\n", b"thread t():\n", b"\xff\xfe", b"\0", b"1e999", b"sync()\n")  # fmt: skip


def packages(noise: random.Random) -> bytes:
    """Something that looks like RTDE: a header whose length is right, wrong or absurd, and any body."""
    body = noise.randbytes(noise.randrange(0, 60))
    size = noise.choice((len(body) + 3, len(body), 0, 1, 2, 65535, noise.randrange(65536)))
    return struct.pack(">HB", size, noise.choice(b"VvMOISPUuX\0\xff")) + body


def words(noise: random.Random) -> bytes:
    return b"".join(noise.choice(WORDS) for _ in range(noise.randrange(1, 30)))


def bytes_(noise: random.Random) -> bytes:
    return noise.randbytes(noise.randrange(1, 400))


def attack(robot, port: str, seed: int, end: float, sent: list[int]) -> None:
    noise = random.Random(seed)
    kinds = (packages, bytes_) if port == "rtde" else (words, bytes_)
    while time.monotonic() < end:
        try:
            with robot.connect(port) as connection:
                for _ in range(noise.randrange(1, 40)):
                    text = noise.choice(kinds)(noise)
                    connection.sendall(text)
                    sent[0] += len(text)
                    time.sleep(PAUSE)
        except OSError:
            pass  # dropped, as it should be


@pytest.mark.slow
def test_the_server_survives_garbage_on_all_ports_at_once() -> None:
    seconds = float(os.environ.get("RESIDUUM_FUZZ_SECONDS", "20"))
    robot = Robot()
    try:
        before, ticks = robot.controller.arm.state.rtde["actual_q"], robot.controller.arm.ticks
        end, sent = time.monotonic() + seconds, [0]
        threads = [
            threading.Thread(target=attack, args=(robot, p, k, end, sent)) for k, p in enumerate(PORTS)
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(seconds + 60)
            assert not thread.is_alive()
        robot.until(lambda: not robot.server.clients, 20.0)
        assert robot.controller.arm.ticks > ticks + 100 * seconds, "time stood still"
        with Rtde("127.0.0.1", ("timestamp", "actual_q"), 500.0, robot.ports.rtde) as rtde:
            blocks = [block for block, _ in zip(rtde.rows(), range(20), strict=False)]
        assert np.diff(np.concatenate(blocks)[:, 0]) == pytest.approx(0.002, abs=1e-9)
        assert robot.controller.arm.state.rtde["actual_q"] == pytest.approx(before, abs=1e-3)
        assert sent[0] > 1e4
        print(f"{sent[0]} bytes in {seconds:g} s, {robot.controller.arm.ticks - ticks} cycles")
    finally:
        robot.close()
