"""Small constructors for Python's own syntax tree, each placed where the script's node stands.

Python keeps line and column of every operation in its code objects. Giving it those of the script makes the
place of a runtime error available without any cost while the program runs.
"""

from __future__ import annotations

import ast
from typing import TypeVar

from .nodes import Node

_Tree = TypeVar("_Tree", bound=ast.stmt | ast.expr)


def at(node: Node, tree: _Tree) -> _Tree:
    """Place the tree, and what in it has no place yet, at the script's node."""
    stack: list[ast.AST] = [tree]
    while stack:
        part = stack.pop()
        if hasattr(part, "lineno"):
            continue
        if isinstance(part, ast.stmt | ast.expr | ast.arg | ast.keyword):
            part.lineno = part.end_lineno = node.line
            part.col_offset = part.end_col_offset = node.column - 1
        stack.extend(ast.iter_child_nodes(part))
    return tree


def load(name: str) -> ast.Name:
    """Read a Python variable."""
    return ast.Name(id=name, ctx=ast.Load())


def store(name: str) -> ast.Name:
    """Write a Python variable."""
    return ast.Name(id=name, ctx=ast.Store())


def call(function: ast.expr | str, *arguments: ast.expr) -> ast.Call:
    """Call a Python function, given by expression or name."""
    callee = load(function) if isinstance(function, str) else function
    return ast.Call(func=callee, args=list(arguments), keywords=[])


def runtime(attribute: str) -> ast.Attribute:
    """Give an attribute of the runtime `M`."""
    return ast.Attribute(value=load("M"), attr=attribute, ctx=ast.Load())


def constant(value: float | int | bool | str | None) -> ast.Constant:
    """Give a literal."""
    return ast.Constant(value=value)


def delegate(generator: ast.expr) -> ast.YieldFrom:
    """Run something that consumes controller time."""
    return ast.YieldFrom(value=generator)


def assign(name: str, value: ast.expr) -> ast.Assign:
    """`name = value`."""
    return ast.Assign(targets=[store(name)], value=value)


def same_class(name: str, held: str) -> ast.Compare:
    """`name.__class__ is held`."""
    cls = ast.Attribute(value=load(name), attr="__class__", ctx=ast.Load())
    return ast.Compare(left=cls, ops=[ast.IsNot()], comparators=[load(held)])


def charge(operations: int) -> ast.AugAssign:
    """`M.ops += operations`."""
    target = ast.Attribute(value=load("M"), attr="ops", ctx=ast.Store())
    return ast.AugAssign(target=target, op=ast.Add(), value=constant(operations))


def over_limit() -> ast.Compare:
    """`M.ops > M.limit`."""
    return ast.Compare(left=runtime("ops"), ops=[ast.Gt()], comparators=[runtime("limit")])
