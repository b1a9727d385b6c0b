"""Reading the primary interface: what the controller says of programs and errors.

Layouts as in UR's client library (include/ur_client_library/primary).
"""

from collections.abc import Iterator
from dataclasses import dataclass
from struct import error, unpack_from

ROBOT_MESSAGE = 20
_LARGEST = 1_000_000


@dataclass(frozen=True)
class Said:
    """One message: kind is version, started, stopped, failure, error or text.

    program: of started and stopped. line, column: of a failure, from 1. text: what it says. level: of an
    error, 3 is a fault.
    """

    kind: str
    text: str = ""
    program: str = ""
    line: int = 0
    column: int = 0
    level: int = 0


class NotPrimary(Exception):  # noqa: N818 - it is what it says
    """Bytes that are no primary interface."""


def messages(buffer: bytearray) -> Iterator[Said]:
    """Take complete packages off a buffer; yield the messages that matter here.

    Raises NotPrimary.
    """
    while len(buffer) >= 5:
        size, kind = unpack_from(">iB", buffer)
        if not 5 <= size <= _LARGEST:
            raise NotPrimary(f"a package of {size} bytes")
        if len(buffer) < size:
            return
        body = bytes(buffer[5:size])
        del buffer[:size]
        if kind == ROBOT_MESSAGE:
            try:
                said = _message(body)
            except (error, IndexError):
                raise NotPrimary("a message that ends early") from None
            if said is not None:
                yield said


def _message(body: bytes) -> Said | None:
    number, rest = body[9], body[10:]
    if number == 0:
        return Said("text", text=_text(rest))
    if number == 3:
        return Said("version", text=_text(rest[1 : 1 + rest[0]]))
    if number == 6:
        code, argument, level = unpack_from(">iii", rest)
        return Said("error", text=f"C{code}A{argument} {_text(rest[20:])}".strip(), level=level)
    if number == 7:
        title, program = rest[9 : 9 + rest[8]], _text(rest[9 + rest[8] :])
        for event in ("STARTED", "STOPPED"):
            if title.endswith(event.encode()):
                return Said(event.lower(), program=program)
    if number == 10:
        line, column = unpack_from(">ii", rest)
        return Said("failure", text=_text(rest[8:]), line=line, column=column)
    return None


def _text(data: bytes) -> str:
    return data.rstrip(b"\x00").decode("latin-1")
