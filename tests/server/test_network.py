"""The ports: many clients, bad clients, and time that goes on."""

import random
import socket
import struct
import time

import numpy as np
import pytest
from virtual_robot import FREE, Robot

from residuum.driver import Rtde
from residuum.driver.primary import messages
from residuum.errors import InputError
from residuum.virtual.server import Ports, Server

LOOP = b"def loop():\n  while True:\n    sync()\n  end\nend\n"


def client(robot, fields=("timestamp", "actual_q"), rate=500.0) -> Rtde:
    return Rtde("127.0.0.1", fields, rate, robot.ports.rtde)


def read(rtde: Rtde, count: int) -> np.ndarray:
    blocks, have = [], 0
    for block in rtde.rows():
        blocks.append(block)
        have += len(block)
        if have >= count:
            return np.concatenate(blocks)[:count]
    raise AssertionError


def hear(connection, seconds=3.0):
    """Yield what the primary interface says."""
    buffer = bytearray()
    connection.settimeout(seconds)
    while data := connection.recv(65536):
        buffer += data
        yield from messages(buffer)


@pytest.mark.parametrize("rate", [500.0, 125.0])
def test_timestamps_step_by_the_period(robot, rate) -> None:
    with client(robot, rate=rate) as rtde:
        time_ = read(rtde, round(rate))[:, 0]
    assert np.diff(time_) == pytest.approx(1.0 / rate, abs=1e-9)


def test_time_is_real_time(robot) -> None:
    with client(robot) as rtde:
        first, begun = read(rtde, 1)[0, 0], time.monotonic()
        last = read(rtde, 750)[-1, 0]
        took = time.monotonic() - begun
    assert last - first == pytest.approx(took, abs=0.1)


def test_faster_than_real_time_too() -> None:
    robot = Robot(speed=None)
    try:
        with client(robot) as rtde:
            begun = time.monotonic()
            stamps = read(rtde, 2500)[:, 0]
            took = time.monotonic() - begun
    finally:
        robot.close()
    assert np.diff(stamps) == pytest.approx(0.002, abs=1e-9)
    assert stamps[-1] - stamps[0] > 1.5 * took


def test_clients_at_different_rates_see_the_same_robot(robot) -> None:
    with client(robot) as fast, client(robot, rate=125.0) as slow:
        a, b = read(fast, 500), read(slow, 120)
    shared = {round(t, 6): q for t, *q in a.tolist()}
    both = [(shared[round(t, 6)], q) for t, *q in b.tolist() if round(t, 6) in shared]
    assert len(both) > 50
    assert all(one == other for one, other in both)


def test_fifty_clients_lose_nothing(robot) -> None:
    clients = [client(robot) for _ in range(50)]
    try:
        for rtde in clients:
            assert np.diff(read(rtde, 100)[:, 0]) == pytest.approx(0.002, abs=1e-9)
        assert len(robot.server.clients) == 50
    finally:
        for rtde in clients:
            rtde.close()
    robot.until(lambda: not robot.server.clients)


def test_a_client_that_never_reads_holds_nobody() -> None:
    robot = Robot(speed=None)  # a minute of its clock passes in seconds
    try:
        sleeper = robot.connect("rtde")
        sleeper.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        names = b"timestamp," + b",".join(b"output_double_register_%d" % i for i in range(48))
        request = struct.pack(">d", 500.0) + names
        sleeper.sendall(struct.pack(">HB", 3 + len(request), ord("O")) + request + b"\0\3S")
        with client(robot) as other:
            for _ in range(5):
                assert np.diff(read(other, 500)[:, 0]) == pytest.approx(0.002, abs=1e-9)
        robot.heard("does not read", 40.0)
        sleeper.close()
    finally:
        robot.close()


def test_half_a_package_and_a_vanished_client_hold_nobody(robot) -> None:
    half = robot.connect("rtde")
    half.sendall(b"\0\x20O\x40")
    gone = client(robot)
    gone._socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    read(gone, 10)
    gone.close()  # a reset, as from a client that was killed
    with client(robot) as rtde:
        assert np.diff(read(rtde, 200)[:, 0]) == pytest.approx(0.002, abs=1e-9)
    half.close()
    robot.until(lambda: not robot.server.clients)


def test_a_vanished_client_leaves_its_inputs(robot) -> None:
    request = b"input_int_register_3"
    for _ in range(3):
        connection = robot.connect("rtde")
        connection.sendall(struct.pack(">HB", 3 + len(request), ord("I")) + request)
        assert connection.recv(100).endswith(b"\1INT32")
        connection.close()
        robot.until(lambda: not robot.server.clients)


@pytest.mark.parametrize("port", ["rtde", "dashboard", "primary", "secondary", "realtime"])
def test_garbage_for_a_second_on_every_port(robot, port) -> None:
    noise = random.Random(port)
    ticks, end = robot.controller.arm.ticks, time.monotonic() + 1.0
    held = robot.controller.arm.state.rtde["actual_q"]
    while time.monotonic() < end:
        with robot.connect(port) as connection:
            try:
                for _ in range(20):
                    connection.sendall(noise.randbytes(noise.randrange(1, 400)))
            except OSError:
                pass  # dropped, as it should be
    with client(robot) as rtde:
        assert np.diff(read(rtde, 50)[:, 0]) == pytest.approx(0.002, abs=1e-9)
    robot.until(lambda: robot.controller.arm.ticks > ticks + 200)
    assert robot.controller.arm.state.rtde["actual_q"] == pytest.approx(held, abs=1e-3)


