"""The dashboard's language: a line in, a line out.

Answers as UR's client library expects them (src/ur/dashboard_client_implementation_g5.cpp).
"""

from collections.abc import Callable

from .arm import IDLE, POWER_OFF, RUNNING
from .controller import Controller

GREETING = "Connected: Universal Robots Dashboard Server"
MODES = {RUNNING: "RUNNING", IDLE: "IDLE", POWER_OFF: "POWER_OFF"}
SERIAL = "20195500000"


class Dashboard:
    """Answers for one controller."""

    def __init__(self, controller: Controller) -> None:
        self._controller = controller
        self._answers: dict[str, Callable[[], str]] = {
            "play": self._play,
            "stop": self._stop,
            "pause": self._pause,
            "running": lambda: f"Program running: {str(self._program == 'playing').lower()}",
            "robotmode": lambda: f"Robotmode: {MODES[controller.arm.mode]}",
            "get loaded program": lambda: (
                f"Loaded program: {controller.loaded}" if controller.loaded else "No program loaded"
            ),
            "close popup": lambda: "closing popup",
            "close safety popup": lambda: "closing safety popup",
            "programState": lambda: f"{self._program.upper()} {controller.programs.name or 'unnamed.urp'}",
            "isProgramSaved": lambda: f"true {controller.loaded or 'unnamed.urp'}",
            "PolyscopeVersion": lambda: "URSoftware {}.{}.{}.{} (Jan 01 2025)".format(*controller.version),
            "version": lambda: "{}.{}.{}.{}".format(*controller.version),
            "power on": lambda: self._power(True),
            "power off": lambda: self._power(False),
            "brake release": self._release,
            "unlock protective stop": self._unlock,
            "restart safety": lambda: "Restarting safety",
            "safetymode": lambda: f"Safetymode: {self._safety}",
            "safetystatus": lambda: f"Safetystatus: {self._safety}",
            "is in remote control": lambda: "true",
            "get serial number": lambda: SERIAL,
            "get robot model": lambda: controller.robot.name.upper().removesuffix("E"),
            "get operational mode": lambda: "NONE",
            "clear operational mode": lambda: "operational mode is no longer controlled by Dashboard Server",
            "shutdown": lambda: "Shutting down",
            "quit": lambda: "Disconnected",
        }

    def answer(self, line: str) -> str:
        """Return the answer to one line."""
        line = line.strip()
        if line in self._answers:
            return self._answers[line]()
        word, _, rest = line.partition(" ")
        if word == "load" and rest:
            self._controller.loaded = rest
            return f"Loading program: {rest}"
        if word == "popup":
            return "showing popup"
        if word == "addToLog":
            self._controller.say(f"log: {rest}")
            return "Added log message"
        if line.startswith("set operational mode "):
            return f"Operational mode '{line.rsplit(' ', 1)[1]}' is set"
        return f'could not understand: "{line[:200]}"'

    def knows(self, line: str) -> bool:
        """Whether a line at a script port is one of the commands that are obeyed there too."""
        return line in (
            "power on",
            "power off",
            "set robotmode run",
            "set unlock protective stop",
            "stop program",
        )

    def obey(self, line: str) -> None:
        """Carry out a command of a script port."""
        names = {"set robotmode run": "brake release", "stop program": "stop"}
        self.answer(names.get(line, line.removeprefix("set ")))

    @property
    def _program(self) -> str:
        return self._controller.programs.state

    @property
    def _safety(self) -> str:
        return "PROTECTIVE_STOP" if self._controller.arm.protective_stop else "NORMAL"

    def _play(self) -> str:
        return "Starting program" if self._controller.programs.play() else "Failed to execute: play"

    def _stop(self) -> str:
        self._controller.programs.stop()
        return "Stopped"

    def _pause(self) -> str:
        return "Pausing program" if self._controller.programs.pause() else "Failed to execute: pause"

    def _power(self, on: bool) -> str:
        self._controller.power(on)
        return "Powering on" if on else "Powering off"

    def _release(self) -> str:
        self._controller.release_brakes()
        return "Brake releasing"

    def _unlock(self) -> str:
        if self._controller.arm.unlock():
            return "Protective stop releasing"
        return (
            "Cannot unlock protective stop until 5s after occurrence. "
            "Always inspect cause of protective stop before unlocking"
        )
