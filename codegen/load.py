"""Running what was generated: the NumPy module from its text, the C library through the C compiler."""

import ctypes
import importlib.util
import os
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .listing import Listing

#: Flags under which the generated C must compile without a warning.
STRICT_FLAGS = ("-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Wdouble-promotion", "-Werror")


def load_text(text: str, name: str = "generated_observer") -> ModuleType:
    """Return the module of a generated observer.py given as text."""
    module = ModuleType(name)
    exec(compile(text, f"<{name}>", "exec"), module.__dict__)
    return module


def load_file(path: Path) -> ModuleType:
    """Return the module of a generated observer.py on disk.

    Raises InputError when the file is not there or not a generated observer.
    """
    spec = importlib.util.spec_from_file_location(f"observer_{abs(hash(path))}", path)
    if spec is None or spec.loader is None or not path.is_file():
        raise InputError(f"{path}: no generated observer here; run gen-model first")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    if not hasattr(module, "Observer"):
        raise InputError(f"{path}: is not a generated observer")
    return module


def c_compiler() -> str | None:
    """Return the C compiler: $CC, cc or gcc, None when there is none."""
    return os.environ.get("CC") or shutil.which("cc") or shutil.which("gcc")


def compile_c(folder: Path, library: Path, flags: Sequence[str] = ("-O2",)) -> None:
    """Compile observer.c of a generated folder into a shared library.

    Raises RuntimeError with the compiler's words when it complains.
    """
    command = [c_compiler() or "cc", *STRICT_FLAGS, *flags, "-fPIC", "-shared"]
    command += ["-o", str(library), str(folder / "observer.c"), "-lm"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(done.stderr)


class CLibrary:
    """The functions of a compiled observer.c, called by name with arrays of doubles."""

    def __init__(self, library: Path, model_name: str, listings: Mapping[str, Listing]) -> None:
        self._library = ctypes.CDLL(str(library))
        self._name = model_name
        self._listings = listings

    def call(self, function: str, *inputs: Sequence[float]) -> dict[str, NDArray[np.float64]]:
        """Call a generated function; return its outputs by name, shaped."""
        listing = self._listings[function]
        buffers = [(ctypes.c_double * len(x))(*x) for x in inputs]
        results = {k: (ctypes.c_double * len(indices))() for k, (_, indices) in listing.outputs.items()}
        getattr(self._library, f"{self._name}_{function}")(*buffers, *results.values())
        return {k: np.array(results[k]).reshape(shape) for k, (shape, _) in listing.outputs.items()}