def test_a_flood_of_dashboard_lines_is_cut_off_and_the_robot_goes_on(robot) -> None:
    ticks = robot.controller.arm.ticks
    with robot.connect("dashboard") as connection, pytest.raises(OSError):
        for _ in range(1000):
            connection.sendall(b"robotmode\n" * 10_000)
    robot.heard("lines at once")
    robot.until(lambda: robot.controller.arm.ticks > ticks + 200)
    with robot.connect("dashboard") as connection:
        connection.sendall(b"robotmode\n")
        assert b"Connected" in connection.recv(200)


def test_wrong_inputs_are_told_to_the_operator(robot) -> None:
    with robot.connect("rtde") as connection:
        connection.sendall(b"\0\4U\7")
        assert b"no input recipe 7" in connection.recv(100)
        robot.heard("there is no input recipe 7")


def test_an_impossible_package_is_answered_with_the_reason(robot) -> None:
    with robot.connect("rtde") as connection:
        connection.sendall(b"\0\1V")
        answer = connection.recv(1000)
        assert answer[2:3] == b"M" and b"shorter than its header" in answer
        assert connection.recv(10) == b""


def test_the_primary_interface_tells_version_start_and_stop(robot) -> None:
    with robot.connect("primary") as connection:
        said = hear(connection)
        assert next(said).kind == "version"
        connection.sendall(LOOP)
        assert (m := next(said)).kind == "started" and m.program == "loop"
        with robot.connect("realtime") as other:
            other.sendall(b"def bad():\n  x = 1\n  y = 1 / 0\nend\n")
            heard = [next(said) for _ in range(4)]
    assert [(m.kind, m.program, m.line) for m in heard] == [
        ("stopped", "loop", 0), ("started", "bad", 0), ("failure", "", 3), ("stopped", "bad", 0),
    ]  # fmt: skip


def test_robot_states_come_ten_times_a_second(robot) -> None:
    with robot.connect("secondary") as connection:
        connection.settimeout(2)
        data, end = b"", time.monotonic() + 1.05
        while time.monotonic() < end:
            data += connection.recv(65536)
    sizes, kinds = [], []
    while len(data) >= 5:
        size, kind = struct.unpack_from(">iB", data)
        sizes.append(size)
        kinds.append(kind)
        if kind == 16:
            assert struct.unpack_from(">IB", data, 5)[1] == 0, "robot mode comes first"
            assert data[5 + 5 + 8 : 5 + 5 + 11] == b"\1\1\1", "connected, enabled, powered"
        data = data[size:]
    assert kinds[0] == 20
    assert 9 <= kinds.count(16) <= 13


def test_a_program_cut_off_is_not_run_and_is_said(robot) -> None:
    with robot.connect("realtime") as connection:
        connection.sendall(b"def half():\n  while True:\n    sync()\n")
    robot.heard("cut off")
    assert robot.controller.programs.state == "stopped"


def test_two_programs_at_once_the_last_one_runs(robot) -> None:
    with robot.connect("primary") as one, robot.connect("secondary") as two:
        one.sendall(LOOP)
        two.sendall(LOOP.replace(b"loop", b"other"))
        robot.until(lambda: sum("started" in line for line in robot.said) == 2)
    assert robot.controller.programs.name in ("loop", "other")
    assert sum("stopped" in line for line in robot.said) == 1


def test_a_lone_line_is_a_program_and_commands_are_obeyed(robot) -> None:
    with robot.connect("realtime") as connection:
        connection.sendall(b"set_standard_digital_out(1, True)\n")
        robot.until(lambda: robot.controller.world.digital.get(("standard", 1)))
        connection.sendall(b"power off\n")
        robot.until(lambda: robot.controller.arm.mode == 3)


def test_the_dashboard_takes_lines_in_pieces(robot) -> None:
    with robot.connect("dashboard") as connection:
        answers = connection.makefile("r")
        assert answers.readline() == "Connected: Universal Robots Dashboard Server\n"
        connection.sendall(b"robot")
        time.sleep(0.02)
        connection.sendall(b"mode\nquit\n")
        assert answers.readline() == "Robotmode: RUNNING\n"
        assert answers.readline() == "Disconnected\n"
        assert answers.readline() == ""


def test_a_taken_port_is_said_in_one_line(robot, controller) -> None:
    import asyncio

    async def attempt() -> None:
        await Server(controller, ports=Ports(robot.ports.rtde, 0, 0, 0, 0)).open()

    with pytest.raises(InputError, match=rf"port {robot.ports.rtde} \(rtde\) cannot be opened") as error:
        asyncio.run(attempt())
    assert "\n" not in str(error.value)
    assert FREE.rtde == 0
