"""The string functions; script manual e-Series 5.11, ch. 14. Positions count from 0."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping

from .errors import Fault
from .values import Pose, Struct, Value, spoken

_NUMBER = re.compile(r"\s*[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?\s*")


def to_str(val: Value) -> str:
    """How the controller prints a value: floats with at most 6 decimals, so no place for exact numbers."""
    if isinstance(val, bool) or val is None or isinstance(val, str):
        return str(val)
    if isinstance(val, int):
        return str(val)
    if isinstance(val, float):
        return f"{val:.6f}".rstrip("0").rstrip(".") if abs(val) < 1e15 else f"{val:g}"
    if isinstance(val, Struct):
        return "struct(" + ", ".join(f"{name}={to_str(item)}" for name, item in val.members) + ")"
    return ("p" if isinstance(val, Pose) else "") + "[" + ", ".join(to_str(item) for item in val) + "]"


def to_num(text: Value) -> float | int:
    """Give the number a string spells.

    Raises:
        Fault: it spells none.

    """
    plain = _text(text)
    if _NUMBER.fullmatch(plain) is None:
        raise Fault(f"to_num of {plain[:40]!r}", "type")
    return int(plain) if re.fullmatch(r"\s*[+-]?\d{1,9}\s*", plain) else float(plain)


def str_cat(op1: Value, op2: Value) -> str:
    """Both, the second as `to_str` prints it."""
    return _text(op1) + to_str(op2)


def str_at(src: Value, index: Value) -> str:
    """One character.

    Raises:
        Fault: outside the string.

    """
    text, position = _text(src), _position(index)
    if not 0 <= position < len(text):
        raise Fault(f"index {position} is outside a string of {len(text)}", "index")
    return text[position]


def str_sub(src: Value, index: Value, length: Value = -1) -> str:
    """`length` characters from `index`; without a length, the rest.

    Raises:
        Fault: outside the string.

    """
    text, start, count = _text(src), _position(index), _position(length)
    if not 0 <= start <= len(text):
        raise Fault(f"index {start} is outside a string of {len(text)}", "index")
    return text[start:] if count < 0 else text[start : start + count]


def str_find(src: Value, target: Value, start_from: Value = 0) -> int:
    """Where the target begins, or -1."""
    return _text(src).find(_text(target), max(0, _position(start_from)))


def _text(value: Value) -> str:
    if not isinstance(value, str):
        raise Fault(f"expected a string, got {spoken(value)}", "type")
    return value


def _position(value: Value) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise Fault(f"expected an integer, got {spoken(value)}", "type")
    return value


STRINGS: Mapping[str, Callable[..., Value]] = {
    "to_str": to_str,
    "to_num": to_num,
    "str_cat": str_cat,
    "str_at": str_at,
    "str_sub": str_sub,
    "str_find": str_find,
    "str_len": lambda str: len(_text(str)),
    "str_empty": lambda str: not _text(str),
}
