"""Cuts programs out of what arrives at a script port.

Script manual e-Series 5.11, ch. 2: a program is `def` or `sec` in column 1 to `end` in column 1. Other lines
in column 1 inside a program (comments, continued expressions, as client libraries send them) belong to it.
"""

import re
from collections.abc import Iterator

BEGIN = re.compile(rb"(def|sec)\s+\w")
END = re.compile(rb"end\s*(#.*)?$")
LARGEST = 4_000_000
"""Bytes of one program; more is not a program."""


class TooLarge(Exception):  # noqa: N818 - it is what it says
    """More text than a program can have."""


class Framer:
    """The text of one connection; programs and lone lines come out in order."""

    def __init__(self) -> None:
        self._rest = b""
        self._program: list[bytes] = []
        self._size = 0

    def feed(self, data: bytes) -> Iterator[str]:
        """Take bytes; yield every complete program, and every other line that is no comment.

        Raises TooLarge.
        """
        *lines, self._rest = (self._rest + data).split(b"\n")
        self._size += len(data)
        if self._size > LARGEST:
            raise TooLarge(f"more than {LARGEST} bytes without the `end` of a program")
        for line in lines:
            yield from self._line(line.rstrip(b"\r"))

    def close(self) -> Iterator[str]:
        """Yield what a last line without its newline completes."""
        yield from self.feed(b"\n") if self._rest else ()

    @property
    def unfinished(self) -> str | None:
        """First line of a program whose `end` has not come, or None."""
        return _text(self._program[0]) if self._program else None

    def _line(self, line: bytes) -> Iterator[str]:
        if self._program:
            self._program.append(line)
            if END.match(line):
                text = _text(b"\n".join(self._program) + b"\n")
                self._program, self._size = [], 0
                yield text
        elif BEGIN.match(line):
            self._program = [line]
        else:
            self._size = 0
            if line.strip() and not line.lstrip().startswith(b"#"):
                yield _text(line).strip()


def _text(line: bytes) -> str:
    return line.decode("latin-1")
