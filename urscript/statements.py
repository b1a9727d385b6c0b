"""Statements of the script become statements of Python."""

from __future__ import annotations

import ast
from collections.abc import Iterable

from . import nodes as n
from .emit import assign, at, call, charge, constant, delegate, load, over_limit, runtime, same_class
from .errors import ScriptError
from .expressions import Expressions
from .scope import Routine, Unit, root_name, timed_builtin

OPERATIONS = (
    n.Binary | n.Unary | n.Call | n.Index | n.Member | n.Run | n.Assign | n.Handle | n.Command | n.Return
)


class Statements:
    """Translates the body of one routine."""

    def __init__(self, unit: Unit, routine: Routine) -> None:
        self.unit = unit
        self.routine = routine
        self.expressions = Expressions(unit, routine)
        self.is_generator = routine.symbol in unit.timed
        self.guarded = set(_reassigned(routine)) | unit.globals
        self.loops = 0

    def function(self) -> ast.FunctionDef:
        """Give the routine as a Python function, a generator if it may consume controller time."""
        define = self.routine.define
        names = [parameter.name for parameter in define.parameters] if define else []
        body: list[ast.stmt] = [*self._prologue(names), *self.block(self.routine.body, head=1)]
        if self.is_generator:
            # An unreachable yield makes this a generator even if nothing in it waits.
            body += [ast.Return(value=None), ast.Expr(value=ast.Yield(value=None))]
        place = define or (self.routine.body[0] if self.routine.body else n.Node(1, 1))
        arguments = ast.arguments(
            posonlyargs=[],
            args=[ast.arg(arg=f"v_{name}") for name in names],
            kwonlyargs=[],
            kw_defaults=[],
            defaults=[],
        )
        return at(
            place, ast.FunctionDef(name=self.routine.symbol, args=arguments, body=body, decorator_list=[])
        )

    def _prologue(self, parameters: list[str]) -> list[ast.stmt]:
        written = sorted({root_name(s.target) for s in self.routine.nodes() if isinstance(s, n.Assign)})
        shared = [name for name in written if name in self.unit.globals]
        result: list[ast.stmt] = []
        if shared:
            result.append(ast.Global(names=[f"{prefix}_{name}" for name in shared for prefix in ("g", "kg")]))
        for name in sorted(set(written) & self.guarded & self.routine.locals):
            kind: ast.expr = constant(None)
            if name in parameters:
                kind = ast.Attribute(value=load(f"v_{name}"), attr="__class__", ctx=ast.Load())
            result.append(assign(f"kv_{name}", kind))
        return result

    def block(self, body: n.Block, head: int = 0) -> list[ast.stmt]:
        """Statements, with the charge for their operations before each stretch that takes no time.

        Args:
            body: the statements.
            head: operations to charge for entering; if there are any, the budget is checked as well.

        """
        result: list[ast.stmt] = []
        for stretch in _stretches(self.routine, body) or [[]]:
            operations = head + sum(map(_operations, stretch))
            if operations:
                result.append(charge(operations))
            if head:
                result.append(self._limit())
                head = 0
            for statement in stretch:
                result.extend(at(statement, part) for part in self.statement(statement))
        return result or [ast.Pass()]

    def _limit(self) -> ast.stmt:
        over = call(runtime("over"))
        if not self.is_generator:
            return ast.If(test=over_limit(), body=[ast.Expr(value=over)], orelse=[])
        hand_over = ast.Expr(value=ast.Yield(value=constant(0)))
        return ast.If(test=ast.BoolOp(op=ast.And(), values=[over_limit(), over]), body=[hand_over], orelse=[])

    def statement(self, node: n.Statement) -> Iterable[ast.stmt]:
        """Give the Python statements of one statement."""
        if isinstance(node, n.Assign):
            return self._assign(node)
        if isinstance(node, n.Evaluate):
            return [ast.Expr(value=self.expressions.value(node.value))]
        if isinstance(node, n.If):
            return self._conditional(node)
        if isinstance(node, n.While):
            return self._loop(node)
        if isinstance(node, n.Return):
            return [ast.Return(value=self.expressions.value(node.value) if node.value else None)]
        if isinstance(node, n.Handle):
            return self._wait(call(runtime(node.keyword), self.expressions.value(node.value)))
        return self._command(node) if isinstance(node, n.Command) else []

    def _assign(self, node: n.Assign) -> list[ast.stmt]:
        name = root_name(node.target)
        variable = f"g_{name}" if node.scope == "global" else self.expressions.variable(name)
        value = self.expressions.value(node.value)
        if not isinstance(node.target, n.Name):
            return [assign(variable, self._replaced(node.target, value))]
        result: list[ast.stmt] = [assign(variable, value)]
        if name in self.guarded:
            result.append(_keep_type(variable, name))
        return result

    def _replaced(self, target: n.Expression, value: ast.expr) -> ast.expr:
        """Give the new value of the whole variable when one element or member of it is replaced."""
        while not isinstance(target, n.Name):
            assert isinstance(target, n.Index | n.Member)
            base = self.expressions.value(target.base)
            if isinstance(target, n.Member):
                value = call("o_put_member", base, constant(target.name), value)
            else:
                name = "o_put" if len(target.indices) == 1 else "o_put2"
                value = call(name, base, *map(self.expressions.value, target.indices), value)
            value = at(target, value)
            target = target.base
        return value

    def _conditional(self, node: n.If) -> list[ast.stmt]:
        otherwise = self.block(node.otherwise) if node.otherwise else []
        for branch in reversed(node.branches):
            test = self.expressions.condition(branch.condition)
            otherwise = [at(branch, ast.If(test=test, body=self.block(branch.body), orelse=otherwise))]
        return otherwise

    def _loop(self, node: n.While) -> list[ast.stmt]:
        self.loops += 1
        body = self.block(node.body, head=1 + _operations(node))
        self.loops -= 1
        return [ast.While(test=self.expressions.condition(node.condition), body=body, orelse=[])]

    def _command(self, node: n.Command) -> list[ast.stmt]:
        if node.keyword in ("break", "continue"):
            if not self.loops:
                raise ScriptError(
                    f"`{node.keyword}` outside of a loop", node.line, node.column, "outside-loop"
                )
            return [ast.Break() if node.keyword == "break" else ast.Continue()]
        action = call(runtime(node.keyword))
        if node.keyword in ("pause", "halt"):
            return self._wait(action)
        return [ast.Expr(value=action)]

    def _wait(self, action: ast.expr) -> list[ast.stmt]:
        return [ast.Expr(value=delegate(action))]


