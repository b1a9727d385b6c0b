"""Values that stand in the text."""

from __future__ import annotations

from .nodes import Expression, ListDisplay, Literal, PoseDisplay, Unary
from .values import Array, Pose, Value


class NotConstant(ValueError):  # noqa: N818 - it says what the expression is, not what went wrong
    """The expression needs a program to run."""


def constant(expression: Expression) -> Value:
    """Give the value of a literal, a signed number, or a list or pose of such.

    Raises:
        NotConstant: it is something else.

    """
    if isinstance(expression, Literal):
        return expression.value
    if isinstance(expression, ListDisplay):
        return Array(constant(item) for item in expression.items)
    if isinstance(expression, PoseDisplay):
        return Pose(constant(item) for item in expression.items)
    if isinstance(expression, Unary) and expression.operator in "+-":
        value = constant(expression.operand)
        if isinstance(value, int | float) and not isinstance(value, bool):
            return -value if expression.operator == "-" else value
    raise NotConstant(expression)
