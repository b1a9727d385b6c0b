"""Which variable and which function a name means.

Script manual e-Series 5.11, ch. 8: a variable without qualifier is the existing global of that name, else it
is local; variables of the program's first level are global even when declared `local`; functions do not see
the locals of the function around them. Binding is decided for the text as a whole, so a name that is global
anywhere is global everywhere; the checker warns where the order would matter.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from .catalogue import catalogue
from .nodes import (
    Assign,
    Block,
    Call,
    Command,
    Define,
    Expression,
    Handle,
    Index,
    Label,
    Member,
    Name,
    Node,
    Run,
    Script,
    walk,
)


@dataclass(frozen=True, slots=True, eq=False)
class Routine:
    """A function, thread or the program, with what it can see.

    Attributes:
        define: its syntax tree; None for the bare statements of a text that is no program.
        body: its statements.
        symbol: a Python identifier of its own.
        parent: the routine it is defined in.
        nested: the routines defined directly in it.
        locals: names that are local in it, its parameters included.

    """

    define: Define | None
    body: Block
    symbol: str
    parent: Routine | None
    nested: dict[str, Routine] = field(default_factory=dict)
    locals: frozenset[str] = frozenset()

    def find(self, name: str) -> Routine | None:
        """Give the function or thread that `name` means here."""
        routine: Routine | None = self
        while routine is not None:
            if name in routine.nested:
                return routine.nested[name]
            routine = routine.parent
        return None

    def nodes(self) -> Iterator[Node]:
        """Everything in it but what lies in nested routines."""
        return walk(*self.body, into_definitions=False)


@dataclass(frozen=True, slots=True)
class Unit:
    """A whole text, resolved.

    Attributes:
        root: the program, or the bare statements around several functions.
        routines: all of them, outer before inner.
        globals: names of the global variables.
        timed: symbols of the routines that may consume controller time.

    """

    root: Routine
    routines: tuple[Routine, ...]
    globals: frozenset[str]
    timed: frozenset[str]


def resolve(script: Script) -> Unit:
    """Find the program, its routines and its globals."""
    define = program_of(script)
    body = define.body if define else script.body
    global_names = frozenset(_global_names(body, script))
    routines: list[Routine] = []
    root = _routine(define, body, None, global_names, routines)
    return Unit(root, tuple(routines), global_names, _timed(routines))


def program_of(script: Script) -> Define | None:
    """Give the one parameterless `def` or `sec` that makes up the text, if it is a program."""
    only = script.body[0] if len(script.body) == 1 else None
    if isinstance(only, Define) and only.kind != "thread" and not only.parameters:
        return only
    return None


def root_name(target: Expression) -> str:
    """Give the variable that an assignment target belongs to."""
    while isinstance(target, Index | Member):
        target = target.base
    return target.name if isinstance(target, Name) else ""


def _global_names(first_level: Block, script: Script) -> Iterator[str]:
    yield from (root_name(s.target) for s in first_level if isinstance(s, Assign))
    for node in walk(*script.body):
        if isinstance(node, Assign) and node.scope == "global":
            yield root_name(node.target)


def _routine(
    define: Define | None,
    body: Block,
    parent: Routine | None,
    global_names: frozenset[str],
    found: list[Routine],
) -> Routine:
    name = define.name if define else "statements"
    hidden = frozenset(_local_names(define, body, parent is None, global_names))
    routine = Routine(define, body, f"f{len(found)}_{name}", parent, {}, hidden)
    found.append(routine)
    for node in routine.nodes():
        if isinstance(node, Define):
            routine.nested[node.name] = _routine(node, node.body, routine, global_names, found)
    return routine


def _local_names(
    define: Define | None, body: Block, is_root: bool, global_names: frozenset[str]
) -> Iterator[str]:
    yield from (parameter.name for parameter in (define.parameters if define else ()))
    first_level = {id(statement) for statement in body} if is_root else set()
    for node in walk(*body, into_definitions=False):
        if not isinstance(node, Assign) or id(node) in first_level or node.scope == "global":
            continue
        name = root_name(node.target)
        if node.scope == "local" or name not in global_names:
            yield name


def _timed(routines: list[Routine]) -> frozenset[str]:
    """Routines that call something timed, directly or through others; threads and the program always are."""
    direct = {r.symbol for r in routines if r.parent is None or _is_thread(r) or _waits(r)}
    calls = {routine.symbol: set(_callees(routine)) for routine in routines}
    while grown := {symbol for symbol, callees in calls.items() if callees & direct} - direct:
        direct |= grown
    return frozenset(direct)


def _is_thread(routine: Routine) -> bool:
    return routine.define is not None and routine.define.kind == "thread"


def _waits(routine: Routine) -> bool:
    return any(_is_timed_node(routine, node) for node in routine.nodes())


def _is_timed_node(routine: Routine, node: Node) -> bool:
    if isinstance(node, Handle):
        return True
    if isinstance(node, Command):
        return node.keyword in ("pause", "halt")
    return timed_builtin(routine, node)


def timed_builtin(routine: Routine, node: Node) -> bool:
    """Whether the node calls a built-in function that consumes controller time."""
    if not isinstance(node, Call) or not isinstance(node.function, Name):
        return False
    builtin = catalogue().get(node.function.name)
    return builtin is not None and builtin.timed and routine.find(node.function.name) is None


def _callees(routine: Routine) -> Iterator[str]:
    for node in routine.nodes():
        if isinstance(node, Call) and isinstance(node.function, Name):
            callee = routine.find(node.function.name)
            if callee is not None:
                yield callee.symbol


def by_name(unit: Unit) -> Mapping[str, Routine]:
    """Every routine under its name; of several with one name, the outermost and first."""
    names: dict[str, Routine] = {}
    for routine in unit.routines:
        if routine.define is not None:
            names.setdefault(routine.define.name, routine)
    return names


def header(unit: Unit) -> Routine:
    """Give the assignments before the first statement that does anything else, as a routine of their own."""
    leading: list[Assign] = []
    for statement in unit.root.body:
        if isinstance(statement, Assign) and not any(_leaves(unit, node) for node in walk(statement)):
            leading.append(statement)
        elif not isinstance(statement, Define | Label):
            break
    return Routine(None, tuple(leading), "header", None, unit.root.nested, frozenset())


def _leaves(unit: Unit, node: Node) -> bool:
    if isinstance(node, Run) or timed_builtin(unit.root, node):
        return True
    if not isinstance(node, Call) or not isinstance(node.function, Name):
        return False
    callee = unit.root.find(node.function.name)
    return callee is not None and callee.symbol in unit.timed