def _keep_type(variable: str, name: str) -> ast.stmt:
    """Keep the type of the first assignment."""
    held = f"k{variable}"
    first = ast.Compare(left=load(held), ops=[ast.Is()], comparators=[constant(None)])
    cls = ast.Attribute(value=load(variable), attr="__class__", ctx=ast.Load())
    again = assign(variable, call("o_retype", load(held), load(variable), constant(name)))
    decide = ast.If(test=first, body=[assign(held, cls)], orelse=[again])
    return ast.If(test=same_class(variable, held), body=[decide], orelse=[])


def _reassigned(routine: Routine) -> set[str]:
    """Locals that may be assigned more than once: at several places, in a loop, or as parameters."""
    seen = {parameter.name for parameter in (routine.define.parameters if routine.define else ())}
    looped = {id(inner) for s in routine.nodes() if isinstance(s, n.While) for inner in n.walk(*s.body)}
    again = set()
    for node in routine.nodes():
        if isinstance(node, n.Assign):
            name = root_name(node.target)
            if name in seen or id(node) in looped:
                again.add(name)
            seen.add(name)
    return again


def _stretches(routine: Routine, body: n.Block) -> list[list[n.Statement]]:
    """Give the block cut after each statement that may let controller time pass."""
    stretches: list[list[n.Statement]] = [[]]
    for statement in body:
        stretches[-1].append(statement)
        if any(_may_wait(routine, node) for node in n.walk(statement, into_definitions=False)):
            stretches.append([])
    return [stretch for stretch in stretches if stretch]


def _may_wait(routine: Routine, node: n.Node) -> bool:
    return isinstance(node, n.While | n.Handle) or timed_builtin(routine, node)


def _operations(statement: n.Statement) -> int:
    """Operators, calls, element accesses and assignments; of compound statements, the conditions only."""
    if isinstance(statement, n.If):
        roots: tuple[n.Node, ...] = tuple(branch.condition for branch in statement.branches)
    elif isinstance(statement, n.While):
        roots = (statement.condition,)
    elif isinstance(statement, n.Define):
        roots = ()
    else:
        roots = (statement,)
    return sum(isinstance(node, OPERATIONS) for node in n.walk(*roots))
