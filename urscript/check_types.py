"""Types, as far as they can be known without running: variables keep the type of their first assignment."""

from __future__ import annotations

from collections.abc import Iterator

from .catalogue import catalogue
from .check_names import assignments
from .diagnostics import Context, Diagnostic, error, warning
from .nodes import (
    Binary,
    Call,
    Expression,
    If,
    Index,
    ListDisplay,
    Literal,
    Name,
    Node,
    PoseDisplay,
    Run,
    Unary,
    While,
)
from .scope import Routine, Unit, root_name
from .values import kind

RETURNS = {
    "bool": "boolean",
    "int": "integer",
    "float": "float",
    "string": "string",
    "list": "list",
    "pose": "pose",
}
NUMBERS = frozenset({"integer", "float"})
COMPARISONS = frozenset({"==", "!=", "<", ">", "<=", ">=", "and", "or", "xor"})
Known = dict[tuple[str, str], tuple[str, int, int]]


def check(context: Context) -> Iterator[Diagnostic]:
    """Look at assignments in the order of the text, then at conditions and operands."""
    known: Known = {}
    for routine in sorted(context.unit.routines, key=lambda r: r.parent is not None):
        yield from _assignments(context.unit, routine, known)
    for routine in context.unit.routines:
        lengths = _lengths(routine)
        for node in routine.nodes():
            yield from _conditions(context.unit, routine, node, known)
            yield from _operands(context.unit, routine, node, known)
            yield from _indices(node, lengths)


def _key(unit: Unit, routine: Routine, name: str, scope: str = "") -> tuple[str, str]:
    shared = scope == "global" or (name in unit.globals and name not in routine.locals)
    return ("", name) if shared else (routine.symbol, name)


def _kind(unit: Unit, routine: Routine, node: Expression, known: Known) -> str:
    """Give the type of an expression, "" where it is not certain."""
    if isinstance(node, Literal):
        return kind(node.value)
    if isinstance(node, ListDisplay):
        return "list"
    if isinstance(node, PoseDisplay):
        return "pose"
    if isinstance(node, Run):
        return "integer"
    if isinstance(node, Name):
        return known.get(_key(unit, routine, node.name), ("", 0, 0))[0]
    if isinstance(node, Call):
        return _returned(routine, node)
    if isinstance(node, Unary):
        return "boolean" if node.operator == "not" else _kind(unit, routine, node.operand, known)
    return _combined(unit, routine, node, known) if isinstance(node, Binary) else ""


def _returned(routine: Routine, node: Call) -> str:
    if not isinstance(node.function, Name) or routine.find(node.function.name) is not None:
        return ""
    builtin = catalogue().get(node.function.name)
    return RETURNS.get(builtin.returns, "") if builtin else ""


def _combined(unit: Unit, routine: Routine, node: Binary, known: Known) -> str:
    operands: set[str] = set()
    top: Expression = node
    while isinstance(top, Binary):  # down the left spine of a chain
        if top.operator in COMPARISONS:
            return "boolean" if top is node else ""
        operands.add(_kind(unit, routine, top.right, known))
        if top.operator == "/":
            operands.add("float")
        top = top.left
    operands.add(_kind(unit, routine, top, known))
    if not operands <= NUMBERS:
        return ""
    return "float" if "float" in operands else "integer"


def _assignments(unit: Unit, routine: Routine, known: Known) -> Iterator[Diagnostic]:
    for assign in assignments(routine):
        if not isinstance(assign.target, Name):
            continue
        name = root_name(assign.target)
        key = _key(unit, routine, name, assign.scope)
        now = _kind(unit, routine, assign.value, known)
        was, line, column = known.get(key, ("", 0, 0))
        if key not in known:
            # A parameter's type is the caller's affair.
            parameters = {p.name for p in routine.define.parameters} if routine.define else set()
            known[key] = ("" if name in parameters else now, assign.line, assign.column)
        elif was and now and was != now:
            if {was, now} <= NUMBERS:
                if was == "integer":
                    reason = f"{name!r} starts as an integer and gets a float at line {assign.line}"
                    first = Node(line, column)
                    yield warning(first, "integer-start", f"{reason}; start it with a decimal point")
            else:
                reason = f"{name!r} is of type {was} since line {line} and cannot become {now}"
                yield error(assign, "type-change", reason)


def _conditions(unit: Unit, routine: Routine, node: Node, known: Known) -> Iterator[Diagnostic]:
    conditions: list[Expression] = []
    if isinstance(node, If):
        conditions = [branch.condition for branch in node.branches]
    elif isinstance(node, While):
        conditions = [node.condition]
    elif isinstance(node, Binary) and node.operator in ("and", "or", "xor"):
        conditions = [node.left, node.right]
    elif isinstance(node, Unary) and node.operator == "not":
        conditions = [node.operand]
    for condition in conditions:
        found = _kind(unit, routine, condition, known)
        if found not in ("", "boolean"):
            yield error(
                condition, "condition", f"a condition is True or False, this is of type {found}; compare it"
            )


def _operands(unit: Unit, routine: Routine, node: Node, known: Known) -> Iterator[Diagnostic]:
    if not isinstance(node, Binary):
        return
    if node.operator in "/%" and isinstance(node.right, Literal) and node.right.value in (0, 0.0):
        if node.right.value is not False:
            yield error(node, "divide-by-zero", "division by zero stops the program")
    elif node.operator in "+-*/%" or node.operator in ("<", ">", "<=", ">="):
        for side in (node.left, node.right):
            found = _kind(unit, routine, side, known)
            if found in ("string", "boolean", "None"):
                hint = "; str_cat joins strings" if found == "string" and node.operator == "+" else ""
                yield error(node, "operand", f"`{node.operator}` does not take a {found}{hint}")
                return


def _lengths(routine: Routine) -> dict[str, int]:
    """Find lists of certain length: every assignment of the whole variable is a list of that length."""
    found: dict[str, set[int]] = {}
    for parameter in routine.define.parameters if routine.define else ():
        found[parameter.name] = {-1}
    for assign in assignments(routine):
        if isinstance(assign.target, Name):
            items = assign.value.items if isinstance(assign.value, ListDisplay | PoseDisplay) else None
            found.setdefault(assign.target.name, set()).add(-1 if items is None else len(items))
    return {name: lengths.pop() for name, lengths in found.items() if len(lengths) == 1 and -1 not in lengths}


def _indices(node: Node, lengths: dict[str, int]) -> Iterator[Diagnostic]:
    if not isinstance(node, Index) or not isinstance(node.base, Name) or len(node.indices) != 1:
        return
    index, length = node.indices[0], lengths.get(node.base.name)
    if length is None or not isinstance(index, Literal) or not isinstance(index.value, int):
        return
    if index.value >= length:
        reason = f"index {index.value} is outside the {length} elements; they count from 0"
        yield error(node, "index", reason)
