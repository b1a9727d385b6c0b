"""What a figure was measured on, and how a process stays on one core."""

import os
import platform
import subprocess
from collections.abc import Iterable
from importlib import metadata
from pathlib import Path


def stay_on_one_core() -> None:
    """Keep this process on one core, where the system lets it."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})


def description(packages: Iterable[str] = ()) -> dict[str, str]:
    """Return processor, compiler, C library, Python and the versions of packages that are installed."""
    found = {
        "processor": f"{_processor()}, {os.cpu_count()} cores",
        "system": " ".join((platform.system(), platform.machine(), *platform.libc_ver())),
        "compiler": _first_line("gcc", "--version"),
        "python": platform.python_version(),
    }
    for name in packages:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            found[name] = "not installed"
    return found


def _processor() -> str:
    names = Path("/proc/cpuinfo")
    if names.exists():
        fields = dict(
            (part.strip() for part in line.split(":", 1))
            for line in names.read_text().splitlines()
            if ":" in line
        )
        number = (
            f" (family {fields['cpu family']}, model {fields['model']})" if "cpu family" in fields else ""
        )
        if "model name" in fields:
            return fields["model name"] + number
    return platform.processor() or platform.machine()


def _first_line(*command: str) -> str:
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()[0]
    except (OSError, subprocess.CalledProcessError):
        return f"{command[0]}: not found"


def as_text(about: dict[str, str]) -> str:
    """Return one line a fact."""
    return "\n".join(f"{name}: {value}" for name, value in about.items())
