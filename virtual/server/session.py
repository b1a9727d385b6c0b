"""One RTDE client: recipes, start and pause. It knows no socket: bytes in, bytes out."""

import math
import struct
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from struct import Struct

from . import packets
from .fields import FORMATS, INPUTS, output_type
from .packets import BrokenStream, message, package

FASTEST = 500.0
"""Hz, of an e-Series controller."""

Values = Mapping[str, tuple[float, ...]]
Owners = dict[str, "Session"]


@dataclass(frozen=True)
class Recipe:
    """Inputs that arrive together: names, how many numbers each has, and the layout of all."""

    names: tuple[str, ...]
    widths: tuple[int, ...]
    layout: Struct

    @staticmethod
    def of(names: tuple[str, ...]) -> "Recipe":
        """Return the recipe of known inputs."""
        layouts = [FORMATS[INPUTS[name]] for name in names]
        widths = tuple(len(layout.unpack(bytes(layout.size))) for layout in layouts)
        return Recipe(names, widths, Struct(">" + "".join(layout.format[1:] for layout in layouts)))

    def values(self, data: bytes) -> dict[str, tuple[float, ...]]:
        """Return name -> numbers; data: as many bytes as the layout has."""
        flat, out, at = self.layout.unpack(data), dict[str, tuple[float, ...]](), 0
        for name, width in zip(self.names, self.widths, strict=True):
            out[name] = flat[at : at + width]
            at += width
        return out


class Session:
    """The state of one connection.

    version: of the controller. owners: input -> session, shared by all connections: two clients cannot
    write the same input. write: takes what a client sets.
    """

    def __init__(self, version: tuple[int, ...], owners: Owners, write: Callable[[Values], None]) -> None:
        self.outputs: tuple[str, ...] = ()
        self.running = False
        self._version, self._owners, self._write = version, owners, write
        self._buffer = bytearray()
        self._inputs: list[Recipe] = []
        self._rate, self._sent = FASTEST, 0.0
        self._replies: dict[int, Callable[[bytes], bytes]] = {
            packets.VERSION: self._protocol,
            packets.CONTROLLER: lambda _: struct.pack(">4I", *version),
            packets.OUTPUTS: self._setup_outputs,
            packets.INPUTS: self._setup_inputs,
            packets.START: lambda _: self._run(True),
            packets.PAUSE: lambda _: self._run(False),
        }

    def feed(self, data: bytes) -> Iterator[bytes]:
        """Take bytes as they come; yield the replies.

        Raises BrokenStream when the client has to be dropped; the reason is the message.
        """
        self._buffer += data
        for kind, payload in packets.cut(self._buffer):
            if kind == packets.DATA:
                if (complaint := self._data(payload)) is not None:
                    yield message(complaint, packets.WARNING)
            elif kind == packets.TEXT:
                continue
            elif kind in self._replies:
                yield package(kind, self._replies[kind](payload))
            else:
                raise BrokenStream(f"there is no package of type {kind}")

    def due(self) -> bool:
        """Whether this client gets a package now; to be asked once a tick of 500 Hz."""
        if not self.running:
            return False
        self._sent += self._rate
        if self._sent < FASTEST - 1e-6:
            return False
        self._sent -= FASTEST
        return True

    def close(self) -> None:
        """Leave the inputs to others."""
        self.running = False
        for name in [name for name, owner in self._owners.items() if owner is self]:
            del self._owners[name]

    def _protocol(self, payload: bytes) -> bytes:
        return bytes([payload == b"\x00\x02"])

    def _run(self, running: bool) -> bytes:
        self.running = running and bool(self.outputs)
        self._sent = FASTEST - self._rate
        return b"\x01"

    def _setup_outputs(self, payload: bytes) -> bytes:
        if len(payload) < 8:
            raise BrokenStream("a request for outputs begins with the frequency, 8 bytes")
        (rate,) = struct.unpack_from(">d", payload)
        names = _names(payload[8:])
        types = [output_type(name, self._version) or "NOT_FOUND" for name in names]
        good = bool(names) and "NOT_FOUND" not in types and math.isfinite(rate) and rate > 0.0
        if good:
            self.outputs, self._rate = names, min(rate, FASTEST)
        return bytes([good]) + ",".join(types).encode()

    def _setup_inputs(self, payload: bytes) -> bytes:
        names = _names(payload)
        types = [self._input_type(name) for name in names]
        good = bool(names) and not {"NOT_FOUND", "IN_USE"} & set(types) and len(self._inputs) < 255
        if good:
            self._owners.update(dict.fromkeys(names, self))
            self._inputs.append(Recipe.of(names))
        return bytes([len(self._inputs) if good else 0]) + ",".join(types).encode()

    def _input_type(self, name: str) -> str:
        if name not in INPUTS:
            return "NOT_FOUND"
        return INPUTS[name] if self._owners.get(name, self) is self else "IN_USE"

    def _data(self, payload: bytes) -> str | None:
        """Hand inputs on; return what is wrong with them."""
        number = payload[0] if payload else 0
        recipe = self._inputs[number - 1] if 0 < number <= len(self._inputs) else None
        if recipe is None:
            return f"there is no input recipe {number}"
        if len(payload) - 1 < recipe.layout.size:
            return f"input recipe {number} takes {recipe.layout.size} bytes, not {len(payload) - 1}"
        # More is taken: ur_rtde 1.6.5 sends getForwardKinematics(q, tcp), 12 numbers, in a recipe of 6.
        values = recipe.values(payload[1 : 1 + recipe.layout.size])
        if not all(math.isfinite(x) for numbers in values.values() for x in numbers):
            return f"input recipe {number} holds a number that is not finite"
        self._write(values)
        return None


def _names(text: bytes) -> tuple[str, ...]:
    return tuple(name for name in text.decode("latin-1").split(",") if name)
