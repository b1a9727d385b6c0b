"""The parser: what the language allows, and one readable message for what it does not."""

from __future__ import annotations

import pytest

from residuum.urscript import ScriptError, parse, parse_program
from residuum.urscript import nodes as n


def test_an_expression_continues_over_newline_and_comment() -> None:
    # What ur_rtde uploads: the offset stands on the line after the comment.
    text = (
        "def p():\n    global a = # float register offset\n0    global b = # int\n24    global c = 2\nend\n"
    )
    program = parse_program(text)
    values = [(s.target.name, s.value.value, s.line) for s in program.body if isinstance(s, n.Assign)]
    assert values == [("a", 0, 2), ("b", 24, 3), ("c", 2, 4)]


def test_statements_share_a_line() -> None:
    program = parse_program('def myFun(): mystring = "Hello" textmsg(mystring) end')
    assert [type(s).__name__ for s in program.body] == ["Assign", "Evaluate"]


@pytest.mark.parametrize(
    ("text", "value"),
    [("3.", 3.0), (".5", 0.5), ("1e-10", 1e-10), ("1.234567e-05", 1.234567e-05), ("7", 7), ("2E3", 2000.0)],
)
def test_numbers(text: str, value: float) -> None:
    (statement,) = parse(f"x = {text}").body
    assert isinstance(statement, n.Assign)
    assert isinstance(statement.value, n.Literal)
    assert statement.value.value == value
    assert type(statement.value.value) is type(value)


def test_p_is_a_pose_with_six_items_and_a_variable_with_one() -> None:
    pose, element, matrix = parse("a = p[1, 2, 3, 4, 5, 6] b = p[0] c = p[0, 1]").body
    assert isinstance(pose, n.Assign) and isinstance(pose.value, n.PoseDisplay)
    assert isinstance(element, n.Assign) and isinstance(element.value, n.Index)
    assert isinstance(matrix, n.Assign) and isinstance(matrix.value, n.Index)


def test_everything_has_its_place() -> None:
    program = parse_program("def p():\n  if a > 1:\n    f(x, y=[1, 2])\n  end\nend\n")
    call = next(node for node in n.walk(program) if isinstance(node, n.Call))
    comparison = next(node for node in n.walk(program) if isinstance(node, n.Binary))
    assert (call.line, call.column) == (3, 5)
    assert (comparison.line, comparison.column) == (2, 8)
    assert (program.end_line, program.end_column) == (5, 1)


def test_the_rest_of_the_language_parses() -> None:
    text = """
def prog():
  $ 1 "Robot Program"
  # comment
  thread t(): while True: sync() end end
  def f(a, b=[1, 2], c=p[0, 0, 0, 0, 0, 0]):
    def g(): return None end
    return a.x + b[0] - c[1]
  end
  h = run t()
  s = struct(x=1, y="a")
  s.x = 2
  l = [[1, 2], [3, 4]]
  l[0, 1] = 5
  l[0][1] = 6
  n = l.length()
  if not a and (b or !c) xor d: halt elif e: pause else: kill h end
  while x < 3: if y: break end continue end
  enter_critical exit_critical join h
  z = - 1 + -2 * +3
  return f(1)
end
"""
    assert parse_program(text).name == "prog"


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        ("def p():\n  x = 2^3\nend", (2, 8), "pow"),
        ("def p():\n  x = (1 + 2\n  y = 3\nend", (3, 3), "expected"),
        ("def p():\n  while True:\n    sync()\nend\n", (2, 3), "`while` is never closed"),
        ("def p(:\nend", (1, 7), "unexpected"),
        ("f(", (1, 3), "stops in the middle"),
    ],
)
def test_messages_are_one_line_with_the_place(text: str, place: tuple[int, int], words: str) -> None:
    with pytest.raises(ScriptError, match=words) as caught:
        parse(text)
    assert (caught.value.line, caught.value.column) == place
    assert str(caught.value).startswith(f"line {place[0]}, column {place[1]}: ")
    assert "\n" not in str(caught.value)


def test_a_program_is_alone() -> None:
    with pytest.raises(ScriptError, match="after the program"):
        parse_program("def a():\nend\ndef b():\nend\n")
    with pytest.raises(ScriptError, match="def name"):
        parse_program("x = 1")
    with pytest.raises(ScriptError, match="def name"):
        parse_program("")
