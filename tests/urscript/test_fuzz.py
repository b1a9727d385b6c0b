"""Hostile text: never a crash, never a hang, never a recursion error."""

from __future__ import annotations

import random
import time

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from residuum.urscript import Dialect, Fault, IdleWorld, Machine, ScriptError, check, parse
from residuum.urscript.tokens import MAX_BLOCKS, MAX_BRACKETS

VALID = """\
def prog():
  global gains = [1.0, 2.5e-3, -3.]
  global pose = p[0.1, 0, 0, 0, 3.14, 0]
  def f(a, b=2.0):
    local c = a[0] * b - sin(a[1]) / 2.0
    if c > 1.0 and not False:
      return -c
    elif c == 0.0 or True: return [c, [1, 2]]
    else:
      while c < 3.0: c = c + 1.0 continue end
    end
    return None
  end
  thread t():
    while True:
      enter_critical
      gains[0] = gains[0] + 0.5
      exit_critical
      sync()
    end
  end
  h = run t()
  $ 3 "label"
  textmsg("x = ", f(gains, b=1.0))
  movej([0, 0, 0, 0, 0, 0], a=1.2, t=0.02)
  kill h
  s = struct(u=1)
  s.u = 2
  halt
end
"""
WORDS = [
    *VALID.split(),
    "(",
    ")",
    "[",
    "]",
    "end",
    "if",
    "while",
    "return",
    "+",
    "-",
    "not",
    "!",
    ":",
    ",",
    ".",
]


def digest(text: str) -> None:
    """Parse, check and, if it parses, run a few frames; only the language's own errors may come out."""
    try:
        parse(text)
    except ScriptError as error:
        assert error.line >= 1 and error.column >= 1 and "\n" not in str(error)
        assert [d.severity for d in check(text)] == ["error"]
        return
    for diagnostic in check(text):
        assert diagnostic.line >= 1 and diagnostic.message
    try:
        Machine(text, IdleWorld(), Dialect(budget=2000)).run(5)
    except ScriptError as error:
        assert error.line >= 1


def mutated(seed: int) -> str:
    rng = random.Random(seed)
    words = VALID.split(" ") if seed % 2 else list(VALID)
    for _ in range(rng.randint(1, 6)):
        place = rng.randrange(len(words))
        action = rng.randrange(4)
        if action == 0:
            del words[place]
        elif action == 1:
            words.insert(place, rng.choice(WORDS) + " ")
        elif action == 2:
            other = rng.randrange(len(words))
            words[place], words[other] = words[other], words[place]
        else:
            words[place] = rng.choice(WORDS)
    return (" " if seed % 2 else "").join(words)


@pytest.mark.parametrize("start", range(0, 300, 100))
def test_mutations_of_a_valid_program(start: int) -> None:
    for seed in range(start, start + 100):
        digest(mutated(seed))


@pytest.mark.slow
def test_many_mutations_of_a_valid_program() -> None:
    for seed in range(1000, 6000):
        digest(mutated(seed))


@settings(max_examples=200, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.text(max_size=200))
def test_random_text(text: str) -> None:
    digest(text)


@settings(max_examples=200, deadline=None)
@given(st.binary(max_size=200))
def test_random_bytes(data: bytes) -> None:
    digest(data.decode("latin-1"))


@settings(max_examples=200, deadline=None)
@given(st.lists(st.sampled_from(WORDS), max_size=60))
def test_random_words(words: list[str]) -> None:
    digest(" ".join(words))


@pytest.mark.parametrize(
    "text",
    [
        "x = " + "(" * 5000,
        "x = " + "(" * 5000 + "1" + ")" * 5000,
        "x = " + "[" * 5000 + "]" * 5000,
        "x = " + "-" * 5000 + "1",
        "x = " + "not " * 5000 + "True",
        "x = a" + "[0]" * 5000,
        "x = a" + ".b" * 5000,
        "x = a" + "()" * 5000,
        "x = " + "+".join(["1"] * 5000),
        "if True: " * 5000 + "end " * 5000,
        "while True: " * 25 + "end " * 25,
        "if a: " + "elif b: " * 3000 + "end",
        "def f(): " * 200 + "end " * 200,
        "x = " + "9" * 5000,
        "x = 1e999999",
        '$ 99999999999999999999 "x"',
        "f(" + ", ".join(["1"] * 5000) + ")",
        "x = [" + ", ".join(["1"] * 5000) + "]",
        "x = 1\n" * 1000,
        "def f(" + ", ".join(f"a{i}" for i in range(300)) + "): end",
        '"' * 5000,
        "#" * 5000,
        "\x00\x1b\ufeff",
        "def f(): return f() end\nx = f()",
        "def f(a=f()): return a end",
    ],
    ids=lambda text: text[:12],
)
def test_extremes_end_soon(text: str) -> None:
    start = time.perf_counter()
    digest(text)
    digest(f"def prog():\n{text}\nend\n")
    assert time.perf_counter() - start < 10.0


def test_limits_leave_room_for_real_programs() -> None:
    deep = "(" * MAX_BRACKETS + "1.0" + ")" * MAX_BRACKETS
    assert parse(f"x = {deep}").body
    nested = "if True: " * MAX_BLOCKS + "x = 1 " + "end " * MAX_BLOCKS
    assert parse(nested).body
    with pytest.raises(ScriptError, match="split"):
        parse(f"x = ({deep})")


def test_a_fault_of_the_world_becomes_a_script_error() -> None:
    class Refusing(IdleWorld):
        def do_get_actual_joint_positions(self):  # type: ignore[no-untyped-def]
            raise Fault("no robot", "no-robot")

    with pytest.raises(ScriptError, match="line 3, column 7: no robot"):
        Machine("def p():\n  sync()\n  x = get_actual_joint_positions()\nend\n", Refusing()).run(3)
