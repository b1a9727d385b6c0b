"""Compile C and C++ and time its functions, all through the same loop."""

import ctypes
import shutil
import subprocess
import sysconfig
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from .subject import Array, States, Subject, Unavailable

FLAGS = ("-O3", "-fPIC", "-shared")
LOOP = Path(__file__).with_name("loop.c")
#: Where wheels such as pin and cmeel-eigen keep headers and libraries.
CMEEL = Path(sysconfig.get_path("purelib")) / "cmeel.prefix"


def compiler(source: Path) -> str:
    """Return gcc or g++ for a source file; Unavailable when it is not installed."""
    name = "gcc" if source.suffix == ".c" else "g++"
    if shutil.which(name) is None:
        raise Unavailable(f"{name} is not installed")
    return name


def compile_library(
    source: Path, library: Path, flags: Sequence[str] = (), link: Sequence[str] = ()
) -> ctypes.CDLL:
    """Compile one file into a shared library and load it.

    Raises Unavailable with the first error of the compiler.
    """
    command = [compiler(source), *FLAGS, *flags, "-o", str(library), str(source), *link, "-lm"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        errors = [line for line in done.stderr.splitlines() if "error" in line] or [done.stderr[:200]]
        raise Unavailable(f"{source.name} does not compile: {errors[0]}")
    return ctypes.CDLL(str(library))


def eigen_folder() -> Path:
    """Return where Eigen's headers are: the wheel's, or the system's."""
    for folder in (CMEEL / "include" / "eigen3", Path("/usr/include/eigen3")):
        if (folder / "Eigen").is_dir():
            return folder
    raise Unavailable("Eigen's headers are not installed: pip install cmeel-eigen")


class Loop:
    """The timing loop, compiled once."""

    def __init__(self, folder: Path) -> None:
        self._library = compile_library(LOOP, folder / "loop.so")

    def subject(
        self,
        name: str,
        library: ctypes.CDLL,
        function: str,
        core: bool = False,
        operations: int | None = None,
    ) -> Subject:
        """Return a native function as a subject; core: it takes temperatures and returns friction too."""
        run = self._library.run_core if core else self._library.run
        run.restype = ctypes.c_double
        address = ctypes.cast(getattr(library, function), ctypes.c_void_p)

        def call(states: States) -> tuple[float, Array, Array]:
            count, dof = states.q.shape
            momentum, beta = np.empty((count, dof)), np.empty((count, dof))
            arrays = [x.ctypes.data_as(ctypes.c_void_p) for x in (states.q, states.qd, momentum, beta)]
            return run(address, dof, count, *arrays), momentum, beta

        return Subject(name, "native", lambda s: call(s)[1:], lambda s: call(s)[0], operations)
