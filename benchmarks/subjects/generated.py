"""The code that gen-model writes: C, one state at a time, and NumPy, many at a time."""

import re
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from types import CodeType, ModuleType

import numpy as np

from residuum.codegen.load import load_file

from .native import Loop, compile_library
from .subject import States, Subject

GEN_MODEL = (sys.executable, "-c", "from residuum.cli.gen_model import main; main()")


@dataclass(frozen=True)
class Generated:
    """A folder that gen-model wrote, and the operations that it counted."""

    folder: Path
    operations: int


def generate(robot: str, dof: int, folder: Path) -> Generated:
    """Run gen-model; nothing can be compared without it."""
    command = [*GEN_MODEL, "--dof", str(dof), "--robot", robot, "--out", str(folder)]
    done = subprocess.run(command, check=False, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"gen-model --dof {dof} --robot {robot} failed:\n{done.stderr}")
    (operations,) = re.findall(r"momentum and beta in (\d+) operations", done.stdout)
    return Generated(next(folder.glob(f"*_dof{dof}")), int(operations))


def native(generated: Generated, loop: Loop) -> list[Subject]:
    """Return the generated C: momentum and beta alone, and the whole core (its friction is zero here)."""
    folder = generated.folder
    library = compile_library(folder / "observer.c", folder / "observer.so", ("-std=c99",))
    return [
        loop.subject(f"residuum C, {words}", library, f"{folder.name}_{function}", core, generated.operations)
        for words, function, core in (
            ("momentum and beta", "momentum_and_beta", False),
            ("core", "core", True),
        )
    ]


def trigonometry(generated: Generated, loop: Loop) -> Subject:
    """Return the C library's sines and cosines alone, as many as the generated C takes."""
    text = (generated.folder / "observer.c").read_text()
    body = text.split("_momentum_and_beta(", 1)[1].split("\n}", 1)[0]
    angles = len(set(re.findall(r"\b(?:sin|cos)\((\w+)\)", body)))
    lines = [f"momentum[{i}] = sin(q[{i}]); beta[{i}] = cos(q[{i}]);" for i in range(angles)]
    source = generated.folder / "trigonometry.c"
    arguments = "const double *q, const double *qd, double *momentum, double *beta"
    source.write_text(
        "\n".join(["#include <math.h>", f"void trigonometry({arguments})", "{", "(void)qd;", *lines, "}"])
    )
    library = compile_library(source, source.with_suffix(".so"), ("-std=c99",))
    found = loop.subject(f"(sine and cosine of {angles} angles alone)", library, "trigonometry")
    return replace(found, operations=2 * angles, whole=False)


def numpy(generated: Generated) -> list[Subject]:
    """Return the generated NumPy: `momentum` then `beta`, and the core, which gives both in one go."""
    module = load_file(generated.folder / "observer.py")
    core = _core(module)
    dof = module.DOF

    def separate(s: States) -> tuple[np.ndarray, np.ndarray]:
        return module.momentum(s.q, s.qd), module.beta(s.q, s.qd)

    def together(s: States) -> tuple[np.ndarray, np.ndarray]:
        values = core(s)
        return values[:, :dof], values[:, dof : 2 * dof]

    return [
        Subject("residuum NumPy, core, random states", "numpy", together, _timed(core)),
        Subject("residuum NumPy, core, along a motion", "motion", together, _timed(core)),
        Subject("residuum NumPy, momentum and beta", "numpy", separate, _timed(separate)),
    ]


def _core(module: ModuleType) -> Callable[[States], np.ndarray]:
    """Return what `Observer.run` evaluates: one pass that gives momentum, beta and friction."""
    code = module._core.__code__
    used = []
    for name in code.co_varnames[: code.co_argcount - 1]:  # the last is the work arrays
        letters, number = re.fullmatch(r"([a-z]+)(\d)", name).groups()
        used.append((("q", "qd", "temperature").index(letters), int(number) - 1))
    hot, work = module.REFERENCE_TEMPERATURE, _work_arrays(code)
    return lambda s: module._apply(module._core, used, 3 * module.DOF, s.q, s.qd, hot, work=work)


def _work_arrays(code: CodeType) -> int:
    return sum(re.fullmatch(r"b\d+", name) is not None for name in code.co_varnames)


def _timed(function: Callable[[States], object]) -> Callable[[States], float]:
    def time_it(states: States) -> float:
        start = time.thread_time_ns()
        function(states)
        return (time.thread_time_ns() - start) / len(states.q)

    return time_it
