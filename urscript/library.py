"""The built-in functions that only compute; script manual e-Series 5.11, ch. 14."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Mapping

from .arithmetic import whole
from .dialect import Dialect
from .errors import Fault
from .matrices import inverse, size, transpose
from .poses import (
    interpolate_pose,
    number,
    point_dist,
    pose_add,
    pose_dist,
    pose_inv,
    pose_sub,
    pose_trans,
    rotvec2rpy,
    rpy2rotvec,
)
from .strings import STRINGS
from .values import Array, Pose, Value, spoken

Function = Callable[..., Value]


def library(dialect: Dialect) -> Mapping[str, Function]:
    """Give the functions under their names."""
    generator = random.Random(dialect.seed)
    return {
        **PURE,
        **STRINGS,
        "random": lambda: generator.random(),
        "floor": lambda f: _rounded(math.floor, f, dialect),
        "ceil": lambda f: _rounded(math.ceil, f, dialect),
    }


def _periodic(function: Callable[[float], float]) -> Function:
    def apply(f: Value) -> float:
        x = f if type(f) is float else number(f)
        return function(x) if math.isfinite(x) else math.nan

    return apply


def _arc(name: str, function: Callable[[float], float]) -> Function:
    def apply(f: Value) -> float:
        x = number(f)
        if not -1.0 <= x <= 1.0:
            raise Fault(f"{name} of {x}, outside -1 to 1", "domain")
        return function(x)

    return apply


def _rounded(function: Callable[[float], int], f: Value, dialect: Dialect) -> int:
    x = number(f)
    if not math.isfinite(x):
        raise Fault(f"{x} has no integer part", "domain")
    return whole(function(x), dialect)


def sqrt(f: Value) -> float:
    """Square root.

    Raises:
        Fault: of a negative number.

    """
    x = number(f)
    if x < 0:
        raise Fault(f"sqrt of {x}", "domain")
    return math.sqrt(x)


def log(b: Value, f: Value) -> float:
    """Logarithm of f to the base b.

    Raises:
        Fault: b or f is not positive, or b is 1.

    """
    base, x = number(b), number(f)
    if base <= 0 or x <= 0 or base == 1:
        raise Fault(f"log of {x} to the base {base}", "domain")
    return math.log(x) / math.log(base)


def power(base: Value, exponent: Value) -> float:
    """`pow`: base to the exponent, as C computes it.

    Raises:
        Fault: a negative base with a fractional exponent, or 0 to a negative one.

    """
    b, e = number(base), number(exponent)
    try:
        return math.pow(b, e)
    except OverflowError:
        return -math.inf if b < 0 and e % 2 == 1 else math.inf
    except ValueError:
        raise Fault(f"pow of {b} to {e}", "domain") from None


def norm(a: Value) -> float:
    """Give |a| of a number, Euclidean length of a list, of the position of a pose.

    For a pose the manual gives no example; the root of all six squares is taken.
    """
    if isinstance(a, Array | Pose):
        return math.sqrt(sum(number(item) ** 2 for item in a))
    return math.fabs(number(a))


def normalize(v: Value) -> Array:
    """Give the list with Euclidean length 1.

    Raises:
        Fault: all elements are zero.

    """
    if not isinstance(v, Array):
        raise Fault(f"normalize of {spoken(v)}", "type")
    length = norm(v)
    if length == 0:
        raise Fault("normalize of a zero vector", "divide-by-zero")
    return Array(number(item) / length for item in v)


def length(v: Value) -> int:
    """Count elements, or characters."""
    if isinstance(v, Array | Pose | str):
        return len(v)
    raise Fault(f"length of {spoken(v)}", "type")


def make_list(length: Value, initial_value: Value, capacity: Value = None) -> Array:
    """Give a list of `length` times the same value; the capacity is not used here."""
    count = length
    if not isinstance(count, int) or isinstance(count, bool) or not 0 <= count <= 1_000_000:
        raise Fault("make_list takes a length from 0", "type")
    return Array([initial_value] * count)


def integer_to_binary_list(x: Value) -> Array:
    """32 booleans, least significant first."""
    bits = _integer(x)
    return Array(bool(bits >> i & 1) for i in range(32))


def binary_list_to_integer(l: Value) -> int:  # noqa: E741 - the manual's name
    """Give the integer of up to 32 booleans, least significant first."""
    if not isinstance(l, Array) or len(l) > 32:
        raise Fault("binary_list_to_integer takes a list of up to 32 booleans", "type")
    bits = sum(1 << i for i, bit in enumerate(l) if bit)
    return bits - 2**32 if bits >= 2**31 else bits


def _integer(x: Value) -> int:
    if isinstance(x, bool) or not isinstance(x, int):
        raise Fault(f"expected an integer, got {spoken(x)}", "type")
    return x


def _inv(m: Value) -> Value:
    return pose_inv(m) if isinstance(m, Pose) else inverse(m)


PURE: Mapping[str, Function] = {
    "sin": _periodic(math.sin),
    "cos": _periodic(math.cos),
    "tan": _periodic(math.tan),
    "asin": _arc("asin", math.asin),
    "acos": _arc("acos", math.acos),
    "atan": lambda f: math.atan(number(f)),
    "atan2": lambda x, y: math.atan2(number(x), number(y)),
    "sqrt": sqrt,
    "log": log,
    "pow": power,
    "norm": norm,
    "normalize": normalize,
    "d2r": lambda d: math.radians(number(d)),
    "r2d": lambda r: math.degrees(number(r)),
    "length": length,
    "get_list_length": length,
    "size": size,
    "transpose": transpose,
    "inv": _inv,
    "make_list": make_list,
    "integer_to_binary_list": integer_to_binary_list,
    "binary_list_to_integer": binary_list_to_integer,
    "pose_trans": pose_trans,
    "pose_inv": pose_inv,
    "pose_add": pose_add,
    "pose_sub": pose_sub,
    "pose_dist": pose_dist,
    "point_dist": point_dist,
    "interpolate_pose": interpolate_pose,
    "rotvec2rpy": rotvec2rpy,
    "rpy2rotvec": rpy2rotvec,
}
