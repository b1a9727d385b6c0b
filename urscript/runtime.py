"""What the generated code calls `M`: threads, time and the operation budget."""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import Any

from .dialect import Dialect
from .errors import Fault
from .poses import number
from .thread import Body, Thread
from .values import Value, from_python

MAX_THREADS = 100
TOO_MUCH_TIME = (
    "The program used too much time without instructing the robot what to do. Consider using a Wait or sync()"
)


class Halted(Exception):  # noqa: N818 - no error: `halt` was executed
    """The program reached `halt`."""


class Runtime:
    """Threads of one running program.

    Attributes:
        ops: operations of the running thread in this frame; generated code adds to it.
        limit: beyond it generated code calls `over`.
        paused: `pause` was executed.
        threads: the living ones, the program first.

    """

    def __init__(self, dialect: Dialect) -> None:
        self.dialect = dialect
        self.ops = 0
        self.limit = 0
        self.paused = False
        self.threads: list[Thread] = []
        self._current: Thread | None = None
        self._mover: Thread | None = None
        self._all: dict[int, Thread] = {}
        self._ended: list[Thread] = []
        self._turn = 0

    # for the machine

    def start(self, function: Callable[[], Body], name: str) -> Thread:
        """Start a thread, a child of the running one; it may run in this frame."""
        if len(self.threads) >= MAX_THREADS:
            raise Fault(f"more than {MAX_THREADS} threads", "threads")
        thread = Thread(len(self._all) + 1, name, function(), self._current)
        if self._current is not None:
            self._current.children.append(thread)
        self._all[thread.handle] = thread
        self.threads.append(thread)
        return thread

    def next_thread(self) -> Thread | None:
        """Give the one with the largest share of the frame left, or None at the frame's end."""
        ready = [thread for thread in self.threads if thread.left > 0]
        return min(ready, key=lambda thread: (-thread.left, thread.turn), default=None)

    def resume(self, thread: Thread) -> None:
        """Let it run until it consumes time, hands over or ends."""
        self._turn += 1
        thread.turn = self._turn
        self._current, self.ops = thread, thread.ops
        self._set_limit(thread)
        try:
            thread.consume(next(thread.body))
        except StopIteration:
            self._end(thread)
        finally:
            thread.ops = self.ops
            self._current = None
        if not thread.alive:
            thread.body.close()

    def operations(self) -> dict[str, int]:
        """Operations of this frame by thread; several threads of one name are added up."""
        result: dict[str, int] = {}
        for thread in (*self.threads, *self._ended):
            result[thread.name] = result.get(thread.name, 0) + thread.ops
        self._ended.clear()
        return result

    def kill_all(self) -> None:
        """End every thread."""
        for thread in tuple(self.threads):
            self._end(thread)

    def _set_limit(self, thread: Thread) -> None:
        budget, share = self.dialect.budget, self.dialect.slice
        self.limit = budget if share is None or thread.critical else min(budget, self.ops + share)

    def _end(self, thread: Thread) -> None:
        for member in thread.family():
            member.alive = False
            if member in self.threads:
                self.threads.remove(member)
                self._ended.append(member)
            if self._mover is member:
                self._mover = None
            if member is not self._current:
                member.body.close()

    # for the generated code

    def over(self) -> bool:
        """Whether to hand over to other threads.

        Raises:
            Fault: the budget of the frame is used up.

        """
        if self.ops > self.dialect.budget:
            raise Fault(TOO_MUCH_TIME, "too-much-time")
        assert self._current is not None
        if self._current.critical:
            self.limit = self.dialect.budget
            return False
        return True

    def sleep(self, seconds: Value) -> int:
        """Nanoseconds of a `sleep`.

        Raises:
            Fault: not a number, or negative.

        """
        duration = number(seconds)
        if not 0 <= duration < 1e9:
            raise Fault(f"sleep of {duration} s", "domain")
        return round(duration * 1e9)

    def run(self, function: Callable[[], Body], name: str) -> int:
        """`run`: the new thread's handle."""
        return self.start(function, name).handle

    def kill(self, handle: Value) -> Body:
        """`kill`: ends the thread and its children; 0 and ended threads are ignored."""
        thread = self._thread(handle)
        if thread is not None:
            self._end(thread)
        if self._current is not None and not self._current.alive:
            yield None
        return None

    def join(self, handle: Value) -> Body:
        """`join`: waits for a thread that the running one started.

        Raises:
            Fault: somebody else's thread.

        """
        thread = self._thread(handle)
        if thread is not None and thread.parent is not self._current:
            raise Fault("only the thread that started it can join a thread", "join")
        while thread is not None and thread.alive:
            yield None
        return None

    def motion(self, function: Callable[..., Any], *arguments: Value) -> Body:
        """Run a motion; only one thread may move the robot at a time.

        Raises:
            Fault: another thread is moving it.

        """
        if self._mover is not None:
            raise Fault("Another thread is already controlling the robot", "second-motion")
        self._mover = self._current
        try:
            return (yield from self.wait(function, *arguments))
        finally:
            self._mover = None

    def wait(self, function: Callable[..., Any], *arguments: Value) -> Body:
        """Run a timed instruction of the world."""
        result = function(*arguments)
        if isinstance(result, Generator):
            result = from_python((yield from result))
        return result  # type: ignore[no-any-return]

    def pause(self) -> Body:
        """`pause`: nothing runs until the machine is resumed."""
        self.paused = True
        yield None
        return None

    def halt(self) -> Body:
        """`halt`: the program ends."""
        raise Halted
        yield None

    def enter_critical(self) -> None:
        """Other threads wait until `exit_critical`, unless a timed instruction comes between."""
        assert self._current is not None
        self._current.critical += 1
        self.limit = self.dialect.budget

    def exit_critical(self) -> None:
        """End a critical section.

        Raises:
            Fault: there is none.

        """
        assert self._current is not None
        if not self._current.critical:
            raise Fault("exit_critical without enter_critical", "critical")
        self._current.critical -= 1
        self._set_limit(self._current)

    def _thread(self, handle: Value) -> Thread | None:
        if handle == 0 and not isinstance(handle, bool):
            return None
        if isinstance(handle, bool) or not isinstance(handle, int) or handle not in self._all:
            raise Fault(f"{handle!r} is no thread handle", "handle")
        return self._all[handle]
