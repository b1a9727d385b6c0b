"""The operators.

Floats are IEEE doubles, combined in source order. Lists combine element by element, a matrix multiplies as in
linear algebra, a number combines with every element (UR article "Linear algebra examples", since 5.9).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from .dialect import Dialect
from .errors import Fault
from .matrices import product
from .values import Array, Value, is_matrix, spoken

Operator = Callable[[Value, Value], Value]

_ORDER: dict[str, Callable[[float, float], bool]] = {
    "<": lambda a, b: a < b,
    ">": lambda a, b: a > b,
    "<=": lambda a, b: a <= b,
    ">=": lambda a, b: a >= b,
}


def whole(value: int, dialect: Dialect) -> int:
    """Give an integer result within 32 bits.

    Raises:
        Fault: beyond, unless the dialect wraps.

    """
    if -(2**31) <= value < 2**31:
        return value
    if dialect.integer_overflow == "wrap":
        return (value + 2**31) % 2**32 - 2**31
    raise Fault("integer overflow: the result does not fit 32 bits", "overflow")


def operators(dialect: Dialect) -> Mapping[str, Operator]:
    """`+ - * / %`, the comparisons and `xor`, under their signs."""
    ordered = {sign: _comparison(sign, compare) for sign, compare in _ORDER.items()}
    equal = {"==": equals, "!=": lambda a, b: not equals(a, b), "xor": lambda a, b: truth(a) is not truth(b)}
    return {**_arithmetic(dialect), **ordered, **equal}


def _arithmetic(dialect: Dialect) -> dict[str, Operator]:
    return {
        "+": _fast_add(_spreading("+", _integral(lambda a, b: a + b, dialect))),
        "-": _fast_subtract(_spreading("-", _integral(lambda a, b: a - b, dialect))),
        "*": _fast_multiply(_spreading("*", _integral(lambda a, b: a * b, dialect))),
        "/": _fast_divide(_spreading("/", _division(dialect))),
        "%": _spreading("%", _remainder),
    }


# The commonest case first: two floats cost one test each and no further call.


def _fast_add(general: Operator) -> Operator:
    def add(a: Value, b: Value) -> Value:
        if type(a) is float and type(b) is float:
            return a + b
        return general(a, b)

    return add


def _fast_subtract(general: Operator) -> Operator:
    def subtract(a: Value, b: Value) -> Value:
        if type(a) is float and type(b) is float:
            return a - b
        return general(a, b)

    return subtract


def _fast_multiply(general: Operator) -> Operator:
    def multiply(a: Value, b: Value) -> Value:
        if type(a) is float and type(b) is float:
            return a * b
        return general(a, b)

    return multiply


def _fast_divide(general: Operator) -> Operator:
    def divide(a: Value, b: Value) -> Value:
        if type(a) is float and type(b) is float and b:
            return a / b
        return general(a, b)

    return divide


def _integral(combine: Callable[[float, float], float], dialect: Dialect) -> Callable[[float, float], float]:
    def apply(a: float, b: float) -> float:
        result = combine(a, b)
        return whole(result, dialect) if isinstance(result, int) else result

    return apply


def _division(dialect: Dialect) -> Callable[[float, float], float]:
    def divide(a: float, b: float) -> float:
        if b == 0:
            raise Fault("divide by zero", "divide-by-zero")
        if dialect.integer_division == "whole" and isinstance(a, int) and isinstance(b, int):
            return whole(math.trunc(a / b), dialect)
        return a / b

    return divide


def _remainder(a: float, b: float) -> float:
    if b == 0:
        raise Fault("divide by zero", "divide-by-zero")
    if isinstance(a, int) and isinstance(b, int):
        return int(math.fmod(a, b))
    return math.fmod(a, b) if math.isfinite(a) else math.nan


def _spreading(sign: str, combine: Callable[[float, float], float]) -> Operator:
    """Numbers directly, lists element by element."""

    def apply(a: Value, b: Value) -> Value:
        if is_number(a) and is_number(b):
            return combine(a, b)  # type: ignore[arg-type]
        if isinstance(a, Array) and is_number(b):
            return Array(apply(item, b) for item in a)
        if isinstance(b, Array) and is_number(a):
            return Array(apply(a, item) for item in b)
        if isinstance(a, Array) and isinstance(b, Array):
            return _lists(sign, apply, a, b)
        hint = "; join strings with str_cat" if isinstance(a, str) or isinstance(b, str) else ""
        raise Fault(f"`{sign}` does not combine {spoken(a)} with {spoken(b)}{hint}", "type")

    return apply


def _lists(sign: str, apply: Operator, a: Array, b: Array) -> Value:
    if is_matrix(a) and sign == "*":
        return product(a, b)
    if is_matrix(a) or is_matrix(b):
        raise Fault(f"`{sign}` of a matrix and a list is not documented; loop over the rows", "type")
    if len(a) != len(b):
        raise Fault(f"`{sign}` of lists of {len(a)} and {len(b)} elements", "length")
    return Array(apply(x, y) for x, y in zip(a, b, strict=True))


def _comparison(sign: str, compare: Callable[[float, float], bool]) -> Operator:
    def apply(a: Value, b: Value) -> bool:
        if is_number(a) and is_number(b):
            return compare(a, b)  # type: ignore[arg-type]
        raise Fault(f"`{sign}` compares numbers, not {spoken(a)} with {spoken(b)}", "type")

    return apply


def equals(a: Value, b: Value) -> bool:
    """`==`: numbers by value, the rest by type and value."""
    if is_number(a) and is_number(b):
        return a == b
    return a.__class__ is b.__class__ and a == b


def negative(a: Value) -> Value:
    """Give `-a` of a number, list or matrix."""
    if type(a) is float or type(a) is int:
        return -a
    if isinstance(a, Array):
        return Array(negative(item) for item in a)
    raise Fault(f"`-` of {spoken(a)}", "type")


def truth(value: Value) -> bool:
    """Take a condition; only True and False are.

    Raises:
        Fault: a number or anything else stands as condition.

    """
    if value is True or value is False:
        return value
    raise Fault(f"a condition is True or False, not {spoken(value)}", "type")


def is_number(value: object) -> bool:
    """Integer or float; True and False are none."""
    return value.__class__ is float or value.__class__ is int
