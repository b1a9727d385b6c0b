"""The table of built-in functions, and which of them a controller has."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from ..errors import InputError
from .constants import constant
from .nodes import Define
from .parser import parse
from .values import Value


@dataclass(frozen=True, slots=True)
class Formal:
    """A parameter of a built-in function; `default` is None where none is published."""

    name: str
    optional: bool
    default: Value


@dataclass(frozen=True, slots=True)
class Builtin:
    """One function of the controller; see builtins.toml for the columns."""

    name: str
    parameters: tuple[Formal, ...]
    returns: str
    since: str
    x: str
    timed: bool
    motion: bool
    source: str
    certainty: str
    deprecated: str
    deprecated_since: str

    @property
    def required(self) -> int:
        """How many arguments cannot be left out."""
        return sum(not parameter.optional for parameter in self.parameters)


@dataclass(frozen=True, slots=True, order=True)
class Version:
    """A PolyScope version; 5.x is e-Series, 10.x PolyScope X."""

    major: int
    minor: int

    @classmethod
    def parse(cls, text: str) -> Version:
        """From "5.11", "5.11.2" or "10.x" (the newest of 10).

        Raises:
            InputError: no version, or older than 5.4.

        """
        match = re.fullmatch(r"(\d{1,2})\.(\d{1,3}|x)(\.\d+)*", text)
        if match is None:
            raise InputError(
                f"version {text!r} is no PolyScope version; give for example 5.11, 5.23 or 10.11"
            )
        minor = 999 if match[2] == "x" else int(match[2])
        version = cls(int(match[1]), minor)
        if version < cls(5, 4):
            raise InputError(f"PolyScope {text} is not supported; the oldest is 5.4")
        return version

    def has(self, builtin: Builtin) -> bool:
        """Whether this controller knows the function."""
        return self.reached(builtin.since, builtin.x)

    def reached(self, since: str, x: str) -> bool:
        """Whether this is `since` or newer, or `x` or newer on PolyScope X."""
        wanted = x if self.major >= 10 else since
        major, minor = (int(part) for part in wanted.split("."))
        return (self.major, self.minor) >= (major, minor)


@cache
def catalogue() -> Mapping[str, Builtin]:
    """Every known built-in function under its name."""
    text = Path(__file__).with_name("builtins.toml").read_text(encoding="ascii")
    rows = list(_rows(tomllib.loads(text)["chapter"]))
    formals = _signatures({name: row["signature"] for name, row in rows})
    return {name: _builtin(name, formals[name], row) for name, row in rows}


def _rows(chapters: list[dict[str, Any]]) -> Iterator[tuple[str, dict[str, Any]]]:
    for chapter in chapters:
        shared = {key: value for key, value in chapter.items() if key != "functions"}
        for name, entry in chapter["functions"].items():
            yield name, shared | (entry if isinstance(entry, dict) else {"signature": entry})


def _builtin(name: str, parameters: tuple[Formal, ...], row: dict[str, Any]) -> Builtin:
    since = row.get("since", "5.0")
    newer = tuple(int(part) for part in since.split(".")) >= (5, 23)
    return Builtin(
        name=name,
        parameters=parameters,
        returns=row["signature"].rpartition("->")[2].strip(),
        since=since,
        x=row.get("x", "10.11" if newer else "10.0"),
        timed=row.get("timed", False),
        motion=row.get("motion", False),
        source=row["source"],
        certainty=row.get("certainty", "manual"),
        deprecated=row.get("deprecated", ""),
        deprecated_since=row.get("deprecated_since", "5.0"),
    )


def _signatures(signatures: dict[str, str]) -> dict[str, tuple[Formal, ...]]:
    """Signatures are URScript but for `?`, so the parser reads them, all at once."""
    heads = {name: text.rpartition("->")[0].strip() for name, text in signatures.items()}
    text = "\n".join(f"def {name}({head.replace('?', '=None')}): end" for name, head in heads.items())
    defines = (statement for statement in parse(text).body if isinstance(statement, Define))
    return {define.name: tuple(_formals(define)) for define in defines}


def _formals(define: Define) -> Iterator[Formal]:
    for parameter in define.parameters:
        default = None if parameter.default is None else constant(parameter.default)
        yield Formal(parameter.name, parameter.default is not None, default)
