"""Calls: unknown functions, wrong arguments, controllers too old for them, registers out of bounds."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from .catalogue import Builtin, catalogue
from .constants import NotConstant, constant
from .diagnostics import Context, Diagnostic, error, note, warning
from .nodes import Call, Define, Expression, Index, Name, Run
from .registers import SIZES
from .scope import Routine

FIELDBUS = {"float": 24, "integer": 24, "boolean": 64}
"""Below these addresses the output registers are meant for fieldbus and PLC (script manual 5.11, ch. 16)."""


def check(context: Context) -> Iterator[Diagnostic]:
    """Every call and every `run`."""
    for routine in context.unit.routines:
        for node in routine.nodes():
            if isinstance(node, Call) and isinstance(node.function, Name):
                yield from _call(context, routine, node, node.function.name)
            elif isinstance(node, Run):
                yield from _run(routine, node)
            elif (
                isinstance(node, Index)
                and len(node.indices) == 2
                and not context.version.reached("5.9", "10.0")
            ):
                yield error(node, "version", "m[i, j] needs PolyScope 5.9; use m[i][j]")


def _call(context: Context, routine: Routine, node: Call, name: str) -> Iterator[Diagnostic]:
    callee = routine.find(name)
    builtin = catalogue().get(name)
    if callee is not None and callee.define is not None:
        yield from _call_own(node, callee.define)
    elif name == "struct":
        yield note(
            node, "version", "structs exist in newer PolyScope versions only; the first is not published"
        )
    elif builtin is None:
        yield error(node, "no-function", f"no function is called {name!r}{_alternative(name)}")
    else:
        formals = [formal.name for formal in builtin.parameters]
        required = [formal.name for formal in builtin.parameters if not formal.optional]
        yield from _arguments(node, name, formals, required)
        yield from _availability(context, node, builtin)
        yield from _register(node, builtin)


def _call_own(node: Call, define: Define) -> Iterator[Diagnostic]:
    if define.kind == "thread":
        yield error(
            node, "thread-call", f"{define.name!r} is a thread; start it with `h = run {define.name}()`"
        )
        return
    if (define.line, define.column) < (node.line, node.column) < (define.end_line, define.end_column):
        yield warning(
            node, "recursion", f"{define.name!r} calls itself; how deep the controller goes is not published"
        )
    formals = [parameter.name for parameter in define.parameters]
    required = [parameter.name for parameter in define.parameters if parameter.default is None]
    yield from _arguments(node, define.name, formals, required)


def _arguments(
    node: Call, name: str, formals: Sequence[str], required: Sequence[str]
) -> Iterator[Diagnostic]:
    positional = [argument for argument in node.arguments if argument.name is None]
    if len(positional) > len(formals):
        reason = f"{name} takes at most {len(formals)} arguments, not {len(positional)}"
        yield error(node, "argument-count", reason)
        return
    given = set(formals[: len(positional)])
    for argument in node.arguments:
        if argument.name is None:
            continue
        if argument.name not in formals:
            reason = f"{name} has no parameter {argument.name!r}; it has {', '.join(formals) or 'none'}"
            yield error(argument, "argument-name", reason)
        elif argument.name in given:
            yield error(argument, "argument-name", f"{argument.name!r} is given twice")
        given.add(argument.name)
    if missing := [formal for formal in required if formal not in given]:
        yield error(node, "argument-count", f"{name} needs {', '.join(missing)} as well")


def _availability(context: Context, node: Call, builtin: Builtin) -> Iterator[Diagnostic]:
    version = context.version
    if not version.has(builtin):
        wanted = f"PolyScope {builtin.since} (PolyScope X {builtin.x})"
        yield error(
            node, "version", f"{builtin.name} needs {wanted}, the target is {version.major}.{version.minor}"
        )
    elif builtin.deprecated and version.reached(builtin.deprecated_since, "10.0"):
        yield note(node, "deprecated", f"{builtin.name} is deprecated; use {builtin.deprecated}")


def _register(node: Call, builtin: Builtin) -> Iterator[Diagnostic]:
    action, _, rest = builtin.name.partition("_")
    sort = rest.removeprefix("output_").removeprefix("input_").removesuffix("_register")
    if sort not in SIZES or not node.arguments:
        return
    address = _integer(node.arguments[0].value)
    if address is None:
        return
    if not 0 <= address < SIZES[sort]:
        yield error(node, "register", f"{sort} registers are 0 to {SIZES[sort] - 1}, not {address}")
    elif action == "write" and address < FIELDBUS[sort]:
        reason = f"output register {address} is reserved for fieldbus; clients have {FIELDBUS[sort]} and up"
        yield warning(node, "register", reason)


def _integer(expression: Expression) -> int | None:
    try:
        value = constant(expression)
    except NotConstant:
        return None
    return value if isinstance(value, int) and not isinstance(value, bool) else None


def _run(routine: Routine, node: Run) -> Iterator[Diagnostic]:
    callee = routine.find(node.thread)
    if callee is None or callee.define is None:
        yield error(node, "no-thread", f"no thread is called {node.thread!r}")
    elif callee.define.kind != "thread":
        yield error(node, "no-thread", f"{node.thread!r} is a function; `run` starts a `thread`")


def _alternative(name: str) -> str:
    known = {
        "abs": "norm(x) is the absolute value",
        "fabs": "norm(x) is the absolute value",
        "min": "compare with `if`",
        "max": "compare with `if`",
        "sign": "compare with `if`",
        "exp": "pow(2.718281828459045, x)",
        "print": "textmsg(...)",
        "len": "length(...)",
        "str": "to_str(...)",
        "wait": "sleep(seconds)",
        "get_actual_joint_currents": "read_port_register(290 + i) gives mA",
        "get_actual_joint_torques": "get_joint_torques() is UR's estimate of external torque",
    }
    return f"; {known[name]}" if name in known else ""
