"""Reading and replacing elements, and what an assignment may do to a variable's type."""

from __future__ import annotations

from .dialect import Dialect
from .errors import Fault
from .values import KINDS, Array, Pose, Struct, Value, spoken, with_article


def at(base: Value, index: Value) -> Value:
    """`base[index]`, counted from 0.

    Raises:
        Fault: no list, no whole number, or outside.

    """
    if type(index) is int and isinstance(base, tuple):
        if 0 <= index < len(base):
            element: Value = base[index]
            return element
        raise Fault(f"index {index} is outside a list of {len(base)}", "index")
    if isinstance(base, tuple):
        raise Fault(f"an index is an integer, not {spoken(index)}", "index")
    raise Fault(f"{spoken(base)} has no elements", "type")


def at2(base: Value, row: Value, column: Value) -> Value:
    """`base[row, column]` of a matrix."""
    return at(at(base, row), column)


def put(base: Value, index: Value, value: Value) -> Value:
    """Give `base` with one element replaced; a list keeps its length."""
    at(base, index)
    assert isinstance(base, Array | Pose)  # at() refuses everything else
    position = int(index)  # type: ignore[arg-type]
    return base.__class__((*base[:position], value, *base[position + 1 :]))


def put2(base: Value, row: Value, column: Value, value: Value) -> Value:
    """Give `base` with one matrix element replaced."""
    return put(base, row, put(at(base, row), column, value))


def member(base: Value, name: str) -> Value:
    """`base.name`."""
    if not isinstance(base, Struct):
        raise Fault(f"{spoken(base)} has no members", "type")
    return base.get(name)


def put_member(base: Value, name: str, value: Value) -> Value:
    """Give `base` with one member replaced."""
    if not isinstance(base, Struct):
        raise Fault(f"{spoken(base)} has no members", "type")
    return base.put(name, value)


def make_pose(*items: Value) -> Pose:
    """`p[...]` of six numbers."""
    for item in items:
        if item.__class__ is not float and item.__class__ is not int:
            raise Fault(f"a pose holds numbers, not {spoken(item)}", "type")
    return Pose(items)


def retype(held: type, value: Value, name: str, dialect: Dialect) -> Value:
    """Give the value as a variable of type `held` takes it.

    A variable keeps the type of its first assignment (script manual 5.11, ch. 3). Integer and float are both
    "number" there: an integer given to a float variable becomes a float, and a float given to an integer
    variable is refused only by a dialect with `strict_numbers`.

    Raises:
        Fault: the types do not agree.

    """
    if held is float and value.__class__ is int:
        return float(value)
    if held is int and value.__class__ is float and not dialect.strict_numbers:
        return value
    was, now = with_article(KINDS.get(held, held.__name__)), spoken(value)
    raise Fault(f"variable {name!r} holds {was} and cannot become {now}", "type-change")


def method(base: Value, name: str, *arguments: Value) -> Value:
    """`base.name(...)`: lists of newer versions have methods; of these only `length()` is certain."""
    if name == "length" and not arguments and isinstance(base, Array):
        return len(base)
    raise Fault(f"{spoken(base)} has no method {name!r} here", "not-available")
