"""Reading scripts; writing results so that nothing half-written is left behind and nothing old is lost."""

import os
import shutil
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path

from ..errors import InputError


def read_script(file: Path, option: str = "") -> str:
    """Return the text of a URScript file as it stands.

    option: what the file was given with, such as --motion. Raises InputError, naming both, when the file
    cannot be read or is no text.
    """
    named = f"{option} {file}" if option else f"{file}"
    try:
        return file.read_bytes().decode("utf-8")
    except OSError as error:
        raise InputError(f"{named}: {error.strerror or error}; give a readable script file") from None
    except UnicodeDecodeError as error:
        raise InputError(f"{named}: byte {error.start} is no text; give a URScript source file") from None


def check_picture(path: Path | None, option: str = "--plot") -> None:
    """Raise InputError, naming the option, when a name does not end as a picture's that can be drawn."""
    if path and path.suffix.lower() not in (".png", ".svg", ".pdf"):
        raise InputError(f"{option} {path}: give a name that ends in .png, .svg or .pdf")


def write_tree(folder: Path, files: Mapping[str, str], option: str = "--out") -> None:
    """Write text files into a folder: all of them, or none.

    They are written beside the folder first and then moved in, one rename each; other files there
    stay. Raises InputError, naming the option, when the folder cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        staging = Path(tempfile.mkdtemp(prefix=f".{folder.name}.", dir=folder.parent))
    except OSError as error:
        raise InputError(
            f"{option} {folder}: cannot be written: {error.strerror}; nothing was changed"
        ) from None
    try:
        for name, text in files.items():
            (staging / name).write_text(text, encoding="utf-8", newline="\n")
        if not os.access(folder, os.W_OK | os.X_OK):
            raise PermissionError(13, "Permission denied")
        for name in files:
            if (folder / name).is_dir():
                raise IsADirectoryError(21, f"{name} is a folder there")
        for name in files:
            (staging / name).replace(folder / name)
    except OSError as error:
        raise InputError(
            f"{option} {folder}: cannot be written: {error.strerror}; nothing was changed"
        ) from None
    finally:
        shutil.rmtree(staging, ignore_errors=True)


def write_file(path: Path, write: Callable[[Path], object], option: str = "--out") -> None:
    """Let `write` fill a temporary file beside `path`, then rename it into place.

    Raises InputError, naming the option, when that cannot be done; an old file stays whole then.
    """
    temporary = path.with_name(f".{path.stem}.{os.getpid()}{path.suffix}")
    try:
        write(temporary)
        temporary.replace(path)
    except OSError as error:
        raise InputError(f"{option} {path}: cannot be written: {error.strerror}") from None
    finally:
        temporary.unlink(missing_ok=True)
