"""The values a program computes with.

Python's float, int, bool, str and None stand for themselves. Lists, poses and structs are frozen, so the rule
"passed by value, arrays included" (script manual 5.11, ch. 6) holds by itself: an element assignment makes a
new value and puts it into the one variable.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

from .errors import Fault


class Array(tuple[Any, ...]):
    """A list; a matrix is a list of rows of equal length."""

    __slots__ = ()


class Pose(tuple[Any, ...]):
    """`p[x, y, z, rx, ry, rz]` in m and rad (rotation vector)."""

    __slots__ = ()


@dataclass(frozen=True, slots=True)
class Struct:
    """Members in the order of their declaration; newer PolyScope versions only."""

    members: tuple[tuple[str, Value], ...]

    def get(self, name: str) -> Value:
        """Give the member called `name`.

        Raises:
            Fault: there is none.

        """
        for key, value in self.members:
            if key == name:
                return value
        raise Fault(f"the struct has no member {name!r}", "member")

    def put(self, name: str, value: Value) -> Struct:
        """Give a copy with one member replaced; members cannot be added."""
        self.get(name)
        return Struct(tuple((key, value if key == name else old) for key, old in self.members))


Value: TypeAlias = float | int | bool | str | Array | Pose | Struct | None

KINDS: dict[type, str] = {
    float: "float",
    int: "integer",
    bool: "boolean",
    str: "string",
    type(None): "None",
    Array: "list",
    Pose: "pose",
    Struct: "struct",
}


def kind(value: object) -> str:
    """Give the type's name as messages have it."""
    return KINDS.get(value.__class__, value.__class__.__name__)


def spoken(value: object) -> str:
    """Give the type with its article, for messages."""
    return with_article(kind(value))


def with_article(name: str) -> str:
    """Put the article before a type name: "an integer", "a list", "None"."""
    if name == "None":
        return name
    return f"{'an' if name[0] in 'aeiou' else 'a'} {name}"


def from_python(value: object) -> Value:
    """Make lists of the language from lists, tuples and arrays, plain numbers from NumPy scalars.

    Raises:
        TypeError: anything the language has no value for.

    """
    if isinstance(value, Array | Pose | Struct | bool | int | float | str) or value is None:
        return value if type(value) in KINDS else _plain(value)
    tolist = getattr(value, "tolist", None)
    if tolist is not None:
        return from_python(tolist())
    if isinstance(value, list | tuple):
        return Array(from_python(item) for item in value)
    raise TypeError(f"URScript has no value for a {type(value).__name__}")


def _plain(value: object) -> Value:
    for base in (bool, int, float, str):
        if isinstance(value, base):
            return base(value)
    raise TypeError(f"URScript has no value for a {type(value).__name__}")


def to_python(value: Value) -> Any:
    """Make Python lists of lists and poses, dictionaries of structs; the rest stays."""
    if isinstance(value, tuple):
        return [to_python(item) for item in value]
    if isinstance(value, Struct):
        return {name: to_python(item) for name, item in value.members}
    return value


def is_matrix(value: Value) -> bool:
    """Whether this is a list of lists of one length."""
    return (
        isinstance(value, Array)
        and len(value) > 0
        and all(isinstance(row, Array) and len(row) == len(value[0]) for row in value)
    )
