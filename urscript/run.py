"""Calling the functions of a script from Python, without threads or time."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Generator
from typing import Any

from .compiler import RUNTIME_ERRORS, compile_script, link, placed
from .dialect import Dialect
from .errors import Fault, ScriptError
from .scope import by_name
from .values import Value, from_python, to_python
from .world import IdleWorld, World


class Untimed:
    """What generated code calls `M` where no time passes: it counts operations, nothing else."""

    def __init__(self) -> None:
        self.ops = 0
        self.limit = 10**12

    def over(self) -> bool:
        """Say that the limit is out of reach."""
        return False

    def enter_critical(self) -> None:
        """Nobody to keep out."""

    def exit_critical(self) -> None:
        """Nobody to let in."""

    def __getattr__(self, name: str) -> Any:
        raise Fault(f"{name} takes controller time or threads; run the program in a Machine", "needs-machine")


class Functions:
    """The functions of a script, callable by name.

    The text is a program or several functions. The assignments that begin a program's first level are
    executed once, so functions find its globals.

    Args:
        text: the script.
        dialect: choices of the language.
        world: answers functions that do more than compute; an `IdleWorld` by default.

    Raises:
        ScriptError: the text is wrong, or its first assignments fail.

    """

    def __init__(self, text: str, dialect: Dialect | None = None, world: World | None = None) -> None:
        self._runtime = Untimed()
        self._dialect = dialect or Dialect()
        compiled = compile_script(text)
        instruction = (world or IdleWorld()).instruction
        self._space = link(compiled, self._runtime, instruction, self._dialect)
        self._routines = by_name(compiled.unit)
        self._guarded(self._space["header"])

    @property
    def operations(self) -> int:
        """Operations executed so far, counted as the machine counts them."""
        return self._runtime.ops

    def call(self, name: str, *arguments: object) -> Any:
        """Call one function with floats, strings, booleans or (nested) lists or arrays.

        Returns:
            Its value; lists and poses as Python lists.

        Raises:
            ScriptRuntimeError: the function stops with an error.
            ScriptError: there is no such function, or it takes another number of arguments.

        """
        routine = self._routines.get(name)
        if routine is None or routine.define is None:
            known = ", ".join(sorted(self._routines)) or "none"
            raise ScriptError(f"no function is called {name!r}; there are {known}", 1, 1, "no-function")
        wanted = len(routine.define.parameters)
        if len(arguments) != wanted:
            reason = f"{name} takes {wanted} arguments, not {len(arguments)}"
            raise ScriptError(reason, routine.define.line, routine.define.column, "argument-count")
        return to_python(self._guarded(self._space[routine.symbol], *map(from_python, arguments)))

    def _guarded(self, function: Callable[..., Any], *arguments: Value) -> Value:
        try:
            result = function(*arguments)
            return _exhausted(result) if inspect.isgenerator(result) else result
        except RUNTIME_ERRORS as error:
            raise placed(error) from error


def _exhausted(generator: Generator[Any, Any, Any]) -> Value:
    """Give the value of a generator that never waits."""
    try:
        next(generator)
    except StopIteration as stop:
        return stop.value  # type: ignore[no-any-return]
    generator.throw(Fault("this takes controller time; run the program in a Machine", "needs-machine"))
    raise AssertionError("the generated code swallowed a fault")


def run_function(text: str, name: str, *arguments: object, dialect: Dialect | None = None) -> Any:
    """Call one function of a script; see `Functions`, which saves the linking when calling often.

    Example:
        >>> run_function("def double(x): return 2.0 * x end", "double", 4.0)
        8.0

    """
    return Functions(text, dialect).call(name, *arguments)
