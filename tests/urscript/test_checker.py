"""The checker: every mistake under its name at its line, and nothing wrong where nothing is wrong."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest

from residuum.errors import InputError
from residuum.urscript import check

PROGRAMS: list[dict[str, Any]] = tomllib.loads(Path(__file__).with_name("wrong_programs.toml").read_text())[
    "program"
]

GUARD = """\
def guard():
  global rs_limit = [10.0, 10.0]
  global rs_hit = False
  def rs_signed(value):
    local v = value
    if v > 32767:
      v = v - 65536
    end
    return v * 0.001
  end
  thread rs_motion():
    while True:
      movej([0.0, -1.57, 1.57, -1.57, -1.57, 0.0], a=1.0, v=0.5)
      sleep(0.1)
    end
  end
  thread rs_observer():
    while True:
      local q = get_actual_joint_positions()
      local current = rs_signed(read_port_register(290))
      local r = current * sin(q[1]) + rs_limit[0]
      enter_critical
      rs_hit = r > rs_limit[1]
      exit_critical
      write_output_float_register(24, r)
      sync()
    end
  end
  local_handle = run rs_motion()
  observer = run rs_observer()
  while not rs_hit:
    sync()
  end
  kill local_handle
  kill observer
  stopj(3.0)
  freedrive_mode()
  while True:
    sync()
  end
end
"""


@pytest.mark.parametrize("program", PROGRAMS, ids=lambda program: program["name"])
def test_each_mistake_is_named_at_its_line(program: dict[str, Any]) -> None:
    found = check(program["text"], program.get("version", "5.23"))
    wanted = (program["code"], program["severity"], program["line"])
    assert wanted in [(d.code, d.severity, d.line) for d in found]
    others = {d.code for d in found if d.severity == "error"} - {program["code"]}
    assert not others, "one mistake must not be reported as several"


def test_there_are_sixty_wrong_programs() -> None:
    assert len(PROGRAMS) >= 60
    assert len({program["code"] for program in PROGRAMS}) >= 40


@pytest.mark.parametrize("version", ["5.4", "5.11", "5.23", "10.0", "10.11", "10.x"])
def test_a_sound_guard_gives_nothing(version: str) -> None:
    assert check(GUARD, version) == []


def test_syntax_errors_come_alone() -> None:
    assert len(check("def p():\n  x = (1\n  y = ]\nend\n")) == 1


@pytest.mark.parametrize("version", ["", "5", "3.15", "5.3", "abc", "5.x.x", "10"])
def test_an_unknown_version_is_refused(version: str) -> None:
    with pytest.raises(InputError, match="PolyScope"):
        check(GUARD, version)


def test_remarks_come_in_the_order_of_the_text() -> None:
    found = check("def p():\n  x = abs(1)\n  y = zzz\n  break\nend\n")
    assert [d.line for d in found] == [2, 3, 4]
    assert "norm" in found[0].message


def test_a_default_argument_is_no_missing_one() -> None:
    text = "def p():\n  def f(a, b=2.0):\n    return a + b\n  end\n  x = f(1.0) + f(1.0, b=3.0)\nend\n"
    assert check(text) == []


def test_every_code_is_in_the_manual() -> None:
    manual = (Path(__file__).parents[2] / "docs" / "urscript.md").read_text()
    assert [p["code"] for p in PROGRAMS if f"`{p['code']}`" not in manual] == []
