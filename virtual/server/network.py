"""The five ports of a controller on asyncio, and its clock.

One thread does everything, physics included: a tick costs about a third of 2 ms, so there is nothing to lock
and nobody to wait for. A client that does not read is skipped, and dropped in the end.
"""

import asyncio
import contextlib
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

from ...errors import InputError
from ...urscript import ScriptError
from ...urscript.compiler import compile_script
from ..controller import TICK
from . import packets
from .controller import Controller
from .dashboard import GREETING, Dashboard
from .framing import Framer, TooLarge
from .packets import BrokenStream
from .primary import Software, encode
from .snapshot import Snapshot

BACKLOG = 1_000_000
"""Bytes that may wait for a client before packages are skipped for it; 4 s of a full recording."""
PATIENCE = 5000
"""Packages skipped in a row (10 s) before a client that does not read is dropped."""
LONGEST_LINE = 65536
#: Lines that a dashboard client may send in one piece: answering them must not hold up the clock.
MOST_LINES = 200
"""Bytes of a line to the dashboard."""
WAITING_PROGRAMS = 64
STATE_EVERY = 50
"""Ticks between robot states: 10 Hz."""


@dataclass(frozen=True)
class Ports:
    """Where to listen; 0 takes any free port."""

    rtde: int = 30004
    dashboard: int = 29999
    primary: int = 30001
    secondary: int = 30002
    realtime: int = 30003


