"""Reads a program as the controller would, before the controller does."""

from __future__ import annotations

from . import check_calls, check_flow, check_framing, check_names, check_threads, check_types
from .catalogue import Version
from .diagnostics import Context, Diagnostic
from .errors import ScriptError
from .parser import parse, scan
from .scope import resolve

CHECKS = (
    check_framing.check,
    check_names.check,
    check_calls.check,
    check_types.check,
    check_flow.check,
    check_threads.check,
)


def check(text: str, version: str = "5.23") -> list[Diagnostic]:
    """Everything wrong or doubtful in a program, in the order of the text.

    Args:
        text: the program as it would be sent.
        version: PolyScope version it is meant for: "5.4" and newer, "10.x" for PolyScope X.

    Returns:
        Diagnostics; a text that cannot be parsed gives exactly one.

    Raises:
        InputError: no such version.

    """
    target = Version.parse(version)
    try:
        script = parse(text)
        context = Context(text, script, resolve(script), scan(text), target)
    except ScriptError as error:
        return [Diagnostic(error.line, error.column, error.code, "error", error.reason)]
    return sorted({diagnostic for run in CHECKS for diagnostic in run(context)})
