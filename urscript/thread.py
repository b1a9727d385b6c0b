"""One thread of a running program, and its share of the frame."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass, field

from .dialect import STEP
from .values import Value

STEP_NS = round(STEP * 1e9)
"""A frame in nanoseconds; whole numbers so that 250 steps are exactly half a second."""

Body = Generator[int | None, None, Value]
"""Yields the nanoseconds it consumes, or None for the rest of the frame; 0 only hands over."""


@dataclass(slots=True, eq=False)
class Thread:
    """State of a thread.

    Attributes:
        left: physical time left in this frame, in ns.
        debt: time that a sleep still takes from the frames to come, in ns.
        ops: operations executed in this frame.
        turn: when it ran last; the longest waiting goes first among equals.
        critical: depth of enter_critical.

    """

    handle: int
    name: str
    body: Body
    parent: Thread | None
    left: int = STEP_NS
    debt: int = 0
    ops: int = 0
    turn: int = 0
    critical: int = 0
    alive: bool = True
    children: list[Thread] = field(default_factory=list)

    def begin_frame(self) -> None:
        """Begin a frame: its physical time, less what a sleep still takes."""
        self.ops = 0
        self.left = max(0, STEP_NS - self.debt)
        self.debt = max(0, self.debt - STEP_NS)

    def consume(self, time: int | None) -> None:
        """Take physical time, this frame's first."""
        if time is None:
            self.left = 0
            return
        self.debt += max(0, time - self.left)
        self.left = max(0, self.left - time)

    def family(self) -> list[Thread]:
        """Give the thread and all it started, directly or not."""
        return [self, *(member for child in self.children for member in child.family())]
