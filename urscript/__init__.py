"""The URScript language: parser, checker, interpreter."""

from .catalogue import Builtin, Version, catalogue
from .checker import check
from .diagnostics import Diagnostic
from .dialect import STEP, Dialect
from .errors import Fault, ScriptError, ScriptRuntimeError
from .machine import Frame, Machine
from .parser import parse, parse_program
from .recorded import RecordedWorld
from .run import Functions, run_function
from .values import Array, Pose, Struct, Value, from_python, to_python
from .world import IdleWorld, Motion, World

__all__ = [
    "STEP",
    "Array",
    "Builtin",
    "Diagnostic",
    "Dialect",
    "Fault",
    "Frame",
    "Functions",
    "IdleWorld",
    "Machine",
    "Motion",
    "Pose",
    "RecordedWorld",
    "ScriptError",
    "ScriptRuntimeError",
    "Struct",
    "Value",
    "Version",
    "World",
    "catalogue",
    "check",
    "from_python",
    "parse",
    "parse_program",
    "run_function",
    "to_python",
]
