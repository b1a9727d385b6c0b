"""What programs compute, and how they fail."""

from __future__ import annotations

import math
from typing import Any

import pytest

from residuum.urscript import Dialect, Functions, IdleWorld, Machine, Pose, ScriptRuntimeError, run_function


def value_of(expression: str, **choices: Any) -> Any:
    return run_function(f"def f(): return {expression} end", "f", dialect=Dialect(**choices))


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ("1.0 + 2.0 * 3.0", 7.0),
        ("(1.0 + 2.0) * 3.0", 9.0),
        ("1.0 - 2.0 - 3.0", -4.0),
        ("8.0 / 4.0 / 2.0", 1.0),
        ("7 / 2", 3.5),
        ("7 % 4", 3),
        ("-7 % 4", -3),
        ("2 + 3", 5),
        ("- 2.0 * -3.0", 6.0),
        ("not True or True", True),
        ("True xor True", False),
        ("1 < 2 and 2.0 >= 2", True),
        ("1 == 1.0", True),
        ("True == 1", False),
        ("[1, 2] == [1, 2]", True),
        ('"a" != "b"', True),
        ("[1, 2, 3] * 2", [2, 4, 6]),
        ("[1, 2, 3] * [4, 5, 6]", [4, 10, 18]),
        ("1 - [1, 2]", [0, -1]),
        ("[[1, 2], [3, 4]] * [1, 1]", [3, 7]),
        ("[[1, 2], [3, 4]] * [[0, 1], [1, 0]]", [[2, 1], [4, 3]]),
        ("2 * [[1, 2], [3, 4]]", [[2, 4], [6, 8]]),
        ("transpose([1, 2])", [[1], [2]]),
        ("transpose([[1], [2]])", [1, 2]),
        ("transpose([[1, 2], [3, 4]])", [[1, 3], [2, 4]]),
        ("size([[1, 2, 3], [4, 5, 6]])", [2, 3]),
        ("inv([[2.0, 0.0], [0.0, 4.0]])", [[0.5, 0.0], [0.0, 0.25]]),
        ("[[1, 2], [3, 4]][1, 0]", 3),
        ("pow(2.0, 10.0)", 1024.0),
        ("norm(-3.0)", 3.0),
        ("norm([3.0, 4.0])", 5.0),
        ("atan2(1.0, 0.0)", math.pi / 2),
        ("log(10., 100.)", 2.0),
        ("floor(-1.5)", -2),
        ("ceil(1.2)", 2),
        ("length([1, 2, 3])", 3),
        ("d2r(180.0)", math.pi),
        ('str_cat("a", 1.5)', "a1.5"),
        ('str_sub("hello", 1, 3)', "ell"),
        ('to_num("2.5")', 2.5),
        ("to_str([1, 2.5, True])", "[1, 2.5, True]"),
        ("binary_list_to_integer([True, False, True])", 5),
        ("struct(a=1, b=2).b", 2),
        ("pose_trans(p[1, 0, 0, 0, 0, 0], p[0, 2, 0, 0, 0, 0])", [1, 2, 0, 0, 0, 0]),
    ],
)
def test_expressions(expression: str, value: Any) -> None:
    result = value_of(expression)
    assert result == pytest.approx(value) if isinstance(value, float) else result == value
    assert type(result) is type(value)


def test_poses_turn_and_come_back() -> None:
    text = """
def f(a, b):
  return pose_sub(pose_trans(pose_inv(a), pose_trans(a, b)), b)
end
def g(r): return rotvec2rpy(rpy2rotvec(r)) end
"""
    functions = Functions(text)
    a, b = Pose((0.1, -0.2, 0.3, 0.4, 1.5, -0.6)), Pose((1.0, 0.5, -0.3, math.pi, 0.0, 0.0))
    assert functions.call("f", a, b) == pytest.approx([0.0] * 6, abs=1e-7)
    assert functions.call("g", [0.3, -1.2, 2.0]) == pytest.approx([0.3, -1.2, 2.0])


def test_arrays_are_passed_by_value() -> None:
    text = """
def f(a):
  b = a
  a[0] = 9
  return [a, b]
end
def g(m): k = m  k[0, 1] = 7  k[1][0] = 8  return [m, k] end
"""
    assert run_function(text, "f", [1, 2]) == [[9, 2], [1, 2]]
    assert run_function(text, "g", [[1, 2], [3, 4]]) == [[[1, 2], [3, 4]], [[1, 7], [8, 4]]]


def test_defaults_and_named_arguments() -> None:
    text = "def f(a, b=2, c=3): return [a, b, c] end  def g(): return f(1, c=9) end"
    assert run_function(text, "g") == [1, 2, 9]


def test_control_flow() -> None:
    text = """
def f(n):
  local total = 0
  local i = 0
  while True:
    i = i + 1
    if i > n: break elif i % 2 == 0: continue else: total = total + i end
  end
  return total
end
"""
    assert run_function(text, "f", 10) == 1 + 3 + 5 + 7 + 9


SCOPE = """
def prog():
  global a = 0
  b = 0
  local c = 0
  def f(): a = 1  b = 1  c = 1  d = 1  return d end
  def g(): local a = 2  def h(): a = 3 return a end  x = h()  return a end
  def made(): global fresh = 5 return fresh end
  r = f()
  s = g()
  t = made()
  u = fresh
end
"""


