"""TOML in, checked values out, with one line that names file, line and key when something is wrong."""

import difflib
import hashlib
import re
import tomllib
from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, ValidationError

from ..errors import InputError

Data = TypeVar("Data", bound=BaseModel)


def sha256(data: bytes) -> str:
    """Return the hexadecimal SHA-256 of some bytes."""
    return hashlib.sha256(data).hexdigest()


def parse(kind: type[Data], text: str, file: str) -> Data:
    """Read TOML text into a checked value.

    Raises InputError with file, line and key for a syntax error, a missing, unknown or wrong key.
    """
    try:
        return kind.model_validate(tomllib.loads(text))
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{file}: not valid TOML: {error}") from None
    except ValidationError as error:
        raise InputError(_first_problem(error, text, file)) from None


def read(kind: type[Data], path: Path) -> tuple[Data, str]:
    """Read a TOML file; return the checked value and the SHA-256 of its bytes."""
    try:
        data = path.read_bytes()
        text = data.decode("utf-8")
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: is not UTF-8 text") from None
    return parse(kind, text, str(path)), sha256(data)


def _first_problem(error: ValidationError, text: str, file: str) -> str:
    problem = error.errors()[0]
    location = problem["loc"]
    line = _line_of(location, text)
    message = problem["msg"].removeprefix("Value error, ")
    if problem["type"] == "missing":
        message = "is missing"
    elif problem["type"] == "extra_forbidden":
        message = "is not a known key"
    return f"{file}{f', line {line}' if line else ''}: {_name(location)}: {message}"


def _name(location: tuple[int | str, ...]) -> str:
    """Joints, and the links that they move, are numbered from 1."""
    words: list[str] = []
    for part in location:
        if isinstance(part, int) and words and words[-1] == "joint":
            words[-1] = f"joint {part + 1} (link {part + 1})"
        elif isinstance(part, int):
            words[-1] = f"{words[-1]}[{part}]" if words else str(part)
        else:
            words.append(part)
    return ": ".join(words) or "file"


def _line_of(location: tuple[int | str, ...], text: str) -> int | None:
    """Find the line of a key, or of the table that lacks it; None when it has no line of its own."""
    lines = text.splitlines()
    start, end = 0, len(lines)
    keys = [part for part in location if isinstance(part, str)]
    if len(location) > 1 and isinstance(location[1], int):
        heads = [i for i, line in enumerate(lines) if re.match(rf"\s*\[\[\s*{location[0]}\s*\]\]", line)]
        if location[1] < len(heads):
            start = heads[location[1]]
            end = heads[location[1] + 1] if location[1] + 1 < len(heads) else end
    for key in reversed(keys):
        for i in range(start, end):
            if re.match(rf'\s*"?{re.escape(key)}"?\s*=', lines[i]):
                return i + 1
    return start + 1 if start else None


def nearest(word: str, words: list[str]) -> str:
    """Return `; did you mean X?` for the word that is nearest, or the list of all."""
    close = difflib.get_close_matches(word.lower(), words, n=1, cutoff=0.4)
    return f"did you mean {close[0]}?" if close else f"known: {', '.join(words)}"
