"""What the checker says."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from .catalogue import Version
from .nodes import Node, Script
from .scope import Unit
from .tokens import Outline

Severity = Literal["error", "warning", "note"]


@dataclass(frozen=True, slots=True, order=True)
class Diagnostic:
    """One remark.

    Attributes:
        line: from 1.
        column: from 1.
        code: stable name of the kind of remark; docs/urscript.md lists them.
        severity: error: the controller refuses or stops the program; warning: it does something else than it
            seems to; note: worth knowing.
        message: what is wrong and what to do.

    """

    line: int
    column: int
    code: str
    severity: Severity
    message: str


@dataclass(frozen=True, slots=True)
class Context:
    """What the single checks look at."""

    text: str
    script: Script
    unit: Unit
    shape: Outline
    version: Version


def error(node: Node, code: str, message: str) -> Diagnostic:
    """Report what the controller refuses or stops."""
    return Diagnostic(node.line, node.column, code, "error", message)


def warning(node: Node, code: str, message: str) -> Diagnostic:
    """Report what the program does differently than it seems."""
    return Diagnostic(node.line, node.column, code, "warning", message)


def note(node: Node, code: str, message: str) -> Diagnostic:
    """Worth knowing."""
    return Diagnostic(node.line, node.column, code, "note", message)
