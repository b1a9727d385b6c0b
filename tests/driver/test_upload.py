"""Programs on their way to the controller, and what it says of them."""

import pytest

from residuum.driver import find_program, upload
from residuum.errors import InputError

LOOP = "# a note\n\ndef loop():\n  while True:\n    sync()\n  end\nend\n"


def send(robot, text: str, **options) -> None:
    upload("127.0.0.1", find_program(text, "x.script"), "x.script", robot.ports.primary, **options)


def test_it_returns_when_the_program_runs(robot) -> None:
    send(robot, LOOP)
    assert robot.controller.programs.name == "loop"
    assert robot.controller.programs.state == "playing"


def test_what_stands_before_the_program_is_not_sent() -> None:
    program = find_program(LOOP, "x.script")
    assert (program.name, program.before, program.secondary) == ("loop", 2, False)
    assert program.text.startswith("def loop")


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("# note\ndef bad():\n  x = = 1\nend\n", r"x\.script: line 3, column 7: Syntax error"),
        ("def bad():\n  sync()\n  x = 1 / 0\nend\n", r"x\.script: line 3, column \d+: Runtime error"),
        ("def bad():\n  x = 'a'\nend\n", r"x\.script: line 2, column 7: Lexer exception"),
    ],
)
def test_the_controllers_error_comes_with_the_line_of_the_file(robot, text, place) -> None:
    with pytest.raises(InputError, match=place):
        send(robot, text)


def test_a_robot_that_is_not_ready_says_so(robot) -> None:
    robot.controller.arm.mode = 3
    with pytest.raises(InputError, match="not ready to run"):
        send(robot, LOOP)


def test_a_program_that_is_not_started_is_said(robot, monkeypatch) -> None:
    monkeypatch.setattr(robot.controller.programs, "start", lambda _text: None)
    with pytest.raises(InputError, match=r"not started within 1 s; is the robot in remote control"):
        send(robot, LOOP, timeout=1.0)


def test_a_secondary_program_does_not_end_the_other(robot) -> None:
    send(robot, LOOP)
    send(robot, "sec light():\n  set_standard_digital_out(1, True)\nend\n")
    assert robot.controller.world.digital["standard", 1] is True
    assert robot.controller.programs.name == "loop"


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("movej([0,0,0,0,0,0])\n", "no program"),
        ("def a():\n  sync()\n  end\n", "no `end` in column 1"),
        ("def a():\n  # \u00e4\nend\n", "line 2: not ASCII"),
        ("def " + "a" * 32 + "():\nend\n", "more than 31 characters"),
    ],
)
def test_what_no_controller_would_take_is_not_sent(text, reason) -> None:
    with pytest.raises(InputError, match=reason):
        find_program(text, "x.script")


def test_a_port_that_does_not_introduce_itself_is_no_robot(robot) -> None:
    with pytest.raises(InputError, match="does not introduce itself"):
        upload("127.0.0.1", find_program(LOOP, "x"), "x", robot.ports.realtime, timeout=0.3)