def test_scope_rules_of_the_manual() -> None:
    machine = Machine(SCOPE, IdleWorld())
    machine.run(1)
    found = machine.globals
    assert (found["a"], found["b"], found["c"]) == (3, 1, 1)
    assert (found["s"], found["u"]) == (2, 5)
    assert "d" not in found and "x" not in found


def test_functions_of_a_program_find_its_first_globals() -> None:
    text = """
def prog():
  global gains = [1.0, 2.0]
  offset = 0.5
  def f(i): return gains[i] + offset end
  while True: sync() end
end
"""
    functions = Functions(text)
    assert functions.call("f", 1) == 2.5
    assert functions.operations > 0


@pytest.mark.parametrize(
    ("body", "line", "code"),
    [
        ("x = 1.0\nx = x / 0.0", 3, "divide-by-zero"),
        ("x = 1 / 0", 2, "divide-by-zero"),
        ("x = 5 % 0", 2, "divide-by-zero"),
        ("x = sqrt(-1)", 2, "domain"),
        ("x = log(10.0, 0.0)", 2, "domain"),
        ("x = asin(1.5)", 2, "domain"),
        ("x = acos(-1.5)", 2, "domain"),
        ("x = pow(-1.0, 0.5)", 2, "domain"),
        ("x = [1, 2]\n\nx[2] = 1", 4, "index"),
        ("x = [1, 2]\ny = x[-1]", 3, "index"),
        ("x = [1, 2]\ny = x[0.5]", 3, "index"),
        ("x = 3\ny = x[0]", 3, "type"),
        ('x = 1\nx = "a"', 3, "type-change"),
        ("x = [1.0]\nx = 1.0", 3, "type-change"),
        ("x = True\nx = 1", 3, "type-change"),
        ("x = 1.0\ny = x +\n  z", 4, "unassigned"),
        ("if 1: sync() end", 2, "type"),
        ("x = 1 and True", 2, "type"),
        ("x = True + 1", 2, "type"),
        ('x = "a" + "b"', 2, "type"),
        ("x = [1, 2] + [1, 2, 3]", 2, "length"),
        ("x = [[1]] + [[1]]", 2, "type"),
        ("x = [[1, 2]] * [1, 2, 3]", 2, "length"),
        ("x = inv([[0.0]])", 2, "math"),
        ("x = 2147483647\nx = x + 1", 3, "overflow"),
        ("x = sin(True)", 2, "type"),
        ('x = p[1, 2, 3, 4, 5, "a"]', 2, "type"),
        ("def f(): return f() end\nx = f()", 2, "recursion"),
        ("x = get_mass_matrix()", 2, "not-available"),
        ("x = get_tcp_force()", 2, "not-available"),
        ("write_output_float_register(48, 1.0)", 2, "address"),
        ("write_output_integer_register(24, 1.5)", 2, "type"),
        ("exit_critical", 2, "critical"),
        ("join 77", 2, "handle"),
        ("sleep(-1.0)", 2, "domain"),
        ("freedrive_mode()\nmovej([0, 0, 0, 0, 0, 0])", 3, "freedrive"),
    ],
)
def test_runtime_errors_have_their_line(body: str, line: int, code: str) -> None:
    machine = Machine(f"def p():\n{body}\nend\n", IdleWorld(), Dialect(version="5.11"))
    with pytest.raises(ScriptRuntimeError) as caught:
        machine.run(5)
    assert (caught.value.line, caught.value.code) == (line, code)
    assert machine.finished


def test_the_column_is_that_of_the_operator() -> None:
    with pytest.raises(ScriptRuntimeError) as caught:
        run_function("def f(a, b):\n  return 1.0 + (a / b)\nend", "f", 1.0, 0.0)
    assert (caught.value.line, caught.value.column) == (2, 19)


def test_unset_registers_can_be_errors() -> None:
    world = IdleWorld()
    world.unset_is_error = True
    with pytest.raises(ScriptRuntimeError, match="never written"):
        Machine("def p():\n  x = read_input_float_register(24)\nend\n", world).run(1)


def test_numbers_keep_or_change_their_type_by_dialect() -> None:
    text = "def f(): x = 1  x = 2.5  y = 1.0  y = 2  return [x, y] end"
    assert run_function(text, "f") == [2.5, 2.0]
    assert isinstance(run_function(text, "f")[1], float)
    with pytest.raises(ScriptRuntimeError, match="cannot become a float"):
        run_function(text, "f", dialect=Dialect(strict_numbers=True))


def test_integers_by_dialect() -> None:
    assert value_of("-7 / 2", integer_division="whole") == -3
    assert value_of("2147483647 + 1", integer_overflow="wrap") == -(2**31)


def test_what_needs_a_machine_says_so() -> None:
    for body in ("sync()", "sleep(1.0)", "movej([0, 0, 0, 0, 0, 0])", "halt"):
        with pytest.raises(ScriptRuntimeError, match="Machine"):
            run_function(f"def f(a): {body} return a end", "f", 1.0)


def test_long_sums_do_not_exhaust_the_stack() -> None:
    text = "def f(a): return " + " + ".join(["a"] * 450) + " end"
    assert run_function(text, "f", 1.0) == 450.0
