"""A script becomes a Python code object, and that a namespace of functions bound to a world."""

from __future__ import annotations

import ast
from collections.abc import Callable, Generator, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from types import CodeType, TracebackType
from typing import Any

from . import elements
from .arithmetic import negative, operators, truth
from .catalogue import Version, catalogue
from .dialect import Dialect
from .elements import retype
from .emit import assign, at, constant
from .errors import Fault, ScriptError, ScriptRuntimeError
from .expressions import OPERATORS
from .library import library
from .nodes import Node
from .parser import parse
from .scope import Unit, header, resolve
from .statements import Statements
from .values import Array, Struct, Value, from_python

FILENAME = "<urscript>"


@dataclass(frozen=True, slots=True)
class Compiled:
    """A script ready to be linked; it can be linked any number of times.

    Attributes:
        code: defines one Python function a routine.
        unit: the resolved script.
        builtins: names of the built-in functions it uses.

    """

    code: CodeType
    unit: Unit
    builtins: frozenset[str]


@lru_cache(maxsize=64)
def compile_script(text: str) -> Compiled:
    """Parse and compile.

    Raises:
        ScriptError: with line and column.

    """
    unit = resolve(parse(text))
    builtins: set[str] = set()
    start = Node(1, 1)
    body: list[ast.stmt] = [at(start, assign(f"kg_{n}", constant(None))) for n in sorted(unit.globals)]
    for routine in (*unit.routines, header(unit)):
        statements = Statements(unit, routine)
        body.append(statements.function())
        builtins |= statements.expressions.builtins
    try:
        code = compile(ast.Module(body=body, type_ignores=[]), FILENAME, "exec")
    except (RecursionError, SyntaxError, MemoryError) as error:
        raise ScriptError("nested too deep for this interpreter; split it up", 1, 1, "nesting") from error
    return Compiled(code, unit, frozenset(builtins))


def link(
    compiled: Compiled,
    runtime: object,
    instruction: Callable[[str], Callable[..., Any] | None],
    dialect: Dialect,
) -> dict[str, Any]:
    """Give a fresh namespace: the compiled functions, their operators, and the built-in functions.

    Args:
        compiled: what to link.
        runtime: what the generated code calls `M`.
        instruction: gives the world's implementation of a built-in function, or None.
        dialect: choices of the language.

    """
    namespace: dict[str, Any] = {
        "M": runtime,
        **_helpers(dialect),
        **_builtins(compiled, instruction, dialect),
    }
    exec(compiled.code, namespace)
    return namespace


def _helpers(dialect: Dialect) -> dict[str, Any]:
    signs = operators(dialect)
    return {
        "Array": Array,
        "Struct": Struct,
        **{name: signs[sign] for sign, name in OPERATORS.items()},
        "o_neg": negative,
        "o_truth": truth,
        "o_at": elements.at,
        "o_at2": elements.at2,
        "o_put": elements.put,
        "o_put2": elements.put2,
        "o_pose": elements.make_pose,
        "o_member": elements.member,
        "o_put_member": elements.put_member,
        "o_method": elements.method,
        "o_retype": lambda held, value, name: retype(held, value, name, dialect),
    }


def _builtins(
    compiled: Compiled, instruction: Callable[[str], Callable[..., Any] | None], dialect: Dialect
) -> Mapping[str, Any]:
    pure = library(dialect)
    version = Version.parse(dialect.version)
    result: dict[str, Any] = {}
    for name in compiled.builtins:
        builtin = catalogue()[name]
        known = (pure.get(name) or _of_world(instruction(name))) if version.has(builtin) else None
        reason = "has no implementation in this world" if version.has(builtin) else _too_new(name, dialect)
        result[f"b_{name}"] = known or _refusal(f"{name} {reason}")
        for position, formal in enumerate(builtin.parameters):
            result[f"d_{name}_{position}"] = formal.default
    return result


def _of_world(function: Callable[..., Any] | None) -> Callable[..., Any] | None:
    """Let worlds return lists and arrays."""
    if function is None:
        return None

    def convert(*arguments: Value) -> Any:
        result = function(*arguments)
        return result if isinstance(result, Generator) else from_python(result)

    return convert


def _too_new(name: str, dialect: Dialect) -> str:
    return f"needs PolyScope {catalogue()[name].since}, this controller has {dialect.version}"


def _refusal(reason: str) -> Callable[..., Value]:
    def refuse(*_: Value) -> Value:
        raise Fault(reason, "not-available")

    return refuse


RUNTIME_ERRORS = (Fault, NameError, RecursionError)


def placed(error: Exception) -> ScriptRuntimeError:
    """Give the error with the line and column of the script where it arose."""
    line, column = 1, 1
    for line_, column_ in _places(error.__traceback__):
        line, column = line_, column_
    if isinstance(error, Fault):
        return ScriptRuntimeError(error.reason, line, column, error.code)
    if isinstance(error, NameError):
        name = (error.name or str(error).split("'")[1]).partition("_")[2]
        return ScriptRuntimeError(
            f"variable {name!r} is read before it is assigned", line, column, "unassigned"
        )
    return ScriptRuntimeError("calls nested too deep", line, column, "recursion")


def _places(traceback: TracebackType | None) -> Iterator[tuple[int, int]]:
    while traceback is not None:
        code = traceback.tb_frame.f_code
        if code.co_filename == FILENAME:
            positions = list(code.co_positions())[traceback.tb_lasti // 2]
            yield positions[0] or 1, (positions[2] or 0) + 1
        traceback = traceback.tb_next
