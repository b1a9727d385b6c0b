"""How a program has to be laid out to get through the script port (script manual 5.11, ch. 2)."""

from __future__ import annotations

from collections.abc import Iterator

from .diagnostics import Context, Diagnostic, error, note, warning
from .nodes import Define, Node, Statement, walk
from .scope import program_of

MAX_NAME = 31
RESERVED = "_ur_"


def check(context: Context) -> Iterator[Diagnostic]:
    """Framing, names of programs, characters, and lines that continue the one above."""
    define = program_of(context.script)
    if define is None:
        yield _no_program(context)
    else:
        yield from _program(define)
    yield from _characters(context.text)
    yield from _continued(context)
    yield from _reserved(context)


def _no_program(context: Context) -> Diagnostic:
    body = context.script.body
    first: Node = body[0] if body else Node(1, 1)
    if len(body) > 1 and isinstance(body[0], Define) and not body[0].parameters:
        return error(
            body[1], "framing", "text after the program's `end`; put everything inside the one `def`"
        )
    return error(first, "framing", "a program is one `def name():` ... `end` around everything")


def _program(define: Define) -> Iterator[Diagnostic]:
    if define.column != 1:
        yield error(define, "framing", f"`{define.kind}` of the program starts in column 1")
    end = Node(define.end_line, define.end_column)
    if define.end_column != 1 and define.end_line != define.line:
        yield error(end, "framing", "the program's `end` stands in column 1, or the port waits for more")
    if len(define.name) > MAX_NAME:
        reason = f"program names are cut after {MAX_NAME} characters; this has {len(define.name)}"
        yield error(define, "program-name", reason)
    for node in walk(*define.body):
        if isinstance(node, Define):
            yield from _nested(node)
        elif isinstance(node, Statement) and node.column == 1:
            yield warning(node, "not-indented", "lines inside a program are indented by at least one blank")


def _nested(define: Define) -> Iterator[Diagnostic]:
    if define.column == 1:
        reason = f"a nested `{define.kind}` in column 1 begins a new program for the port; indent it"
        yield error(define, "program-cut", reason)
    if define.end_column == 1:
        end = Node(define.end_line, define.end_column)
        yield error(end, "program-cut", "an `end` in column 1 ends the program for the port; indent it")


def _characters(text: str) -> Iterator[Diagnostic]:
    for number, line in enumerate(text.split("\n"), start=1):
        if "\r" in line:
            yield warning(Node(number, line.index("\r") + 1), "line-ending", "lines end with \\n alone")
        odd = next((i for i, character in enumerate(line) if ord(character) > 127), None)
        if odd is not None:
            yield _odd_character(Node(number, odd + 1), line[odd])
    if text and not text.endswith("\n"):
        last = text.split("\n")
        place = Node(len(last), max(1, len(last[-1])))
        yield warning(place, "no-newline", "the last line has no line end; the port may wait for it")


def _odd_character(place: Node, character: str) -> Diagnostic:
    if ord(character) > 255:
        return error(place, "non-ascii", f"{character!a} is not in the controller's character set")
    return warning(place, "non-ascii", f"{character!a} arrives differently in UTF-8; keep to ASCII")


def _continued(context: Context) -> Iterator[Diagnostic]:
    for token in context.shape.continued:
        reason = f"a line that starts with `{token}` continues the one above; a newline ends nothing"
        yield warning(Node(token.line or 1, token.column or 1), "continued-line", reason)


def _reserved(context: Context) -> Iterator[Diagnostic]:
    for node in walk(*context.script.body):
        if isinstance(node, Define) and node.name.startswith(RESERVED):
            yield error(node, "reserved-name", f"names that start with {RESERVED} are the controller's own")
        if isinstance(node, Define) and node.kind == "sec":
            yield note(node, "secondary", "a secondary program shares one controller step; it must not wait")
