"""The seal: hashes of all truths, written before the first answer and checked before scoring."""

from pathlib import Path

from ..errors import InputError
from .files import sha256, write_text


def seal(out: Path) -> Path:
    """Write out/seal.txt over all of out/sealed, or check it when it stands there.

    Raises InputError when a sealed file differs from its seal.
    """
    path = out / "seal.txt"
    if path.exists():
        check(out)
    else:
        write_text(path, _lines(out))
    return path


def check(out: Path) -> None:
    """Raise InputError unless every sealed file is what it was when it was sealed."""
    path = out / "seal.txt"
    if not path.exists():
        raise InputError(f"{path}: is missing: these truths were never sealed; generate and answer first")
    if path.read_text(encoding="utf-8") != _lines(out):
        raise InputError(
            f"{path}: the files in {out / 'sealed'} are not those that were sealed; use a new --out"
        )


def _lines(out: Path) -> str:
    files = sorted((out / "sealed").glob("[0-9]*.json"))
    return "".join(f"{sha256(file)}  sealed/{file.name}\n" for file in files)
