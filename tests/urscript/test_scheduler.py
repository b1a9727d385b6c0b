"""Threads and frames."""

from __future__ import annotations

import time
from itertools import pairwise

import numpy as np
import pytest

from residuum.urscript import Dialect, IdleWorld, Machine, RecordedWorld, ScriptRuntimeError

COUNTER = """
def p():
  global n = 0
  thread count():
    while True:
      n = n + 1
      sync()
    end
  end
  h = run count()
  {body}
end
"""


def finish(text: str, frames: int = 2000, dialect: Dialect | None = None) -> tuple[Machine, IdleWorld, int]:
    world = IdleWorld()
    machine = Machine(text, world, dialect)
    return machine, world, machine.run(frames)


def test_sync_runs_once_per_frame() -> None:
    machine, _, _ = finish(COUNTER.format(body="while True: sync() end"), 100)
    assert machine.globals["n"] == 100


def test_half_a_second_is_250_frames() -> None:
    machine, _, frames = finish(COUNTER.format(body="sleep(0.5)"))
    assert frames == 251
    assert machine.globals["n"] == 250


def test_short_sleeps_share_a_frame() -> None:
    body = "i = 0\n while i < 8:\n sleep(0.0005)\n i = i + 1\n end"
    _, _, frames = finish(COUNTER.format(body=body))
    assert frames == 3


def test_sleeping_threads_alternate_by_remaining_time() -> None:
    text = """
def p():
  thread a(): textmsg("a1") sleep(0.0015) textmsg("a2") sync() end
  thread b(): textmsg("b1") sleep(0.0005) textmsg("b2") sync() end
  run a()
  run b()
  sync() sync()
end
"""
    _, world, _ = finish(text)
    assert world.messages == ["a1", "b1", "b2", "a2"]


@pytest.mark.parametrize("where", ["main", "thread", "function"])
def test_starvation_stops_the_program(where: str) -> None:
    loop = "while True: x = x + 1 end"
    bodies = {
        "main": f"x = 0\n{loop}",
        "thread": f"x = 0\nthread t(): {loop} end\nrun t()\nwhile True: sync() end",
        "function": f"x = 0\ndef f(): {loop} end\nf()",
    }
    with pytest.raises(ScriptRuntimeError, match="too much time without instructing the robot"):
        finish(f"def p():\n{bodies[where]}\nend\n")


def test_the_budget_is_per_frame() -> None:
    body = "i = 0\n while i < 50:\n i = i + 1\n sync()\n end"
    machine, _, _ = finish(COUNTER.format(body=body), dialect=Dialect(budget=20))
    assert machine.finished
    with pytest.raises(ScriptRuntimeError) as caught:
        finish(COUNTER.format(body=body.replace("sync()", "")), dialect=Dialect(budget=20))
    assert caught.value.code == "too-much-time"


def test_operations_are_counted_per_thread_and_frame() -> None:
    machine = Machine(COUNTER.format(body="while True: sync() end"), IdleWorld())
    frames = [machine.frame() for _ in range(4)]
    assert [frame.number for frame in frames] == [0, 1, 2, 3]
    assert frames[2].operations == frames[3].operations
    assert set(frames[2].operations) == {"p", "count"}
    # one for the loop, then call; the counter has an addition and an assignment more
    assert frames[3].operations["count"] == frames[3].operations["p"] + 2


PAIR = """
def p():
  global a = 0
  global b = 0
  global torn = 0
  thread write():
    while True:
      {enter}
      a = a + 1
      i = 0
      while i < 30: i = i + 1 end
      b = b + 1
      {exit}
      sync()
    end
  end
  thread look():
    while True:
      if a != b: torn = torn + 1 end
      sync()
    end
  end
  run write()
  run look()
  while True: sync() end
end
"""


