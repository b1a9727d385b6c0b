"""Sending a program to the controller, and waiting until it says that it runs."""

import re
import socket
import time
from collections.abc import Iterator
from dataclasses import dataclass

from ..errors import InputError
from .primary import NotPrimary, Said, messages

PORT = 30001
_BEGIN = re.compile(r"^(def|sec)\s+([A-Za-z_]\w*)\s*\(\s*\)\s*:", re.MULTILINE)
_LONGEST_NAME = 31


@dataclass(frozen=True)
class Program:
    """A program in a file: its name, its text, lines before it, and whether it is a secondary program."""

    name: str
    text: str
    before: int
    secondary: bool


def find_program(text: str, file: str) -> Program:
    """Return the program of a file; what stands before its first line is not sent.

    Raises InputError: there is no program, or it is not ASCII, or has no `end` in column 1.
    """
    text = text.replace("\r\n", "\n")
    begin = _BEGIN.search(text)
    if begin is None:
        raise InputError(f"{file}: no program; a line `def name():` in column 1 is needed")
    body = text[begin.start() :].rstrip() + "\n"
    before = text.count("\n", 0, begin.start())
    if not body.isascii():
        line = next(n for n, row in enumerate(body.split("\n"), start=before + 1) if not row.isascii())
        raise InputError(f"{file}: line {line}: not ASCII; the controller takes no other characters")
    if re.search(r"^end\s*(#.*)?$", body, re.MULTILINE) is None:
        raise InputError(f"{file}: no `end` in column 1; the controller would wait for it for ever")
    if len(begin[2]) > _LONGEST_NAME:
        raise InputError(f"{file}: the program's name has more than {_LONGEST_NAME} characters; shorten it")
    return Program(begin[2], body, before, begin[1] == "sec")


def upload(
    host: str, program: Program, file: str, port: int = PORT, timeout: float = 10.0, settle: float = 0.5
) -> None:
    """Send a program and return when the controller says that it was started.

    timeout: s to wait for that. settle: s for which errors after the start still count.
    Raises InputError with the controller's own error and the line in the file, or when nothing is said.
    """
    where = f"--host {host}"
    try:
        connection = socket.create_connection((host, port), timeout)
    except OSError as reason:
        raise InputError(
            f"{where}: no script port {port}: {reason.strerror or reason}; is the robot on?"
        ) from None
    with connection:
        said = _listen(connection, where)
        if _wait(said, time.monotonic() + timeout, "version") is None:
            raise InputError(f"{where}: port {port} does not introduce itself; is this a robot?")
        connection.sendall(program.text.encode("ascii"))
        end = time.monotonic() + (settle if program.secondary else timeout)
        for message in said:
            if message is not None:
                _complain(message, program, file)
            if message is not None and message.kind == "started" and message.program == program.name:
                end = time.monotonic() + settle
                break
            if time.monotonic() > end:
                if program.secondary:
                    return
                raise InputError(
                    f"{where}: {program.name} was sent, but not started within {timeout:.0f} s; is the robot "
                    "in remote control, and are its brakes released?"
                )
        for message in said:
            if message is not None:
                _complain(message, program, file)
            if time.monotonic() > end:
                return


def _complain(said: Said, program: Program, file: str) -> None:
    if said.kind == "failure":
        raise InputError(f"{file}: line {said.line + program.before}, column {said.column}: {said.text}")
    if said.kind == "error" and said.level >= 3:
        raise InputError(f"{file}: the controller says: {said.text}")


def _wait(said: Iterator[Said | None], end: float, kind: str) -> Said | None:
    for message in said:
        if message is not None and message.kind == kind:
            return message
        if time.monotonic() > end:
            break
    return None


def _listen(connection: socket.socket, where: str) -> Iterator[Said | None]:
    """Yield messages, and None when there was none for a moment."""
    buffer = bytearray()
    connection.settimeout(0.05)
    while True:
        try:
            data = connection.recv(1 << 16)
        except TimeoutError:
            yield None
            continue
        except OSError as reason:
            raise InputError(f"{where}: connection lost: {reason.strerror or reason}") from None
        if not data:
            raise InputError(f"{where}: the controller closed the connection")
        buffer += data
        try:
            yield from messages(buffer)
        except NotPrimary as reason:
            raise InputError(f"{where}: this is no primary interface: {reason}") from None
        yield None
