"""A reader of the RTDE stream: every package as the robot sent it, in order.

UR's RTDE guide, protocol version 2. Client libraries that keep the latest package and are asked for it by
the host's clock (ur_rtde's getters and its file recorder) repeat some packages and miss others; this one does
not sample, it reads.
"""

import socket
from collections.abc import Iterator, Sequence
from itertools import accumulate
from struct import Struct, error, pack, unpack_from
from types import TracebackType

import numpy as np
import numpy.typing as npt

from ..errors import InputError

Array = npt.NDArray[np.float64]

PORT = 30004
HEADER = Struct(">HB")
LAYOUTS = {
    "BOOL": "?",
    "UINT8": "B",
    "UINT32": "I",
    "UINT64": "Q",
    "INT32": "i",
    "DOUBLE": "d",
    "VECTOR3D": "3d",
    "VECTOR6D": "6d",
    "VECTOR6INT32": "6i",
    "VECTOR6UINT32": "6I",
}
"""Type in RTDE -> struct."""


class Rtde:
    """A connection that receives chosen fields.

    host: name or address. fields: names of outputs. rate: Hz, as the robot offers (at most 500). timeout: s
    without a byte after which the robot counts as lost.
    columns: field, or field_0 .. field_n-1 for a vector. version: of the controller.
    Raises InputError with one line: not reachable, not RTDE, a field that this controller does not have.
    """

    def __init__(
        self, host: str, fields: Sequence[str], rate: float = 500.0, port: int = PORT, timeout: float = 5.0
    ) -> None:
        self._where = f"--host {host}"
        self._buffer = b""
        try:
            self._socket = socket.create_connection((host, port), timeout)
        except OSError as reason:
            raise InputError(
                f"{self._where}: no RTDE at port {port}: {reason.strerror or reason}; is the robot on, and "
                "RTDE switched on under its security settings?"
            ) from None
        try:
            self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._agree(fields, rate)
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> "Rtde":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close the connection."""
        self._socket.close()

    def rows(self) -> Iterator[Array]:
        """Yield blocks (k, columns): all packages that have arrived, waiting for at least one.

        Raises InputError when the robot is lost.
        """
        while True:
            found = [self._unpack(p) for kind, p in self._cut() if kind == b"U"[0]]
            if found:
                yield np.array(found, dtype=float)
            self._receive()

    def _agree(self, fields: Sequence[str], rate: float) -> None:
        if self._ask(b"V", pack(">H", 2)) != b"\x01":
            raise InputError(f"{self._where}: does not speak RTDE version 2; PolyScope 5 is needed")
        self.version: tuple[int, ...] = unpack_from(">4I", self._ask(b"v", b""))
        answer = self._ask(b"O", pack(">d", rate) + ",".join(fields).encode("ascii"))
        types = answer[1:].decode("latin-1").split(",")
        missing = [name for name, kind in zip(fields, types, strict=False) if kind not in LAYOUTS]
        if missing or len(types) != len(fields):
            version = ".".join(map(str, self.version[:2]))
            raise InputError(
                f"{self._where}: PolyScope {version} has no field {', '.join(missing)}; leave it out"
            )
        formats = [LAYOUTS[kind] for kind in types]
        self._layout = Struct(">" + "".join(formats))
        widths = [int(text[:-1] or 1) for text in formats]
        self.columns = tuple(
            name if width == 1 else f"{name}_{i}"
            for name, width in zip(fields, widths, strict=True)
            for i in range(width)
        )
        starts = (0, *accumulate(widths))
        self._slices = {name: slice(a, b) for name, a, b in zip(fields, starts, starts[1:], strict=False)}
        if self._ask(b"S", b"") != b"\x01":
            raise InputError(f"{self._where}: refuses to start sending")

    def part(self, block: Array, field: str) -> Array:
        """Return the columns (k, width) of one field."""
        return block[:, self._slices[field]]

    def _ask(self, kind: bytes, payload: bytes) -> bytes:
        self._socket.sendall(HEADER.pack(3 + len(payload), kind[0]) + payload)
        while True:
            for number, answer in self._cut(one=True):
                if number == kind[0]:
                    return answer
                if number == b"M"[0]:
                    text = answer[1 : 1 + answer[0]].decode("latin-1") if answer else ""
                    raise InputError(f"{self._where}: the robot says: {text}")
            self._receive()

    def _cut(self, one: bool = False) -> Iterator[tuple[int, bytes]]:
        while len(self._buffer) >= HEADER.size:
            size, kind = HEADER.unpack_from(self._buffer)
            if size < HEADER.size:
                raise InputError(f"{self._where}: what comes from the port is not RTDE")
            if len(self._buffer) < size:
                return
            payload, self._buffer = self._buffer[HEADER.size : size], self._buffer[size:]
            yield kind, payload
            if one:
                return

    def _unpack(self, payload: bytes) -> tuple[float, ...]:
        try:
            return self._layout.unpack(payload[1:])
        except error:
            raise InputError(
                f"{self._where}: a package of {len(payload)} bytes does not fit the fields"
            ) from None

    def _receive(self) -> None:
        try:
            data = self._socket.recv(1 << 16)
        except TimeoutError:
            raise InputError(
                f"{self._where}: nothing came for {self._socket.gettimeout():.0f} s; the robot is lost"
            ) from None
        except OSError as reason:
            raise InputError(f"{self._where}: connection lost: {reason.strerror or reason}") from None
        if not data:
            raise InputError(f"{self._where}: the robot closed the connection")
        self._buffer += data
