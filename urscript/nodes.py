"""The syntax tree: frozen values, each with its line and column (from 1) in the text."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import Literal as OneOf


@dataclass(frozen=True, slots=True)
class Node:
    """Anything in the tree."""

    line: int
    column: int


@dataclass(frozen=True, slots=True)
class Expression(Node):
    """Something with a value."""


@dataclass(frozen=True, slots=True)
class Statement(Node):
    """Something that is executed."""


@dataclass(frozen=True, slots=True)
class Literal(Expression):
    """A number, string, True, False or None."""

    value: float | int | bool | str | None


@dataclass(frozen=True, slots=True)
class Name(Expression):
    """A variable, or the function of a call."""

    name: str


@dataclass(frozen=True, slots=True)
class ListDisplay(Expression):
    """`[a, b]`; rows of equal length make a matrix."""

    items: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class PoseDisplay(Expression):
    """`p[x, y, z, rx, ry, rz]`, metres and rotation vector."""

    items: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class Index(Expression):
    """`base[i]` or, for a matrix, `base[i, j]`."""

    base: Expression
    indices: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class Member(Expression):
    """`base.name` of a struct."""

    base: Expression
    name: str


@dataclass(frozen=True, slots=True)
class Argument(Node):
    """One argument of a call; `name` is None when it is positional."""

    name: str | None
    value: Expression


@dataclass(frozen=True, slots=True)
class Call(Expression):
    """`function(arguments)`; the function is a Name, or a Member for a method."""

    function: Name | Member
    arguments: tuple[Argument, ...]


@dataclass(frozen=True, slots=True)
class Unary(Expression):
    """`-a`, `+a`, `not a`."""

    operator: str
    operand: Expression


@dataclass(frozen=True, slots=True)
class Binary(Expression):
    """`left operator right`; line and column are those of the operator."""

    operator: str
    left: Expression
    right: Expression


@dataclass(frozen=True, slots=True)
class Run(Expression):
    """`run name()`: starts a thread, its value is the handle."""

    thread: str


Block = tuple[Statement, ...]


@dataclass(frozen=True, slots=True)
class Assign(Statement):
    """`[local|global] target = value`."""

    scope: OneOf["", "local", "global"]
    target: Name | Index | Member
    value: Expression


@dataclass(frozen=True, slots=True)
class Evaluate(Statement):
    """A call (or `run`) whose value is dropped."""

    value: Call | Run


@dataclass(frozen=True, slots=True)
class Branch(Node):
    """`if` or `elif` with its block."""

    condition: Expression
    body: Block


@dataclass(frozen=True, slots=True)
class If(Statement):
    """`if ... elif ... else ... end`; without `else`, `otherwise` is empty."""

    branches: tuple[Branch, ...]
    otherwise: Block


@dataclass(frozen=True, slots=True)
class While(Statement):
    """`while condition: body end`."""

    condition: Expression
    body: Block


@dataclass(frozen=True, slots=True)
class Return(Statement):
    """`return value`; the value is None only for a bare `return` before the end of its block."""

    value: Expression | None


@dataclass(frozen=True, slots=True)
class Command(Statement):
    """One of the keywords break, continue, halt, pause, enter_critical, exit_critical."""

    keyword: str


@dataclass(frozen=True, slots=True)
class Handle(Statement):
    """`join handle` or `kill handle`."""

    keyword: str
    value: Expression


@dataclass(frozen=True, slots=True)
class Label(Statement):
    """`$ number "text"`, the trace of the program tree; does nothing."""

    number: int
    text: str


@dataclass(frozen=True, slots=True)
class Parameter(Node):
    """A parameter of a function, with its default if it has one."""

    name: str
    default: Expression | None


@dataclass(frozen=True, slots=True)
class Define(Statement):
    """`def`, `thread` or `sec` with the place of its `end`."""

    kind: OneOf["def", "thread", "sec"]
    name: str
    parameters: tuple[Parameter, ...]
    body: Block
    end_line: int
    end_column: int


@dataclass(frozen=True, slots=True)
class Script:
    """A whole text: usually one Define, the program."""

    body: Block


_PARTS: dict[type[Node], tuple[str, ...]] = {}


def _parts(cls: type[Node]) -> tuple[str, ...]:
    """Names of the fields that can hold nodes; looking them up anew for every node is most of a walk."""
    if cls not in _PARTS:
        _PARTS[cls] = tuple(f.name for f in fields(cls) if f.type not in ("int", "str", "str | None"))
    return _PARTS[cls]


def children(node: Node) -> Iterator[Node]:
    """Give the nodes directly below, in source order."""
    for name in _parts(type(node)):
        value = getattr(node, name)
        if isinstance(value, Node):
            yield value
        elif isinstance(value, tuple):
            yield from (item for item in value if isinstance(item, Node))


def walk(*roots: Node, into_definitions: bool = True) -> Iterator[Node]:
    """Give the nodes of the trees in source order, without recursion.

    Args:
        roots: where to start.
        into_definitions: False leaves out what lies inside nested functions and threads
            (the Define itself is still given).

    """
    stack = list(reversed(roots))
    while stack:
        node = stack.pop()
        yield node
        if into_definitions or not isinstance(node, Define):
            stack.extend(reversed(list(children(node))))
