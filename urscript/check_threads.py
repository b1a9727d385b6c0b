"""Threads: loops that never wait, two that move the robot, critical sections left open."""

from __future__ import annotations

from collections.abc import Iterator

from .catalogue import catalogue
from .check_flow import is_endless, leaves
from .diagnostics import Context, Diagnostic, error, note, warning
from .nodes import (
    Assign,
    Block,
    Call,
    Command,
    Define,
    Evaluate,
    Handle,
    If,
    Name,
    Node,
    Run,
    Statement,
    While,
    walk,
)
from .scope import Routine, Unit, root_name, timed_builtin


def check(context: Context) -> Iterator[Diagnostic]:
    """Look at waiting, motion and critical sections of every routine."""
    unit = context.unit
    for routine in unit.routines:
        for node in routine.nodes():
            if isinstance(node, While) and is_endless(node):
                yield from _waiting(unit, routine, node)
        for block in _blocks(routine):
            yield from _critical(unit, routine, block)
        if routine.define is not None and routine.define.kind == "sec":
            yield from _secondary(unit, routine)
    yield from _motion(unit)


def waits(unit: Unit, routine: Routine, node: Node) -> bool:
    """Whether the node itself may consume controller time."""
    if isinstance(node, Handle):
        return node.keyword == "join"
    if isinstance(node, Command):
        return node.keyword in ("pause", "halt")
    if timed_builtin(routine, node):
        return True
    callee = _callee(routine, node)
    return callee is not None and callee.symbol in unit.timed


def _callee(routine: Routine, node: Node) -> Routine | None:
    if isinstance(node, Call) and isinstance(node.function, Name):
        return routine.find(node.function.name)
    return None


def _waiting(unit: Unit, routine: Routine, loop: While) -> Iterator[Diagnostic]:
    inside = list(walk(*loop.body, into_definitions=False))
    if not _may_pass(unit, routine, loop.body):
        return
    if any(waits(unit, routine, node) for node in inside):
        reason = "not every way through this loop waits; add sync() to the others"
        yield warning(loop, "no-sync", reason)
    else:
        yield error(loop, "no-sync", "this loop never waits and the controller stops the program; add sync()")


def _may_pass(unit: Unit, routine: Routine, body: Block) -> bool:
    """Whether the loop around this block may begin again without having waited."""
    for statement in body:
        if isinstance(statement, If):
            blocks = [*(branch.body for branch in statement.branches), statement.otherwise]
            passing = [_may_pass(unit, routine, block) for block in blocks]
            if not any(passing):
                return False
            if any(_repeats(unit, routine, block) for block in blocks):
                return True
        elif isinstance(statement, Command) and statement.keyword == "continue":
            return True
        elif leaves(statement) or _certainly_waits(unit, routine, statement):
            return False
    return True


def _repeats(unit: Unit, routine: Routine, body: Block) -> bool:
    """Whether a `continue` stands in the block before anything that waits."""
    for statement in body:
        if isinstance(statement, Command) and statement.keyword == "continue":
            return True
        if _certainly_waits(unit, routine, statement):
            return False
    return False


def _certainly_waits(unit: Unit, routine: Routine, statement: Statement) -> bool:
    if isinstance(statement, If | While | Define):
        return False
    return any(waits(unit, routine, node) for node in walk(statement))


def _blocks(routine: Routine) -> Iterator[Block]:
    yield routine.body
    for node in routine.nodes():
        if isinstance(node, While):
            yield node.body
        elif isinstance(node, If):
            yield from (branch.body for branch in node.branches)
            yield node.otherwise


def _critical(unit: Unit, routine: Routine, block: Block) -> Iterator[Diagnostic]:
    opened: Statement | None = None
    for statement in block:
        keyword = statement.keyword if isinstance(statement, Command) else ""
        if keyword == "enter_critical":
            if opened is not None:
                yield warning(statement, "critical", "enter_critical inside a critical section")
            opened = statement
        elif keyword == "exit_critical":
            if opened is None:
                yield warning(statement, "critical", "exit_critical without enter_critical in the same block")
            opened = None
        elif opened is not None and any(waits(unit, routine, node) for node in walk(statement)):
            yield note(
                statement, "critical-waits", "this waits, so other threads run inside the critical section"
            )
    if opened is not None:
        yield warning(opened, "critical", "enter_critical without exit_critical in the same block")


def _secondary(unit: Unit, routine: Routine) -> Iterator[Diagnostic]:
    for node in routine.nodes():
        if isinstance(node, Run):
            yield warning(node, "secondary", "threads in a secondary program are not defined")
        elif waits(unit, routine, node):
            yield error(node, "secondary", "a secondary program must not wait; use a `def` program")


def _motion(unit: Unit) -> Iterator[Diagnostic]:
    """Two threads may move in turn if the first is killed or joined; then its handle is."""
    moving = {routine.symbol for routine in unit.routines if _moves(routine)}
    moving = _closure(unit, moving)
    movers = [r for r in unit.routines if r.symbol in moving and (_is_thread(r) or r is unit.root)]
    if len(movers) < 2:
        return
    ended = {_handle_name(node) for r in unit.routines for node in r.nodes() if isinstance(node, Handle)}
    for routine in unit.routines:
        for node, handle in _starts(routine):
            thread = routine.find(node.thread)
            if thread in movers and handle not in ended:
                reason = f"{node.thread!r} moves the robot and so does {_other(movers, thread)}"
                yield warning(node, "second-motion", f"{reason}; keep the handle and kill or join it first")


def _moves(routine: Routine) -> bool:
    found = False
    for node in routine.nodes():
        if timed_builtin(routine, node) and isinstance(node, Call) and isinstance(node.function, Name):
            found = found or catalogue()[node.function.name].motion
    return found


def _closure(unit: Unit, moving: set[str]) -> set[str]:
    while True:
        more = {r.symbol for r in unit.routines if any(_callee_symbol(r, n) in moving for n in r.nodes())}
        if more <= moving:
            return moving
        moving = moving | more


def _callee_symbol(routine: Routine, node: Node) -> str:
    callee = _callee(routine, node)
    return callee.symbol if callee is not None else ""


def _is_thread(routine: Routine) -> bool:
    return routine.define is not None and routine.define.kind == "thread"


def _handle_name(node: Handle) -> str:
    return root_name(node.value)


def _starts(routine: Routine) -> Iterator[tuple[Run, str]]:
    for node in routine.nodes():
        if isinstance(node, Assign) and isinstance(node.value, Run):
            yield node.value, root_name(node.target)
        elif isinstance(node, Evaluate) and isinstance(node.value, Run):
            yield node.value, ""


def _other(movers: list[Routine], thread: Routine | None) -> str:
    names = [r.define.name if r.define else "the program" for r in movers if r is not thread]
    return ", ".join(repr(name) for name in names[:3])
