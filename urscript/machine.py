"""Runs a program frame by frame, as the controller's scheduler does.

Script manual e-Series 5.11, ch. 9: in each 2 ms frame every thread owns 2 ms of physical time, and the one
with the largest remainder runs first. `sync` uses up what is left of the frame, `sleep` and motions use all
of it and as many frames more as they take. A thread that only computes is stopped with the program.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from .compiler import RUNTIME_ERRORS, compile_script, link, placed
from .dialect import Dialect
from .errors import ScriptError
from .runtime import Halted, Runtime
from .values import to_python
from .world import World


@dataclass(frozen=True, slots=True)
class Frame:
    """What happened in one frame.

    Attributes:
        number: frames run before this one.
        operations: executed operations by thread; the program itself is under its own name.

    """

    number: int
    operations: Mapping[str, int]


class Machine:
    """One program on one controller.

    Args:
        text: a program, `def name(): ... end` or `sec name(): ... end`.
        world: the robot and everything around the program.
        dialect: choices of the language.

    Raises:
        ScriptError: the text is no program.

    Attributes:
        name: of the program.
        finished: the program came to its end, halted or was stopped by an error.
        frames: frames run.

    """

    def __init__(self, text: str, world: World, dialect: Dialect | None = None) -> None:
        compiled = compile_script(text)
        define = compiled.unit.root.define
        if define is None:
            raise ScriptError("a program is one `def name(): ... end`", 1, 1, "framing")
        self.name = define.name
        self.finished = False
        self.frames = 0
        self._world = world
        self._runtime = Runtime(dialect or Dialect())
        self._space = link(compiled, self._runtime, world.instruction, self._runtime.dialect)
        self._globals = compiled.unit.globals
        self._main = self._runtime.start(self._space[compiled.unit.root.symbol], self.name)

    @property
    def globals(self) -> dict[str, Any]:
        """The global variables assigned so far, as Python values."""
        return {n: to_python(self._space[f"g_{n}"]) for n in self._globals if f"g_{n}" in self._space}

    @property
    def threads(self) -> tuple[str, ...]:
        """Names of the living threads, the program first, in the order of their start."""
        return tuple(thread.name for thread in self._runtime.threads)

    @property
    def paused(self) -> bool:
        """Whether a `pause` holds the program."""
        return self._runtime.paused

    def resume(self) -> None:
        """Go on after `pause`."""
        self._runtime.paused = False

    def stop(self) -> None:
        """End the program as a stop button does."""
        self._runtime.kill_all()
        self.finished = True

    def frame(self) -> Frame:
        """Run one frame and let the world make one step.

        Raises:
            ScriptRuntimeError: the program was stopped; the machine is finished then.

        """
        number, operations = self.frames, {}
        if not self.finished and not self.paused:
            operations = self._schedule()
        self.frames += 1
        self._world.step()
        return Frame(number, MappingProxyType(operations))

    def run(self, frames: int) -> int:
        """Run until the program ends, at most so many frames.

        Returns:
            The number of frames run by this call.

        Raises:
            ScriptRuntimeError: the program was stopped.

        """
        for count in range(frames):
            if self.finished:
                return count
            self.frame()
        return frames

    def _schedule(self) -> dict[str, int]:
        for thread in self._runtime.threads:
            thread.begin_frame()
        try:
            while (ready := self._runtime.next_thread()) is not None:
                self._runtime.resume(ready)
                if not self._main.alive:
                    self.stop()
                    break
        except Halted:
            self.stop()
        except RUNTIME_ERRORS as error:
            self.stop()
            raise placed(error) from error
        return self._runtime.operations()
