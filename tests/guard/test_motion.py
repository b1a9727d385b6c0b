"""The user's own motion: checked where the user wrote it, and run as it was meant."""

import pytest
from guarding import Arm, run_until

from residuum.codegen.motion import read_motion
from residuum.errors import InputError
from residuum.urscript import Machine, check

PROGRAM = """def work():
  home = [0.0, -1.57, 1.57, 0.0, 0.0, 0.0]
  local count = 0
  def doubled(x):
    return 2 * x * factor
  end
  factor = 3.0
  thread blink():
    while True:
      set_standard_digital_out(0, True)
      sleep(0.1)
    end
  end
  lamp = run blink()
  while count < 3:
    movej(home)
    count = count + 1
  end
  write_output_float_register(10, doubled(1.5))
end
"""


def test_a_whole_program_runs_and_the_guard_ends_with_it(small, collision) -> None:
    motion = read_motion(PROGRAM, "work.script", "5.11")
    text = small.guard(motion=motion)
    assert [d for d in check(text, "5.11") if d.severity == "error"] == []
    world = Arm(collision)
    machine = Machine(text, world)
    begin = run_until(machine, world, state=2)
    machine.frame()
    assert {"rs_guard", "rs_motion", "blink"} <= set(machine.threads)
    end = run_until(machine, world, state=8)
    machine.frame()
    assert machine.finished and 150 <= end - begin <= 155
    assert [what for _, what in world.log] == ["movej"] * 3
    assert world.outputs["float", 10] == 9.0
    assert world.digital["standard", 0] is True


def test_a_collision_kills_the_motion_and_its_threads(small, collision) -> None:
    motion = read_motion(PROGRAM.replace("count < 3", "count < 300"), "work.script", "5.11")
    world = Arm(collision)
    machine = Machine(small.guard(motion=motion), world)
    run_until(machine, world, state=6)
    assert set(machine.threads) == {"collision_guard", "rs_guard"}
    last = max(frame for frame, what in world.log if what == "movej")
    assert last <= world.when("stopj")


@pytest.mark.parametrize(
    "body",
    [
        "movej([0.0, 0.0, 0.0, 0.0, 0.0, 0.0])\n",
        "  k = 0\n  while k < 2:\n    movej([0.1, 0.0, 0.0, 0.0, 0.0, 0.0])\n    k = k + 1\n  end",
        "# only a comment first\r\nwhile True:\r\n  movej([0.1, 0.0, 0.0, 0.0, 0.0, 0.0])\r\nend\r\n",
        "def go():\n  movej([0.1, 0.0, 0.0, 0.0, 0.0, 0.0])\nend\ngo()\n",
    ],
)
def test_a_function_body_runs(small, collision, body) -> None:
    text = small.guard(motion=read_motion(body, "body.script", "5.11"))
    assert [d for d in check(text, "5.11") if d.severity != "note"] == []
    world = Arm(collision)
    machine = Machine(text, world)
    run_until(machine, world, state=2)
    machine.run(60)
    assert world.log[0][1] == "movej"


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        ("movej([0.0, 1.0)\n", "1:16", "unexpected"),
        ("x = 1\nwhile True:\n  x = 2\nend\n", "2:1", "never waits"),
        ("sync()\nrs_joint = 3\n", "2:1", "belong to the guard"),
        ("def a():\n  movej([0.0, 0.0, 0.0, 0.0, 0.0, 0.0])\n  y = zz + 1\nend\n", "3:7", "zz"),
        ('def a():\n  q = get_rtde_value("actual_q")\n  sync()\nend\n', "2:7", "5.23"),
        ("movej([0.0, 0.0, 0.0, 0.0, 0.0, 0.0])\nmovel(p[0.0, 0.0, 0.0])\n", "2:8", "6 elements"),
        ('sec a():\n  textmsg("x")\nend\n', "1:1", "secondary"),
        ("def a():\n  sync()\nend\ndef b():\n  rs_x = 1\nend\n", "5:3", "belong to the guard"),
        ("", "", "holds no statement"),
        ("# nothing\n", "", "holds no statement"),
    ],
)
def test_errors_are_placed_in_the_users_file(text, place, words) -> None:
    with pytest.raises(InputError, match=words) as error:
        read_motion(text, "my.script", "5.11")
    assert str(error.value).startswith(f"my.script:{place}")
    assert "\n" not in str(error.value)


def test_warnings_are_placed_in_the_users_file_too() -> None:
    motion = read_motion("sync()\nwrite_output_float_register(25, 1.0)\n", "my.script", "5.11")
    assert len(motion.remarks) == 1
    assert motion.remarks[0].startswith("my.script:2:1: the guard writes output register 25 too")