def test_a_critical_section_is_not_interrupted() -> None:
    sliced = Dialect(slice=20)
    bare, _, _ = finish(PAIR.format(enter="", exit=""), 20, sliced)
    guarded, _, _ = finish(PAIR.format(enter="enter_critical", exit="exit_critical"), 20, sliced)
    assert bare.globals["torn"] > 0
    assert guarded.globals["torn"] == 0
    assert guarded.globals["a"] == bare.globals["a"] == 20


def test_kill_ends_a_thread_and_its_children() -> None:
    text = """
def p():
  global n = 0
  thread child(): while True: n = n + 1 sync() end end
  thread parent(): h = run child() while True: sync() end end
  h = run parent()
  sleep(0.02)
  kill h
  global after = n
  sleep(0.02)
  kill h
  kill 0
end
"""
    machine, _, _ = finish(text)
    assert machine.finished
    assert machine.globals["n"] == machine.globals["after"] == 10


def test_a_thread_may_kill_itself() -> None:
    text = """
def p():
  global h = 0
  global reached = False
  thread t(): sync() kill h reached = True end
  h = run t()
  sleep(0.02)
end
"""
    machine, _, _ = finish(text)
    assert machine.finished and machine.globals["reached"] is False


def test_join_waits_for_the_thread() -> None:
    text = 'def p():\n thread t(): sleep(0.1) textmsg("t") end\n h = run t()\n join h\n textmsg("p")\nend\n'
    _, world, frames = finish(text)
    assert world.messages == ["t", "p"]
    assert frames == pytest.approx(52, abs=1)


def test_only_the_parent_joins() -> None:
    text = """
def p():
  global h = 0
  thread a(): sync() sync() end
  thread b(): join h end
  h = run a()
  run b()
  sleep(1.0)
end
"""
    with pytest.raises(ScriptRuntimeError, match="only the thread that started"):
        finish(text)


TWO = """
def p():
  thread t(): movej([0, 0, 0, 0, 0, 0], t=0.1) textmsg("there") end
  h = run t()
  sync()
  {between}
  stopj(2.0)
  textmsg("stopped")
end
"""


def test_a_second_motion_thread_is_refused() -> None:
    with pytest.raises(ScriptRuntimeError, match="Another thread is already controlling") as caught:
        finish(TWO.format(between=""))
    assert caught.value.line == 7


@pytest.mark.parametrize(("between", "messages"), [("kill h", ["stopped"]), ("join h", ["there", "stopped"])])
def test_motion_after_the_other_thread_is_done(between: str, messages: list[str]) -> None:
    machine, world, _ = finish(TWO.format(between=between))
    assert machine.finished
    assert world.messages == messages
    assert [name for name, _ in world.motions] == ["movej", "stopj"]


def test_motion_takes_physical_time() -> None:
    _, world, frames = finish(
        "def p():\n servoj([0, 0, 0, 0, 0, 0], t=0.008)\n movej([0, 0, 0, 0, 0, 0], t=0.1)\nend"
    )
    assert frames == 4 + 50 + 1
    name, arguments = world.motions[1]
    assert (name, arguments[1], arguments[3]) == ("movej", 1.4, 0.1)


def test_halt_and_the_end_of_the_program_end_the_threads() -> None:
    for ending in ("halt", "x = 1"):
        machine, _, frames = finish(COUNTER.format(body=ending))
        assert machine.finished and frames == 1 and machine.threads == ()


def test_pause_holds_everything() -> None:
    machine, world, _ = finish(COUNTER.format(body='pause\n textmsg("on")\n while True: sync() end'), 10)
    held = machine.globals["n"]
    assert machine.paused and world.frame == 10
    machine.run(10)
    assert machine.globals["n"] == held
    machine.resume()
    machine.run(5)
    assert machine.globals["n"] == held + 5 and world.messages == ["on"]