class Client(asyncio.Protocol):
    """One connection to some port of a server."""

    transport: asyncio.Transport

    def __init__(self, server: "Server") -> None:
        self.server = server
        self.skipped = 0

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Begin."""
        assert isinstance(transport, asyncio.Transport)
        self.transport = transport
        self.server.clients.add(self)

    def connection_lost(self, exc: Exception | None) -> None:
        """End."""
        self.server.clients.discard(self)

    def push(self, data: bytes) -> None:
        """Send what may be skipped when the client is slow; drop one that never reads."""
        if self.transport.get_write_buffer_size() <= BACKLOG:
            self.skipped = 0
            self.transport.write(data)
            return
        self.skipped += 1
        if self.skipped > PATIENCE:
            self.drop("does not read")

    def drop(self, reason: str) -> None:
        """Close at once, and say why."""
        if not self.transport.is_closing():
            self.server.controller.say(f"{type(self).__name__} client dropped: {reason}")
            self.transport.abort()

    def show(self, snapshot: Snapshot) -> None:
        """Send what is due at a tick."""


class Rtde(Client):
    """An RTDE client."""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:  # noqa: D102
        super().connection_made(transport)
        self._session = self.server.controller.session()
        self._complained = False

    def connection_lost(self, exc: Exception | None) -> None:  # noqa: D102
        super().connection_lost(exc)
        self._session.close()

    def data_received(self, data: bytes) -> None:  # noqa: D102
        try:
            for reply in self._session.feed(data):
                self.push(reply)
                if reply[2] == packets.TEXT and not self._complained:
                    self._complained = True
                    self.server.controller.say(f"RTDE client sends what is not taken: {_words(reply)}")
        except BrokenStream as error:
            self.transport.write(packets.message(str(error), packets.ERROR))
            self.server.controller.say(f"RTDE client dropped: {error}")
            self._session.close()
            self.transport.close()

    def show(self, snapshot: Snapshot) -> None:  # noqa: D102
        if self._session.due():
            fields = b"".join([snapshot.packed(name) for name in self._session.outputs])
            self.push(packets.package(packets.DATA, b"\x01" + fields))


def _words(reply: bytes) -> str:
    """Return what a text message says."""
    return reply[4 : 4 + reply[3]].decode("latin-1")


class DashboardClient(Client):
    """A client of the dashboard."""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:  # noqa: D102
        super().connection_made(transport)
        self._rest = b""
        self.transport.write(GREETING.encode() + b"\n")

    def data_received(self, data: bytes) -> None:  # noqa: D102
        *lines, self._rest = (self._rest + data).split(b"\n")
        if len(self._rest) > LONGEST_LINE:
            self.drop("a line without an end")
        if len(lines) > MOST_LINES:
            self.drop(f"more than {MOST_LINES} lines at once")
        if self.transport.is_closing():
            return
        for line in lines:
            self.push(
                self.server.dashboard.answer(line.decode("latin-1")).encode("latin-1", "replace") + b"\n"
            )
            if line.strip() == b"quit":
                self.transport.close()
                return


class Script(Client):
    """A client of a script port; talks: whether messages and states are sent (all but the realtime port)."""

    def __init__(self, server: "Server", talks: bool = True) -> None:
        super().__init__(server)
        self.talks = talks
        self._framer = Framer()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:  # noqa: D102
        super().connection_made(transport)
        if self.talks:
            controller = self.server.controller
            self.transport.write(encode(Software(controller.version), controller.arm.time))
            self.transport.write(controller.robot_state())

    def data_received(self, data: bytes) -> None:  # noqa: D102
        try:
            for program in self._framer.feed(data):
                self._hand_on(program)
        except TooLarge as error:
            self.drop(str(error))

    def eof_received(self) -> None:  # noqa: D102
        with contextlib.suppress(TooLarge):
            for program in self._framer.close():
                self._hand_on(program)

    def connection_lost(self, exc: Exception | None) -> None:  # noqa: D102
        super().connection_lost(exc)
        if (begun := self._framer.unfinished) is not None:
            self.server.controller.say(f"program cut off before its end, not run: {begun.strip()[:60]}")

    def _hand_on(self, text: str) -> None:
        if self.server.waiting.qsize() >= WAITING_PROGRAMS:
            self.drop("more programs than can be run")
        else:
            self.server.waiting.put_nowait(text)


class Server:
    """A controller on its ports. `running` in `async with` means: ports open, time passes.

    speed: simulated per real time; None: as fast as it goes.
    """

    def __init__(
        self,
        controller: Controller,
        host: str = "127.0.0.1",
        ports: Ports | None = None,
        speed: float | None = 1.0,
    ) -> None:
        self.controller, self.dashboard = controller, Dashboard(controller)
        self.clients: set[Client] = set()
        self.waiting: asyncio.Queue[str] = asyncio.Queue()
        self.late = 0.0
        self._host, self._wanted, self._speed = host, ports or Ports(), speed
        self._listeners: list[asyncio.Server] = []
        self._compiler = ThreadPoolExecutor(1)

    async def open(self) -> Ports:
        """Listen; return the ports. Raises InputError when one is taken."""
        makers: dict[str, Callable[[], Client]] = {
            "rtde": lambda: Rtde(self),
            "dashboard": lambda: DashboardClient(self),
            "primary": lambda: Script(self),
            "secondary": lambda: Script(self),
            "realtime": lambda: Script(self, talks=False),
        }
        taken: dict[str, int] = {}
        for name, maker in makers.items():
            port = getattr(self._wanted, name)
            try:
                listener = await asyncio.get_running_loop().create_server(maker, self._host, port)
            except OSError as error:
                self.close()
                raise InputError(
                    f"--host {self._host}: port {port} ({name}) cannot be opened: {error.strerror or error}; "
                    "stop the other controller, or take another --host"
                ) from None
            self._listeners.append(listener)
            taken[name] = listener.sockets[0].getsockname()[1]
        return Ports(**taken)

    async def run(self) -> None:
        """Let time pass until cancelled."""
        loader = asyncio.create_task(self._load())
        clock = asyncio.get_running_loop().time
        start, ticks = clock(), 0
        try:
            while True:
                self._tick()
                ticks += 1
                if self._speed is None:
                    await asyncio.sleep(0)
                    continue
                early = start + ticks * TICK / self._speed - clock()
                if early < -1.0:  # too slow a machine: let simulated time fall behind instead of rushing
                    self.late -= early
                    start -= early
                await asyncio.sleep(max(early, 0.0))
        finally:
            loader.cancel()

    def close(self) -> None:
        """Close all ports and connections."""
        for listener in self._listeners:
            listener.close()
        for client in list(self.clients):
            client.transport.abort()
        self._compiler.shutdown(wait=False, cancel_futures=True)

    def _tick(self) -> None:
        controller = self.controller
        snapshot = controller.tick()
        said = controller.take_messages()
        state = b"" if controller.arm.ticks % STATE_EVERY or not self.clients else controller.robot_state()
        for client in tuple(self.clients):
            client.show(snapshot)
            if isinstance(client, Script) and client.talks and (said or state):
                client.push(said + state)

    async def _load(self) -> None:
        """Start programs in the order in which they came; parsing runs beside the clock."""
        loop = asyncio.get_running_loop()
        while True:
            text = await self.waiting.get()
            if self.dashboard.knows(text):
                self.dashboard.obey(text)
                continue
            if not text.startswith(("def", "sec")):
                text = f"def unnamed():\n{text}\nend\n"
            with contextlib.suppress(ScriptError):  # it is announced by the start below
                await loop.run_in_executor(self._compiler, compile_script, text)
            self.controller.programs.start(text)
