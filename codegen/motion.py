"""The user's own motion: a function body or a whole program, made ready to run inside the guard.

A whole program is taken apart: its functions and threads move to the guard's first level, and what it
assigns becomes global there, as it was in the program. Every remark names the user's line and column.
"""

import re
import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from ..errors import InputError
from ..urscript import Diagnostic, ScriptError, check, parse
from ..urscript.nodes import Assign, Call, Define, Literal, Name, Node, walk

#: Names of the guard begin so; the user's must not.
PREFIX = "rs_"
#: What a function body may do and a program may not: it gets indented and framed.
_FRAMING = frozenset({"framing", "not-indented", "program-cut", "no-newline", "line-ending"})
_WRAPPER = "motion"
_WRITES = frozenset({f"write_output_{kind}_register" for kind in ("float", "integer", "boolean")})
_OURS = {"boolean": range(64, 66), "float": range(24, 48), "integer": range(24, 32)}


@dataclass(frozen=True)
class Motion:
    """definitions: functions and threads; body: statements; both without indentation. remarks: warnings."""

    definitions: str
    body: str
    remarks: tuple[str, ...] = ()


def read_motion(text: str, file: str, version: str) -> Motion:
    """Check the user's motion for a PolyScope version and take it apart.

    Raises InputError "FILE:LINE:COLUMN: what is wrong" for the first error.
    """
    text = text.replace("\r\n", "\n")
    try:
        statements = parse(text).body
    except ScriptError as error:
        raise InputError(f"{file}:{error.line}:{error.column}: {error.reason}") from None
    if not statements:
        raise InputError(f"{file}: holds no statement; give a function body or a URScript program")
    first = statements[0]
    whole = len(statements) == 1 and isinstance(first, Define) and first.kind == "def"
    found = check(text, version) if whole else _check_body(text, version)
    found = sorted([*found, *_own_remarks(statements)])
    for remark in found:
        if remark.severity == "error":
            raise InputError(_spoken(file, remark))
    remarks = tuple(_spoken(file, x) for x in found if x.severity == "warning")
    if whole and isinstance(first, Define):
        return _apart(text, first, remarks)
    return Motion("", textwrap.dedent(text).strip("\n"), remarks)


def _check_body(text: str, version: str) -> list[Diagnostic]:
    """Check statements as the body of a function, which they become."""
    wrapped = f"def program():\ndef {_WRAPPER}():\n{text}\nend\n{_WRAPPER}()\nend\n"
    remarks = [x for x in check(wrapped, version) if x.code not in _FRAMING]
    return [Diagnostic(x.line - 2, x.column, x.code, x.severity, x.message) for x in remarks]


def _own_remarks(statements: Sequence[Node]) -> Iterator[Diagnostic]:
    for node in walk(*statements):
        name = _bound_name(node)
        if name.startswith(PREFIX):
            reason = f"names that begin with {PREFIX} belong to the guard; rename {name}"
            yield Diagnostic(node.line, node.column, "reserved-name", "error", reason)
        if isinstance(node, Define) and node.kind == "sec":
            reason = "a secondary program cannot be a motion; give a `def` program or a function body"
            yield Diagnostic(node.line, node.column, "secondary", "error", reason)
        if isinstance(node, Call):
            yield from _register_remark(node)


def _bound_name(node: Node) -> str:
    if isinstance(node, Assign) and isinstance(node.target, Name):
        return node.target.name
    return node.name if isinstance(node, Define) else ""


def _register_remark(node: Call) -> Iterator[Diagnostic]:
    name = node.function.name
    if name not in _WRITES or not node.arguments or not isinstance(node.arguments[0].value, Literal):
        return
    address = node.arguments[0].value.value
    if address in _OURS[name.split("_")[2]]:
        reason = f"the guard writes output register {address} too; see docs/guard.md for those it uses"
        yield Diagnostic(node.line, node.column, "register", "warning", reason)


def _spoken(file: str, remark: Diagnostic) -> str:
    return f"{file}:{remark.line}:{remark.column}: {remark.message} [{remark.code}]"


def _apart(text: str, program: Define, remarks: tuple[str, ...]) -> Motion:
    """Cut a program into its definitions and its statements, the latter with global variables."""
    starts = [0, *(match.end() for match in re.finditer("\n", text))]

    def offset(line: int, column: int) -> int:
        return starts[line - 1] + column - 1

    edits: list[tuple[int, int, str]] = []
    definitions = []
    for node in walk(*program.body, into_definitions=False):
        begin = offset(node.line, node.column)
        if isinstance(node, Define):
            end = offset(node.end_line, node.end_column) + len("end")
            definitions.append(_dedented(text[begin:end], node.column - 1))
            edits.append((begin, end, ""))
        elif isinstance(node, Assign) and isinstance(node.target, Name) and node.scope != "global":
            edits.append((begin, begin + len(node.scope), "global" if node.scope else "global "))
    head = re.compile(r"def\s+\w+\s*\(\s*\)\s*:").match(text, offset(program.line, program.column))
    assert head is not None  # the parser found it
    body = _edited(text, edits, head.end(), offset(program.end_line, program.end_column))
    return Motion("\n".join(definitions), textwrap.dedent(body).strip("\n").rstrip(), remarks)


def _dedented(text: str, margin: int) -> str:
    """Take the margin of a definition's first line away from the lines after it, as far as they have it."""
    return re.sub(rf"\n[ \t]{{1,{margin}}}", "\n", text) if margin else text


def _edited(text: str, edits: Sequence[tuple[int, int, str]], begin: int, end: int) -> str:
    pieces, place = [], begin
    for start, stop, new in sorted(edits):
        pieces += [text[place:start], new]
        place = stop
    return "".join([*pieces, text[place:end]])
