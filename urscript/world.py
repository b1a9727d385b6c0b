"""What the program sees and moves: the controller's side of the instructions."""

# ruff: noqa: D102 - a method do_NAME is the instruction NAME of the script manual

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from functools import partial
from typing import Any, Protocol

from .catalogue import catalogue
from .dialect import STEP
from .errors import Fault
from .registers import Registers
from .strings import to_str
from .values import Array, Value

Motion = Generator[None, None, Value]
"""A timed instruction under way: each `yield` lets one controller step pass; the value comes at the end.

When the thread is killed the generator is closed, so `finally:` is where an interrupted motion is tidied up.
"""

HOME = (0.0, -1.57, 1.57, -1.57, -1.57, 0.0)
ZEROS = Array((0.0,) * 6)


class World(Protocol):
    """Anything a Machine can run a program against."""

    def instruction(self, name: str) -> Callable[..., Any] | None:
        """Give the implementation of a built-in function, or None.

        It is called with all parameters of builtins.toml in order, None for those without a published
        default, and returns a value; lists and arrays are converted. Timed instructions may return a `Motion`
        instead. It raises `Fault` to stop the program.
        """

    def step(self) -> None:
        """One controller step of 2 ms has passed."""


class IdleWorld(Registers):
    """A robot standing still, with registers, outputs and messages, and no socket that answers.

    A method `do_NAME` is the instruction NAME; subclasses add more. A motion without such a method is noted
    in `motions` and takes its argument `t` in seconds, or `motion_steps` steps; a setting without such a
    method is noted in `settings`.

    Args:
        q: joint positions in rad.
        motion_steps: steps that a motion without duration takes.

    Attributes:
        messages: what textmsg and popup said.
        motions: name and arguments of every motion begun.
        settings: the latest arguments of every setting made.
        sent: socket name and payload of everything sent.
        frame: steps passed.
        freedrive: whether freedrive is on.
        payload: mass at the flange that is set, kg.

    """

    def __init__(self, q: Sequence[float] = HOME, motion_steps: int = 1) -> None:
        super().__init__()
        self.q = Array(float(value) for value in q)
        self.motion_steps = motion_steps
        self.messages: list[str] = []
        self.motions: list[tuple[str, tuple[Value, ...]]] = []
        self.settings: dict[str, tuple[Value, ...]] = {}
        self.sent: list[tuple[str, Value]] = []
        self.frame = 0
        self.freedrive = False
        self.payload = 0.0

    def step(self) -> None:
        """One controller step of 2 ms has passed."""
        self.frame += 1

    def instruction(self, name: str) -> Callable[..., Any] | None:
        """Give the method `do_NAME`, else a motion or setting that has no effect, or None."""
        builtin = catalogue().get(name)
        own: Callable[..., Any] | None = getattr(self, f"do_{name}", None)
        if own is not None or builtin is None:
            return own
        if builtin.motion:
            return partial(self.move, name)
        return partial(self.set, name) if builtin.returns == "none" else None

    def set(self, name: str, *arguments: Value) -> None:
        """Note a setting."""
        self.settings[name] = arguments

    def move(self, name: str, *arguments: Value) -> Motion:
        """Make a motion that is noted and takes time.

        Raises:
            Fault: freedrive is on.

        """
        if self.freedrive:
            raise Fault(f"{name} while freedrive is on; call end_freedrive_mode() first", "freedrive")
        self.motions.append((name, arguments))
        names = [formal.name for formal in catalogue()[name].parameters]
        duration = arguments[names.index("t")] if "t" in names else None
        timed = isinstance(duration, int | float) and duration > 0
        for _ in range(round(duration / STEP) if timed else self.motion_steps):  # type: ignore[operator]
            yield
        return None

    # sensing

    def do_get_steptime(self) -> float:
        return STEP

    def do_get_actual_joint_positions(self) -> Array:
        return self.q

    def do_get_target_joint_positions(self) -> Array:
        return self.q

    def do_get_actual_joint_speeds(self) -> Array:
        return ZEROS

    def do_get_target_joint_speeds(self) -> Array:
        return ZEROS

    def do_is_steady(self) -> bool:
        return True

    def do_get_target_payload(self) -> float:
        return self.payload

    # freedrive

    def do_freedrive_mode(self, axes: Value, feature: Value) -> None:
        self.freedrive = True

    def do_end_freedrive_mode(self) -> None:
        self.freedrive = False

    def do_get_freedrive_status(self) -> int:
        return int(self.freedrive)

    # messages and sockets

    def do_textmsg(self, s1: Value, s2: Value) -> None:
        self.messages.append(to_str(s1) + to_str(s2))

    def do_popup(self, s: Value, title: Value, warning: Value, error: Value, blocking: Value) -> None:
        self.do_textmsg(s, "")

    def do_socket_open(self, address: Value, port: Value, name: Value) -> bool:
        return False

    def do_socket_close(self, name: Value) -> None:
        return None

    def do_socket_send_string(self, text: Value, name: Value) -> bool:
        self.sent.append((str(name), text))
        return True

    do_socket_send_line = do_socket_send_string
    do_socket_send_int = do_socket_send_string
    do_socket_send_byte = do_socket_send_string
