"""Jumps and what they leave unreachable."""

from __future__ import annotations

from collections.abc import Iterator

from .diagnostics import Context, Diagnostic, error, warning
from .nodes import Block, Command, Define, Expression, If, Label, Literal, Return, While, walk
from .scope import Routine


def check(context: Context) -> Iterator[Diagnostic]:
    """Every routine, block by block."""
    for routine in context.unit.routines:
        yield from _blocks(routine, routine.body, in_loop=False)
        yield from _returns(routine)


def is_endless(loop: While) -> bool:
    """`while True` in whatever spelling."""
    return isinstance(loop.condition, Literal) and loop.condition.value is True


def _blocks(routine: Routine, body: Block, in_loop: bool) -> Iterator[Diagnostic]:
    left = ""
    for statement in body:
        if left and not isinstance(statement, Label | Define):
            yield warning(statement, "unreachable", f"never reached after `{left}`")
            left = ""
        if isinstance(statement, Command) and statement.keyword in ("break", "continue") and not in_loop:
            yield error(statement, "outside-loop", f"`{statement.keyword}` outside of a loop")
        if isinstance(statement, If):
            for block in (*(branch.body for branch in statement.branches), statement.otherwise):
                yield from _blocks(routine, block, in_loop)
            yield from _constant(statement)
        elif isinstance(statement, While):
            yield from _blocks(routine, statement.body, in_loop=True)
        left = left or leaves(statement)


def leaves(statement: object) -> str:
    """Give the keyword by which a statement never lets the next one run, or ""."""
    if isinstance(statement, Return):
        return "return"
    if isinstance(statement, Command) and statement.keyword in ("break", "continue", "halt"):
        return statement.keyword
    if isinstance(statement, While) and is_endless(statement) and not _breaks(statement.body):
        return "while True"
    if isinstance(statement, If) and statement.otherwise:
        blocks = [*(branch.body for branch in statement.branches), statement.otherwise]
        if all(any(leaves(inner) for inner in block) for block in blocks):
            return "if"
    return ""


def _breaks(body: Block) -> bool:
    """Whether a `break` of this very loop is among the statements."""
    for statement in body:
        if isinstance(statement, Command) and statement.keyword == "break":
            return True
        if isinstance(statement, If):
            blocks = (*(branch.body for branch in statement.branches), statement.otherwise)
            if any(_breaks(block) for block in blocks):
                return True
    return False


def _constant(statement: If) -> Iterator[Diagnostic]:
    for branch in statement.branches:
        if isinstance(branch.condition, Literal) and branch.condition.value is False:
            yield warning(branch, "unreachable", "never reached: the condition is False")


def _returns(routine: Routine) -> Iterator[Diagnostic]:
    is_function = routine.define is not None and routine.parent is not None
    parameterised = routine.define is not None and bool(routine.define.parameters)
    for node in routine.nodes():
        if not isinstance(node, Return):
            continue
        if node.value is None:
            yield error(node, "bare-return", "`return` takes a value; write `return None`")
        elif _swallows(node.value, node.line):
            yield warning(
                node, "return-continues", "`return` takes the next line as its value; write `return None`"
            )
        if not is_function and not parameterised:
            yield warning(node, "return-outside", "`return` outside of a function; `halt` ends a program")
        elif routine.define is not None and routine.define.kind == "thread" and _is_value(node.value):
            yield warning(node, "thread-return", "the value of a thread is dropped; write `return None`")


def _is_value(value: Expression | None) -> bool:
    return value is not None and not (isinstance(value, Literal) and value.value is None)


def _swallows(value: Expression, line: int) -> bool:
    first = min((node.line for node in walk(value)), default=line)
    return first > line