def test_worlds_may_return_lists_and_arrays() -> None:
    class Loose(IdleWorld):
        def do_get_actual_joint_positions(self):  # type: ignore[no-untyped-def]
            return np.arange(6.0)

        def do_socket_read_ascii_float(self, *arguments: object):  # type: ignore[no-untyped-def]
            yield
            return [2, 0.5, 1.5]

    body = "q = get_actual_joint_positions() + 1.0\n r = socket_read_ascii_float(2)\n s = r[1] + q[5]"
    text = f"def p():\n {body}\nend\n"
    machine = Machine(text, Loose())
    machine.run(5)
    assert machine.globals["s"] == 6.5


def test_threads_started_again_and_again_cost_nothing_later() -> None:
    text = "def p():\n thread t(): x = 1 end\n n = 0\n while n < 500: h = run t() join h n = n + 1 end\nend\n"
    machine, _, frames = finish(text)
    assert machine.finished and 250 <= frames <= 1001
    assert machine.frame().operations == {}


def test_stop_closes_a_motion_under_way() -> None:
    closed = []

    class Tidy(IdleWorld):
        def do_movej(self, *arguments: object):  # type: ignore[no-untyped-def]
            try:
                while True:
                    yield
            finally:
                closed.append(True)

    machine = Machine("def p():\n  movej([0, 0, 0, 0, 0, 0])\nend\n", Tidy())
    machine.run(3)
    machine.stop()
    assert closed == [True] and machine.finished


RECORD = """
def p():
  while True:
    local q = get_actual_joint_positions()
    local i = read_port_register(291)
    if i > 32767: i = i - 65536 end
    {rtde}
    write_output_float_register(24, q[1])
    write_output_integer_register(24, i)
    sync()
  end
end
"""


@pytest.mark.parametrize("encoding", ["signed", "unsigned"])
def test_a_recording_is_replayed(encoding: str) -> None:
    rng = np.random.default_rng(1)
    q, qd, current = rng.normal(size=(3, 20, 6))
    world = RecordedWorld(q, qd, current, encoding=encoding)  # type: ignore[arg-type]
    rtde = 'write_output_float_register(25, get_rtde_value("actual_current")[1])'
    machine = Machine(RECORD.format(rtde=rtde), world)
    for row in range(20):
        machine.frame()
        assert world.outputs["float", 24] == q[row, 1]
        assert world.outputs["integer", 24] == round(current[row, 1] * 1000)
        assert world.outputs["float", 25] == current[max(row - 1, 0), 1]
    assert world.ended


def test_rtde_values_need_a_new_controller() -> None:
    zeros = np.zeros((2, 6))
    text = 'def p():\n  x = get_rtde_value("actual_q")\nend\n'
    with pytest.raises(ScriptRuntimeError, match=r"needs PolyScope 5\.23"):
        Machine(text, RecordedWorld(zeros, zeros, zeros), Dialect(version="5.11")).run(1)
    with pytest.raises(ScriptRuntimeError, match="no field"):
        Machine(text.replace("actual_q", "nothing"), RecordedWorld(zeros, zeros, zeros)).run(1)


def test_recordings_of_the_wrong_shape_are_refused() -> None:
    with pytest.raises(ValueError, match="must be"):
        RecordedWorld(np.zeros((3, 6)), np.zeros((3, 5)), np.zeros((3, 6)))


def test_frames_are_cheap() -> None:
    lines = ["local t0 = q[0] * 0.5"]
    lines += [f"local t{b} = t{a} * cos(q[{b % 6}]) + t{b // 2} * 0.25" for a, b in pairwise(range(450))]
    body = "\n      ".join(lines)
    text = f"""
def p():
  thread observe():
    while True:
      local q = get_actual_joint_positions()
      {body}
      write_output_float_register(24, t449)
      sync()
    end
  end
  run observe()
  while True: sync() end
end
"""
    machine = Machine(text, IdleWorld())
    machine.run(2)
    start = time.perf_counter()
    machine.run(500)
    # 10 s of controller time have to take less than 20 s; this is a tenth of that.
    assert time.perf_counter() - start < 2.0
    assert machine.frame().operations["observe"] > 450
