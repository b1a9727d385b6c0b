"""The robots as data, and their loader."""

from importlib import resources
from pathlib import Path

from ..errors import InputError
from .schema import Joint, Robot
from .toml import nearest, parse, read, sha256

__all__ = ["Joint", "Robot", "load_robot", "robot_names"]


def robot_names() -> list[str]:
    """Return the names of the built-in robots."""
    return sorted(
        f.name.removesuffix(".toml") for f in resources.files(__name__).iterdir() if f.name.endswith(".toml")
    )


def load_robot(name_or_file: str) -> tuple[Robot, str]:
    """Return a robot and the SHA-256 of its file.

    name_or_file: a built-in name such as "ur5e", or the path of a robot file (it ends in .toml).
    Raises InputError: unknown name (with the nearest one), unreadable file, wrong content.
    """
    if name_or_file.endswith(".toml") or "/" in name_or_file:
        return read(Robot, Path(name_or_file))
    names = robot_names()
    if name_or_file not in names:
        raise InputError(
            f"--robot {name_or_file}: no such robot; {nearest(name_or_file, names)} (or give a .toml file)"
        )
    data = resources.files(__name__).joinpath(f"{name_or_file}.toml").read_bytes()
    return parse(Robot, data.decode("utf-8"), f"{name_or_file}.toml"), sha256(data)
