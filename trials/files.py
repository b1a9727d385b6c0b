"""Small files of a trial: JSON written whole or not at all, and hashes."""

import hashlib
import json
from pathlib import Path
from typing import Any

from ..errors import InputError


def write_text(path: Path, text: str) -> None:
    """Write a text beside its place and move it there.

    Raises InputError when that cannot be done.
    """
    temporary = path.with_name(f".{path.name}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        temporary.write_text(text, encoding="utf-8", newline="\n")
        temporary.replace(path)
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror}; give another --out") from None


def write_json(path: Path, data: object) -> None:
    """Write JSON; see write_text."""
    write_text(path, json.dumps(data, indent=1) + "\n")


def read_json(path: Path) -> Any:
    """Return a JSON file's content. Raises InputError when it is missing or broken."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}; run the trial again") from None
    except ValueError as error:
        raise InputError(f"{path}: is not JSON ({error}); remove it and run the trial again") from None


def sha256(path: Path) -> str:
    """Return the SHA-256 of a file in hexadecimal digits."""
    return hashlib.sha256(path.read_bytes()).hexdigest()
