"""Runs programs frame by frame: one main program, and secondary programs beside it."""

from collections.abc import Callable

from ...urscript import Dialect, Machine, ScriptError
from ..command import Speed, Stop
from .arm import BRAKING
from .primary import ErrorCode, Failure, Key, Message
from .world import RobotWorld

MOST_SECONDARY = 16


class Programs:
    """The programs of one controller. announce: takes what clients of the primary interface shall know.

    refused, failed: programs that did not start, and that an error stopped, since the start.
    """

    def __init__(self, world: RobotWorld, dialect: Dialect, announce: Callable[[Message], None]) -> None:
        self._world, self._dialect, self._announce = world, dialect, announce
        self._main: Machine | None = None
        self._secondary: list[Machine] = []
        self._text = ""
        self._speed: Speed | None = None
        self.refused = self.failed = 0

    @property
    def state(self) -> str:
        """Whether the main program is stopped, playing or paused."""
        if self._main is None:
            return "stopped"
        return "paused" if self._world.arm.held or self._main.paused else "playing"

    @property
    def name(self) -> str:
        """Name of the running program; empty without one."""
        return self._main.name if self._main else ""

    def start(self, text: str) -> None:
        """Start a program; a new `def` ends the running one, a `sec` does not. What is wrong is announced."""
        try:
            machine = Machine(text, self._world, self._dialect)
        except ScriptError as error:
            self.refused += 1
            self._announce(Failure(error.line, error.column, f"{_kind(error)}: {error.reason}"))
            return
        if not self._world.arm.movable:
            self.refused += 1
            self._announce(ErrorCode(210, 0, f"{machine.name} refused: the robot is not ready to run"))
            return
        if text.startswith("sec"):
            if len(self._secondary) < MOST_SECONDARY:
                self._secondary.append(machine)
            return
        self.stop()
        self._main, self._text = machine, text
        self._announce(Key("STARTED", machine.name))

    def stop(self) -> None:
        """End the main program and everything it asked for."""
        main, self._main = self._main, None
        self._world.arm.held = False
        self._world.watchdogs.clear()
        if main is not None:
            main.stop()
            self._world.arm.release()
            self._announce(Key("STOPPED", main.name))

    def pause(self) -> bool:
        """Hold the main program; its path is left for no instant. False without a program."""
        if self._main is None:
            return False
        self._world.arm.held = True
        return True

    def play(self) -> bool:
        """Go on after a pause, or start the last program again. False when there was none."""
        if self._main is not None:
            self._main.resume()
            self._world.arm.held = False
            if self._speed is not None:
                self._world.arm.command, self._speed = self._speed, None
        elif self._text:
            self.start(self._text)
        return self._main is not None

    def frame(self) -> None:
        """Let 2 ms of all programs pass; errors end their program and are announced."""
        if self._secondary:
            self._secondary = [s for s in self._secondary if self._run(s) and not s.finished]
        main = self._main
        if main is None:
            return
        if (self.state == "paused" and self._world.arm.rate <= 0.0) or main.paused:
            self._hold()
        elif not self._run(main) or main.finished:
            self.stop()

    def _hold(self) -> None:
        arm = self._world.arm
        if isinstance(arm.command, Speed):
            self._speed = arm.command
        arm.command = Stop(BRAKING)

    def _run(self, machine: Machine) -> bool:
        """Run one frame; False when an error stopped the program."""
        try:
            machine.frame()
        except ScriptError as error:
            self._announce(Failure(error.line, error.column, f"Runtime error: {error.reason}"))
        except Exception as error:  # a defect of an instruction must not take the controller down
            self._announce(Failure(1, 1, f"Runtime error: {machine.name}: {type(error).__name__}: {error}"))
        else:
            return True
        self.failed += 1
        return False


def _kind(error: ScriptError) -> str:
    return {"character": "Lexer exception", "syntax": "Syntax error"}.get(error.code, "Compile error")
