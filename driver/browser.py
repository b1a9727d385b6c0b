"""The monitor in a browser: one page and a stream of the latest reading, on this computer only."""

import json
import math
import socket
import sys
import threading
import time
from collections.abc import Iterable
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from types import TracebackType
from typing import Any

from ..errors import InputError
from ..templates import renderer
from .monitor import Reading

ADDRESS = "127.0.0.1"
BROWSER_PORT = 8070
PERIOD = 1.0 / 15.0
"""s between two events of the stream."""
WINDOW = 20.0
"""s that a chart shows."""
PATIENCE = 10.0
"""s after which a browser that takes nothing is left; its page connects again by itself."""
BACKLOG = 4096
"""Bytes that may wait for a slow browser. It gets the latest reading next, not those that it missed."""
POLICY = (
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)


class Browser:
    """A page at `address` that shows what `show` was given last.

    host: the robot's address, for the title. joints: how many. port: 0 takes a free one.
    It listens until `close`. Raises InputError when the port cannot be had.
    """

    def __init__(self, host: str, joints: int, port: int = BROWSER_PORT) -> None:
        try:
            self._server = _Server(port, _page(host, joints))
        except OSError as reason:
            raise InputError(
                f"--port {port}: cannot listen at {ADDRESS}: {reason.strerror or reason}; choose another"
            ) from None
        self.port = int(self._server.server_address[1])
        self.address = f"http://{ADDRESS}:{self.port}/"
        self._thread = threading.Thread(target=self._server.serve_forever, args=(0.1,), daemon=True)
        self._thread.start()

    def __enter__(self) -> "Browser":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def show(self, reading: Reading) -> None:
        """Replace what the page shows; never waits for a browser."""
        self._server.latest.put(reading)

    def close(self) -> None:
        """End the streams and free the port."""
        self._server.latest.close()
        self._server.shutdown()
        self._server.server_close()
        self._thread.join()


class _Latest:
    """The latest reading, for any number of threads that wait for a newer one."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._number, self._closed = 0, False
        self._reading: Reading | None = None

    def put(self, reading: Reading) -> None:
        with self._changed:
            self._number, self._reading = self._number + 1, reading
            self._changed.notify_all()

    def close(self) -> None:
        with self._changed:
            self._closed = True
            self._changed.notify_all()

    def after(self, number: int) -> tuple[int, Reading] | None:
        """Wait for a reading later than that of this number; None once closed."""
        with self._changed:
            self._changed.wait_for(lambda: self._closed or self._number > number)
            if self._closed or self._reading is None:
                return None
            return self._number, self._reading


class _Server(ThreadingHTTPServer):
    """A thread for every connection; all of them are daemons."""

    def __init__(self, port: int, page: bytes) -> None:
        self.page, self.latest = page, _Latest()
        super().__init__((ADDRESS, port), _Handler)

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Keep quiet about browsers that went away."""
        if not isinstance(sys.exception(), OSError):
            super().handle_error(request, client_address)


class _Handler(BaseHTTPRequestHandler):
    """`/` is the page, `/stream` the readings as server-sent events."""

    server: _Server
    timeout = PATIENCE
    disable_nagle_algorithm = True

    def do_GET(self) -> None:
        """Answer one request."""
        if not self._is_for_us():
            self.send_error(HTTPStatus.FORBIDDEN)
        elif self.path == "/":
            self._head("text/html; charset=utf-8", len(self.server.page))
            self.wfile.write(self.server.page)
        elif self.path == "/stream":
            self._stream()
        else:
            self.send_error(HTTPStatus.NOT_FOUND)

    def log_message(self, format: str, *args: Any) -> None:
        """Say nothing; the terminal is the monitor's."""

    def _is_for_us(self) -> bool:
        """Refuse other names: a foreign page whose name was pointed at this computer comes with its own."""
        return self.headers.get("Host", "").split(":")[0] in (ADDRESS, "localhost")

    def _head(self, kind: str, length: int | None = None) -> None:
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", kind)
        if length is not None:
            self.send_header("Content-Length", str(length))
        self.send_header("Content-Security-Policy", POLICY)
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("Cache-Control", "no-store")
        self.end_headers()

    def _stream(self) -> None:
        self.connection.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, BACKLOG)
        self._head("text/event-stream")
        number = 0
        while found := self.server.latest.after(number):
            number, reading = found
            self.wfile.write(event(reading))
            time.sleep(PERIOD)


def event(reading: Reading) -> bytes:
    """Return a reading as a server-sent event, JSON: s, rad, Nm and deg C; null where there is no number."""
    state = {
        "time": reading.time,
        "q": _numbers(reading.q),
        "external": _numbers(reading.external),
        "threshold": _numbers(reading.threshold),
        "temperature": _numbers(reading.temperature),
        "over": [bool(x) for x in reading.over],
        "detections": [int(x) for x in reading.detections],
        "latest": reading.latest,
        "packages": reading.packages,
        "lost": reading.lost,
    }
    return f"data: {json.dumps(state, allow_nan=False)}\n\n".encode("ascii")


def _numbers(values: Iterable[float]) -> list[float | None]:
    return [round(float(x), 5) if math.isfinite(x) else None for x in values]


def _page(host: str, joints: int) -> bytes:
    page = renderer(html=True).get_template("monitor/page.html.jinja")
    return page.render(host=host, joints=joints, window=WINDOW).encode()
