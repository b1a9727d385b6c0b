"""RTDE packages, protocol version 2: cutting them out of a stream, and building them.

UR's RTDE guide: big endian `uint16 size` (header included), `uint8 type`, payload.
"""

from collections.abc import Iterator
from struct import Struct

HEADER = Struct(">HB")
LARGEST = 0xFFFF

VERSION, CONTROLLER, TEXT, OUTPUTS, INPUTS, START, PAUSE, DATA = b"VvMOISPU"
"""Types of packages, as numbers."""

ERROR, WARNING = 1, 2
"""Levels of a text message."""


class BrokenStream(Exception):  # noqa: N818 - it is what it says
    """Bytes that cannot be packages; nothing behind them can be understood."""


def cut(buffer: bytearray) -> Iterator[tuple[int, bytes]]:
    """Take complete packages (type, payload) off the front of a buffer; a half one stays.

    Raises BrokenStream when a size is below that of its own header.
    """
    while len(buffer) >= HEADER.size:
        size, kind = HEADER.unpack_from(buffer)
        if size < HEADER.size:
            raise BrokenStream(f"a package of {size} bytes is shorter than its header")
        if len(buffer) < size:
            return
        payload = bytes(buffer[HEADER.size : size])
        del buffer[:size]
        yield kind, payload


def package(kind: int, payload: bytes) -> bytes:
    """Return one package."""
    return HEADER.pack(HEADER.size + len(payload), kind) + payload


def message(text: str, level: int) -> bytes:
    """Return a text message for the client's log."""
    said, source = text.encode("latin-1", "replace")[:255], b"RTDE"
    return package(TEXT, bytes([len(said)]) + said + bytes([len(source)]) + source + bytes([level]))
