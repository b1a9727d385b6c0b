"""What a recording answers besides position, speed and current."""

import numpy as np
import pytest

from residuum.urscript import Machine, RecordedWorld, ScriptRuntimeError

ROWS = np.arange(18.0).reshape(3, 6)


def told(statement: str, world: RecordedWorld, frames: int = 3) -> list[str]:
    machine = Machine(f"def p():\n  while True:\n    textmsg({statement})\n    sync()\n  end\nend\n", world)
    machine.run(frames)
    return world.messages


def test_target_speeds_are_those_of_the_step() -> None:
    world = RecordedWorld(ROWS, ROWS, ROWS, rtde={"target_qd": 10 * ROWS})
    assert told("get_target_joint_speeds()[1]", world) == ["10", "70", "130"]


def test_target_speeds_are_zero_where_none_were_recorded() -> None:
    assert told("norm(get_target_joint_speeds())", RecordedWorld(ROWS, ROWS, ROWS)) == ["0"] * 3


def test_temperatures() -> None:
    world = RecordedWorld(ROWS, ROWS, ROWS, rtde={"joint_temperatures": 20 + ROWS})
    assert told("get_joint_temp(2)", world) == ["22", "28", "34"]
    assert told("get_joint_temp(5)", RecordedWorld(ROWS, ROWS, ROWS), 1) == ["30"]


def test_there_is_no_seventh_temperature() -> None:
    with pytest.raises(ScriptRuntimeError, match="joint from 0 to 5"):
        told("get_joint_temp(6)", RecordedWorld(ROWS, ROWS, ROWS))


def test_payload_is_what_was_set() -> None:
    world = RecordedWorld(ROWS, ROWS, ROWS)
    world.payload = 1.5
    assert told("get_target_payload()", world, 1) == ["1.5"]
