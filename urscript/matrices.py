"""Linear algebra of lists of rows; since PolyScope 5.9 (UR article "Linear algebra examples")."""

from __future__ import annotations

import numpy as np

from .errors import Fault
from .values import Array, Value, is_matrix, spoken


def product(a: Array, b: Array) -> Array:
    """Matrix times matrix, or matrix times vector.

    Raises:
        Fault: inner dimensions differ.

    """
    if len(a[0]) != len(b):
        raise Fault(f"matrix of {len(a[0])} columns times {len(b)} rows", "length")
    if not is_matrix(b):
        return Array(_dot(row, b) for row in a)
    columns = list(zip(*b, strict=True))
    return Array(Array(_dot(row, column) for column in columns) for row in a)


def _dot(row: tuple[float, ...], column: tuple[float, ...]) -> float:
    total = row[0] * column[0]
    for x, y in zip(row[1:], column[1:], strict=True):
        total = total + x * y
    return total


def transpose(m: Value) -> Value:
    """Rows become columns; a list becomes a column and a column a list."""
    if not isinstance(m, Array) or not m:
        raise Fault(f"transpose of {spoken(m)}", "type")
    if not is_matrix(m):
        return Array(Array((item,)) for item in m)
    if len(m[0]) == 1:
        return Array(row[0] for row in m)
    return Array(Array(column) for column in zip(*m, strict=True))


def inverse(m: Value) -> Value:
    """Inverse of a square matrix.

    Raises:
        Fault: not square, or singular.

    """
    if not isinstance(m, Array) or not is_matrix(m) or len(m) != len(m[0]):
        raise Fault("inv takes a pose or a square matrix", "type")
    try:
        rows = np.linalg.inv(np.array(m, dtype=float)).tolist()
    except (np.linalg.LinAlgError, ValueError, TypeError) as error:
        raise Fault("the matrix has no inverse", "math") from error
    return Array(Array(row) for row in rows)


def size(m: Value) -> Value:
    """[rows, columns] of a matrix; the length of a list."""
    if isinstance(m, Array) and is_matrix(m):
        return Array((len(m), len(m[0])))
    if isinstance(m, tuple):
        return len(m)
    raise Fault(f"size of {spoken(m)}", "type")
