"""What the language layer raises: always one line with the place in the script."""

from __future__ import annotations

from ..errors import InputError


class ScriptError(InputError):
    """The text is no URScript, or cannot be run.

    Attributes:
        reason: the message without the place.
        line: line in the script, from 1.
        column: column in the script, from 1.
        code: a short stable name of the kind of error, as `check` reports it.

    """

    def __init__(self, reason: str, line: int, column: int, code: str = "syntax") -> None:
        super().__init__(f"line {line}, column {column}: {reason}")
        self.reason = reason
        self.line = line
        self.column = column
        self.code = code


class ScriptRuntimeError(ScriptError):
    """The program was stopped while it ran, as the controller would stop it."""


class Fault(Exception):  # noqa: N818 - it becomes a ScriptRuntimeError once the place is known
    """An instruction refuses its arguments or its moment; the machine adds line and column.

    Worlds raise it to make the program fail the way the controller would.
    """

    def __init__(self, reason: str, code: str = "runtime") -> None:
        super().__init__(reason)
        self.reason = reason
        self.code = code
