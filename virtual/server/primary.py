"""Messages of the primary and secondary interface, as UR's client library reads them (include/.../primary).

Outer layout: int32 size (itself included), uint8 type; big endian.
"""

from dataclasses import dataclass
from struct import Struct, pack

ROBOT_STATE, ROBOT_MESSAGE = 16, 20
HEAD = Struct(">iB")
_SOURCE = -2  # of controller messages


@dataclass(frozen=True)
class Text:
    """What textmsg says."""

    text: str

    def body(self) -> tuple[int, bytes]:
        """Return the number of this message and its content."""
        return 0, _encoded(self.text)


@dataclass(frozen=True)
class Key:
    """A program was started or stopped."""

    event: str
    program: str

    def body(self) -> tuple[int, bytes]:
        """Return the number of this message and its content."""
        title = f"PROGRAM_XXX_{self.event}".encode("ascii")
        return 7, pack(">iiB", 0, 0, len(title)) + title + _encoded(self.program)


@dataclass(frozen=True)
class Failure:
    """A program was refused or stopped; line and column from 1."""

    line: int
    column: int
    text: str

    def body(self) -> tuple[int, bytes]:
        """Return the number of this message and its content."""
        return 10, pack(">ii", self.line, self.column) + _encoded(self.text)


@dataclass(frozen=True)
class ErrorCode:
    """An entry of the controller's error list, C<code>A<argument>; level 3 is a fault."""

    code: int
    argument: int
    text: str
    level: int = 3

    def body(self) -> tuple[int, bytes]:
        """Return the number of this message and its content."""
        head = pack(">iiiII", self.code, self.argument, self.level, 0, 0)
        return 6, head + _encoded(self.text)


@dataclass(frozen=True)
class Software:
    """The first message of a connection: which controller this is."""

    version: tuple[int, ...]

    def body(self) -> tuple[int, bytes]:
        """Return the number of this message and its content."""
        project, (major, minor, bugfix, build) = b"URControl", self.version
        return 3, (
            bytes([len(project)])
            + project
            + pack(">BBii", major, minor, bugfix, build)
            + b"01-01-2025, 00:00:00"
        )


Message = Text | Key | Failure | ErrorCode | Software


def encode(message: Message, time: float) -> bytes:
    """Return a message of the robot at a time (s since the controller started)."""
    number, content = message.body()
    body = pack(">QbB", round(time * 1e6), _SOURCE, number) + content
    return HEAD.pack(HEAD.size + len(body), ROBOT_MESSAGE) + body


@dataclass(frozen=True)
class Mode:
    """What the robot state says: power, safety, program."""

    power: bool
    protective_stop: bool
    running: bool
    paused: bool
    robot_mode: int
    speed: float


def robot_state(mode: Mode, joints: list[tuple[float, ...]], pose: tuple[float, ...], time: float) -> bytes:
    """Return one robot state with the sub-packages mode, joints and Cartesian.

    joints: per joint q, target q, qd (rad, rad/s), current (A), voltage (V), temperature (deg C).
    pose: TCP and its offset, 12 numbers (m, rad).
    """
    bools = (True, True, mode.power, False, mode.protective_stop, mode.running, mode.paused)
    state = pack(">Q7?bB3d", round(time * 1e6), *bools, mode.robot_mode, 0, mode.speed, 1.0, 1.0)
    joint = b"".join(pack(">3d4fB", *row[:6], 0.0, 253) for row in joints)
    body = _sub(0, state + b"\x00") + _sub(1, joint) + _sub(4, pack(">12d", *pose))
    return HEAD.pack(HEAD.size + len(body), ROBOT_STATE) + body


def _sub(number: int, content: bytes) -> bytes:
    return pack(">IB", 5 + len(content), number) + content


def _encoded(text: str) -> bytes:
    return text.encode("latin-1", "replace")
