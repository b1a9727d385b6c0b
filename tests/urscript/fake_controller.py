"""As much of a controller as ur_rtde needs to upload its script; run alone: fake_controller.py VERSION FILE.

It answers RTDE (30004) and the dashboard (29999) and writes what arrives at the script port (30003) to FILE.
It runs in a process of its own because ur_rtde holds Python's lock while it connects.
"""

from __future__ import annotations

import socket
import struct
import sys
import threading
import time
from pathlib import Path

PORTS = {"rtde": 30004, "dashboard": 29999, "script": 30003}
SINGLE = {"timestamp": "DOUBLE", "robot_mode": "INT32", "safety_mode": "INT32", "speed_slider_mask": "UINT32"}
FORMATS = {"DOUBLE": "d", "VECTOR6D": "6d", "INT32": "i", "UINT32": "I", "UINT8": "B"}


def field_type(name: str) -> str:
    """Type of an RTDE field, as far as ur_rtde asks for it when it starts."""
    if name in SINGLE:
        return SINGLE[name]
    if "double_register" in name or name == "speed_slider_fraction" or "standard_analog" in name:
        return "UINT8" if name.endswith(("mask", "type")) else "DOUBLE"
    if "int_register" in name:
        return "INT32"
    if "status_bits" in name or name == "runtime_state":
        return "UINT32"
    return "UINT8" if "mask" in name or "digital_output" in name else "VECTOR6D"


class Controller:
    """State shared by the connections."""

    def __init__(self, version: tuple[int, ...], file: Path) -> None:
        self.version = version
        self.file = file
        self.playing = False

    def value(self, name: str) -> list[float]:
        if name == "runtime_state":
            return [2 if self.playing else 1]
        fixed = {
            "timestamp": time.monotonic(),
            "robot_status_bits": 3,
            "safety_status_bits": 1,
            "robot_mode": 7,
        }
        count = 6 if field_type(name) == "VECTOR6D" else 1
        return [fixed.get(name, 1 if name == "output_int_register_0" else 0)] * count

    def rtde(self, connection: socket.socket) -> None:
        names: list[str] = []
        inputs = 0
        while (head := connection.recv(3, socket.MSG_WAITALL)) and len(head) == 3:
            size, kind = struct.unpack(">HB", head)
            body = connection.recv(size - 3, socket.MSG_WAITALL) if size > 3 else b""
            if kind == ord("V"):
                self.reply(connection, kind, b"\x01")
            elif kind == ord("v"):
                self.reply(connection, kind, struct.pack(">4I", *self.version))
            elif kind == ord("O"):
                names = [name for name in body[8:].decode().split(",") if name]
                self.reply(connection, kind, b"\x01" + ",".join(map(field_type, names)).encode())
            elif kind == ord("I"):
                inputs += 1
                fields = [name for name in body.decode().split(",") if name]
                self.reply(connection, kind, bytes([inputs]) + ",".join(map(field_type, fields)).encode())
            elif kind == ord("S"):
                self.reply(connection, kind, b"\x01")
                threading.Thread(target=self.stream, args=(connection, names), daemon=True).start()

    def stream(self, connection: socket.socket, names: list[str]) -> None:
        while True:
            values = (struct.pack(">" + FORMATS[field_type(name)], *self.value(name)) for name in names)
            try:
                self.reply(connection, ord("U"), b"\x01" + b"".join(values))
            except OSError:
                return
            time.sleep(0.01)

    @staticmethod
    def reply(connection: socket.socket, kind: int, body: bytes) -> None:
        connection.sendall(struct.pack(">HB", 3 + len(body), kind) + body)

    def dashboard(self, connection: socket.socket) -> None:
        connection.sendall(b"Connected: Universal Robots Dashboard Server\n")
        answers = {
            "PolyscopeVersion": "URSoftware {}.{}.{}.0 (Jan 01 2025)".format(*self.version),
            "get serial number": "20195500000",
            "is in remote control": "true",
            "stop": "Stopped",
        }
        for line in connection.makefile("r"):
            connection.sendall((answers.get(line.strip(), "not understood") + "\n").encode())

    def script(self, connection: socket.socket) -> None:
        received = b""
        while data := connection.recv(65536):
            received += data
            self.file.write_bytes(received)
            self.playing = True


def serve(port: int, handle: object) -> None:
    """Accept connections for ever."""
    with socket.create_server(("127.0.0.1", port)) as server:
        while True:
            connection, _ = server.accept()
            threading.Thread(target=handle, args=(connection,), daemon=True).start()  # type: ignore[arg-type]


if __name__ == "__main__":
    controller = Controller(tuple(int(part) for part in sys.argv[1].split(".")), Path(sys.argv[2]))
    for name, port in PORTS.items():
        threading.Thread(target=serve, args=(port, getattr(controller, name)), daemon=True).start()
    time.sleep(60)
