"""Recording, from the stream to the file."""

import socket
import struct
import threading

import numpy as np
import pytest
from click.testing import CliRunner

from residuum.cli.record import record as command
from residuum.driver import Rtde, record
from residuum.driver.record import gaps
from residuum.errors import InputError
from residuum.recordings import read


def test_two_seconds_lose_nothing(robot, tmp_path) -> None:
    found = record("127.0.0.1", 2.0, port=robot.ports.rtde)
    assert (len(found.table), found.lost, found.repeated) == (1000, 0, 0)
    assert np.diff(found.table[:, 0]) == pytest.approx(0.002, abs=1e-9)
    (tmp_path / "run.csv").write_text(found.csv())
    recording = read(tmp_path / "run.csv")
    assert len(recording) == 1000
    assert recording.q == pytest.approx(found.table[:, 1:7])
    assert recording.joint_temperatures is not None
    assert found.columns[-1] == "actual_TCP_force_5"


def test_the_rate_is_the_robots(robot) -> None:
    found = record("127.0.0.1", 0.4, 125.0, port=robot.ports.rtde)
    assert np.diff(found.table[:, 0]) == pytest.approx(0.008, abs=1e-9)
    assert found.lost == 0


def test_what_is_missing_or_twice_is_counted() -> None:
    stamps = np.array([0.0, 0.002, 0.008, 0.008, 0.010])
    assert gaps(stamps, 500.0) == (2, 1)
    with pytest.raises(InputError, match="backwards"):
        gaps(np.array([1.0, 0.0]), 500.0)


def test_a_field_that_is_not_there_is_named(robot) -> None:
    with pytest.raises(InputError, match=r"PolyScope 5\.21 has no field actual_current_as_torque"):
        Rtde("127.0.0.1", ("timestamp", "actual_current_as_torque"), port=robot.ports.rtde)


def test_nobody_there() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
    with pytest.raises(InputError, match=rf"--host 127.0.0.1: no RTDE at port {port}"):
        Rtde("127.0.0.1", ("timestamp",), port=port)


def test_a_stranger_at_the_port_is_no_robot(robot) -> None:
    with pytest.raises(InputError, match=r"not RTDE|robot is lost|does not speak"):
        Rtde("127.0.0.1", ("timestamp",), port=robot.ports.dashboard, timeout=0.5)


def test_a_robot_lost_on_the_way_leaves_no_file(tmp_path, monkeypatch) -> None:
    """A server that answers the handshake, sends one package and hangs up."""

    def serve(server: socket.socket) -> None:
        connection, _ = server.accept()
        with connection:
            for reply in (b"\0\4V\1", struct.pack(">HB4I", 19, ord("v"), 5, 21, 0, 0)):
                connection.recv(100)
                connection.sendall(reply)
            connection.recv(1000)
            types = b"\1" + b",".join([b"DOUBLE", *[b"VECTOR6D"] * 10])
            connection.sendall(struct.pack(">HB", 3 + len(types), ord("O")) + types)
            connection.recv(100)
            connection.sendall(b"\0\4S\1")
            connection.sendall(struct.pack(">HBB", 4 + 8 * 61, ord("U"), 1) + bytes(8 * 61))

    with socket.create_server(("127.0.0.1", 0)) as server:
        thread = threading.Thread(target=serve, args=(server,))
        thread.start()
        monkeypatch.setattr(
            record,
            "__defaults__",
            (*record.__defaults__[:2], server.getsockname()[1], *record.__defaults__[3:]),
        )
        out = tmp_path / "run.csv"
        done = CliRunner().invoke(command, ["--host", "127.0.0.1", "--seconds", "1", "--out", str(out)])
        thread.join()
    assert isinstance(done.exception, InputError)
    assert "closed the connection" in str(done.exception)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_is_not_there_is_said_before_recording(tmp_path) -> None:
    out = tmp_path / "no" / "run.csv"
    done = CliRunner().invoke(command, ["--host", "127.0.0.1", "--seconds", "1", "--out", str(out)])
    assert "there is no folder" in str(done.exception)
