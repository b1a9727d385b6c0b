"""Expressions of the script become expressions of Python."""

from __future__ import annotations

import ast

from . import nodes as n
from .catalogue import Builtin, catalogue
from .emit import at, call, constant, delegate, load, runtime
from .errors import ScriptError
from .scope import Routine, Unit

BOOLEAN = frozenset({"==", "!=", "<", ">", "<=", ">=", "and", "or", "xor"})
OPERATORS = {
    "+": "o_add",
    "-": "o_sub",
    "*": "o_mul",
    "/": "o_div",
    "%": "o_mod",
    "==": "o_eq",
    "!=": "o_ne",
    "<": "o_lt",
    ">": "o_gt",
    "<=": "o_le",
    ">=": "o_ge",
    "xor": "o_xor",
}


class Expressions:
    """Translates the expressions of one routine.

    Attributes:
        builtins: names of the built-in functions that were met.

    """

    def __init__(self, unit: Unit, routine: Routine) -> None:
        self.unit = unit
        self.routine = routine
        self.builtins: set[str] = set()

    def variable(self, name: str) -> str:
        """Give the Python name of a variable as this routine sees it."""
        is_global = name in self.unit.globals and name not in self.routine.locals
        return f"g_{name}" if is_global else f"v_{name}"

    def value(self, node: n.Expression) -> ast.expr:
        """Give the Python expression with the value of a script expression."""
        return at(node, self._value(node))

    def condition(self, node: n.Expression) -> ast.expr:
        """Give the same, refused at run time unless it is True or False."""
        value = self.value(node)
        return value if _is_boolean(node) else at(node, call("o_truth", value))

    def _value(self, node: n.Expression) -> ast.expr:
        if isinstance(node, n.Literal):
            return constant(node.value)
        if isinstance(node, n.Name):
            return load(self.variable(node.name))
        if isinstance(node, n.Binary):
            return self._binary(node)
        if isinstance(node, n.Unary):
            return self._unary(node)
        if isinstance(node, n.Call):
            return self._call(node)
        if isinstance(node, n.Index):
            name = "o_at" if len(node.indices) == 1 else "o_at2"
            return call(name, self.value(node.base), *map(self.value, node.indices))
        return self._rarer(node)

    def _rarer(self, node: n.Expression) -> ast.expr:
        if isinstance(node, n.ListDisplay):
            items = ast.Tuple(elts=[self.value(item) for item in node.items], ctx=ast.Load())
            return call("Array", items)
        if isinstance(node, n.PoseDisplay):
            return call("o_pose", *map(self.value, node.items))
        if isinstance(node, n.Member):
            return call("o_member", self.value(node.base), constant(node.name))
        assert isinstance(node, n.Run)
        thread = self.routine.find(node.thread)
        if thread is None or thread.define is None or thread.define.kind != "thread":
            raise ScriptError(f"no thread is called {node.thread!r}", node.line, node.column, "no-thread")
        return call(runtime("run"), load(thread.symbol), constant(node.thread))

    def _binary(self, node: n.Binary) -> ast.expr:
        """Walk down the spine of a chain `a + b + c`, which keeps long sums off the stack."""
        spine = [node]
        while isinstance(spine[-1].left, n.Binary):
            spine.append(spine[-1].left)
        result, boolean = self.value(spine[-1].left), _is_boolean(spine[-1].left)
        for part in reversed(spine):
            result = at(part, self._combine(part, result, boolean))
            boolean = part.operator in BOOLEAN
        return result

    def _combine(self, node: n.Binary, left: ast.expr, boolean: bool) -> ast.expr:
        if node.operator in ("and", "or"):
            test = left if boolean else at(node, call("o_truth", left))
            operator: ast.boolop = ast.And() if node.operator == "and" else ast.Or()
            return ast.BoolOp(op=operator, values=[test, self.condition(node.right)])
        return call(OPERATORS[node.operator], left, self.value(node.right))

    def _unary(self, node: n.Unary) -> ast.expr:
        if node.operator == "not":
            return ast.UnaryOp(op=ast.Not(), operand=self.condition(node.operand))
        if isinstance(node.operand, n.Literal) and isinstance(node.operand.value, float):
            return constant(-node.operand.value if node.operator == "-" else node.operand.value)
        negated = call("o_neg", self.value(node.operand))
        return negated if node.operator == "-" else call("o_neg", at(node, negated))

    def _call(self, node: n.Call) -> ast.expr:
        if isinstance(node.function, n.Member):
            target = self.value(node.function.base)
            return call("o_method", target, constant(node.function.name), *self._positional(node))
        name = node.function.name
        if name == "struct" and self.routine.find(name) is None:
            return self._struct(node)
        routine = self.routine.find(name)
        if routine is not None:
            return self._call_routine(node, routine)
        builtin = catalogue().get(name)
        if builtin is None:
            raise ScriptError(f"no function is called {name!r}", node.line, node.column, "no-function")
        return self._call_builtin(node, builtin)

    def _call_routine(self, node: n.Call, routine: Routine) -> ast.expr:
        define = routine.define
        if define is None or define.kind == "thread":
            reason = f"{define.name if define else '?'!r} is a thread; start it with `run`"
            raise ScriptError(reason, node.line, node.column, "thread-call")
        formals = [(p.name, p.default) for p in define.parameters]
        given = self._bound(node, [name for name, _ in formals])
        arguments = []
        for name, default in formals:
            expression = given.get(name, default)
            if expression is None:
                raise _missing(node, define.name, name)
            arguments.append(self.value(expression))
        called = call(routine.symbol, *arguments)
        return delegate(at(node, called)) if routine.symbol in self.unit.timed else called

    def _call_builtin(self, node: n.Call, builtin: Builtin) -> ast.expr:
        self.builtins.add(builtin.name)
        given = self._bound(node, [formal.name for formal in builtin.parameters])
        arguments: list[ast.expr] = []
        for position, formal in enumerate(builtin.parameters):
            if formal.name in given:
                arguments.append(self.value(given[formal.name]))
            elif formal.optional:
                arguments.append(load(f"d_{builtin.name}_{position}"))
            else:
                raise _missing(node, builtin.name, formal.name)
        if not builtin.timed:
            return call(f"b_{builtin.name}", *arguments)
        if builtin.name == "sync":
            return ast.Yield(value=None)
        if builtin.name == "sleep":
            return ast.Yield(value=call(runtime("sleep"), *arguments))
        way = "motion" if builtin.motion else "wait"
        return delegate(call(runtime(way), load(f"b_{builtin.name}"), *arguments))

    def _bound(self, node: n.Call, formals: list[str]) -> dict[str, n.Expression]:
        """Arguments under the parameters' names."""
        given: dict[str, n.Expression] = {}
        if len(node.arguments) > len(formals):
            reason = f"{len(node.arguments)} arguments, but it takes {len(formals)}"
            raise ScriptError(reason, node.line, node.column, "argument-count")
        for position, argument in enumerate(node.arguments):
            name = argument.name or formals[position]
            if name not in formals or name in given:
                problem = "given twice" if name in given else "not one of its parameters"
                raise ScriptError(
                    f"argument {name!r} is {problem}", argument.line, argument.column, "argument-name"
                )
            given[name] = argument.value
        return given

    def _positional(self, node: n.Call) -> list[ast.expr]:
        return [self.value(argument.value) for argument in node.arguments]

    def _struct(self, node: n.Call) -> ast.expr:
        pairs: list[ast.expr] = []
        for argument in node.arguments:
            if argument.name is None:
                reason = "struct takes named members: struct(a=1, b=2)"
                raise ScriptError(reason, argument.line, argument.column, "argument-name")
            pair: list[ast.expr] = [constant(argument.name), self.value(argument.value)]
            pairs.append(ast.Tuple(elts=pair, ctx=ast.Load()))
        return call("Struct", ast.Tuple(elts=pairs, ctx=ast.Load()))


def _is_boolean(node: n.Expression) -> bool:
    if isinstance(node, n.Literal):
        return isinstance(node.value, bool)
    if isinstance(node, n.Unary):
        return node.operator == "not"
    return isinstance(node, n.Binary) and node.operator in BOOLEAN


def _missing(node: n.Call, function: str, parameter: str) -> ScriptError:
    reason = f"{function} needs its argument {parameter!r}"
    return ScriptError(reason, node.line, node.column, "argument-count")
