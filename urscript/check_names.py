"""Variables: undeclared, read too early, written where it was not meant, never read."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from .catalogue import catalogue
from .check_framing import RESERVED
from .diagnostics import Context, Diagnostic, error, note, warning
from .nodes import Assign, Define, Name, Node, While, walk
from .scope import Routine, Unit, root_name

Place = tuple[int, int]


def check(context: Context) -> Iterator[Diagnostic]:
    """Every routine on its own, then the definitions."""
    unit = context.unit
    declared = _global_places(unit)
    for routine in unit.routines:
        yield from _reads(unit, routine)
        yield from _parameters(unit, routine)
        yield from _writes(unit, routine, declared)
        yield from _unused(routine)
        yield from _definitions(routine)


def variable_reads(routine: Routine) -> Iterator[Name]:
    """Names that are read as variables: neither called functions nor plain assignment targets."""
    skipped: set[int] = set()
    for node in routine.nodes():
        if isinstance(node, Assign) and isinstance(node.target, Name):
            skipped.add(id(node.target))
        function = getattr(node, "function", None)
        if isinstance(function, Name):
            skipped.add(id(function))
        if isinstance(node, Name) and id(node) not in skipped:
            yield node


def assignments(routine: Routine) -> Iterator[Assign]:
    """Give the assignments of a routine."""
    return (node for node in routine.nodes() if isinstance(node, Assign))


def _reads(unit: Unit, routine: Routine) -> Iterator[Diagnostic]:
    parameters = {p.name for p in routine.define.parameters} if routine.define else set()
    written = {root_name(a.target) for a in assignments(routine) if isinstance(a.target, Name)}
    late = set(_read_before(routine, (written - parameters) & routine.locals))
    for name in variable_reads(routine):
        known = name.name in unit.globals or name.name in parameters or name.name in written
        if not known:
            yield error(
                name, "undeclared", f"variable {name.name!r} is never assigned{_outer_hint(routine, name)}"
            )
        elif id(name) in late:
            yield error(name, "read-early", f"variable {name.name!r} is read before its first assignment")


def _outer_hint(routine: Routine, name: Name) -> str:
    outer = routine.parent
    while outer is not None:
        if name.name in outer.locals:
            return "; functions do not see the locals around them, pass it or make it global"
        outer = outer.parent
    return ""


def _read_before(routine: Routine, names: set[str]) -> Iterator[int]:
    first: dict[str, Place] = {}
    for assign in assignments(routine):
        first.setdefault(root_name(assign.target), _last_place(assign))
    looped = {id(inner) for s in routine.nodes() if isinstance(s, While) for inner in walk(*s.body)}
    for name in variable_reads(routine):
        if name.name in names and (name.line, name.column) <= first[name.name] and id(name) not in looped:
            yield id(name)


def _last_place(assign: Assign) -> Place:
    return max((node.line, node.column) for node in walk(assign))


def _global_places(unit: Unit) -> dict[str, tuple[Place, bool]]:
    """Where each global is first declared, and whether with the word `global`."""
    places: dict[str, tuple[Place, bool]] = {}
    first_level = {id(statement) for statement in unit.root.body}
    for routine in unit.routines:
        for assign in assignments(routine):
            explicit = assign.scope == "global"
            if explicit or (routine is unit.root and id(assign) in first_level):
                name, place = root_name(assign.target), (assign.line, assign.column)
                old_place, old_explicit = places.get(name, (place, False))
                places[name] = min(place, old_place), explicit or old_explicit
    return places


def _parameters(unit: Unit, routine: Routine) -> Iterator[Diagnostic]:
    for parameter in routine.define.parameters if routine.define else ():
        if parameter.name in unit.globals:
            reason = (
                f"parameter {parameter.name!r} has the name of a global; which one counts is not documented"
            )
            yield warning(parameter, "hidden-global", f"{reason}, rename it")


def _writes(unit: Unit, routine: Routine, declared: dict[str, tuple[Place, bool]]) -> Iterator[Diagnostic]:
    first_level = {id(statement) for statement in unit.root.body}
    for assign in assignments(routine):
        name = root_name(assign.target)
        if name.startswith(RESERVED):
            yield error(assign, "reserved-name", f"names that start with {RESERVED} are the controller's own")
        if routine.parent is None:
            if assign.scope == "local" and id(assign) in first_level:
                reason = (
                    f"{name!r} is global all the same: `local` has no effect on the program's first level"
                )
                yield warning(assign, "local-global", reason)
        elif assign.scope == "" and name in unit.globals and name not in routine.locals:
            place, explicit = declared[name]
            if place > (assign.line, assign.column):
                reason = f"{name!r} becomes global only at line {place[0]}; declare it before this function"
                yield warning(assign, "late-global", reason)
            elif not explicit:
                reason = (
                    f"this writes the global {name!r} of line {place[0]}; use `local` or declare it `global`"
                )
                yield warning(assign, "hidden-global", reason)


def _unused(routine: Routine) -> Iterator[Diagnostic]:
    read = {name.name for name in variable_reads(routine)}
    reported: set[str] = set()
    for assign in assignments(routine):
        name = root_name(assign.target)
        if name in routine.locals and name not in read and name not in reported:
            reported.add(name)
            yield note(assign, "unused", f"{name!r} is never read")


def _definitions(routine: Routine) -> Iterator[Diagnostic]:
    defines = [node for node in routine.nodes() if isinstance(node, Define)]
    count = Counter(define.name for define in defines)
    for define in defines:
        if count[define.name] > 1 and routine.nested[define.name].define is define:
            yield error(define, "redefined", f"{define.name!r} is defined {count[define.name]} times")
        if define.name in catalogue():
            yield warning(define, "hidden-builtin", f"{define.name!r} hides the controller's own function")
    for define in defines:
        names = Counter(parameter.name for parameter in define.parameters)
        yield from (_twice(p, p.name) for p in define.parameters if names[p.name] > 1)


def _twice(node: Node, name: str) -> Diagnostic:
    return error(node, "redefined", f"parameter {name!r} appears twice")
