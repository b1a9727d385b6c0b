"""All combinations of options: checked without a warning, small enough, and unchanged unless on purpose."""

import difflib
import hashlib
import itertools
import json
from functools import cache
from pathlib import Path

import pytest
from guarding import Printer, model_of

from residuum.codegen.generate import render
from residuum.codegen.guard import guard_size
from residuum.codegen.options import DETECTORS, REACTIONS, Options
from residuum.errors import InputError
from residuum.urscript import check

GOLDEN = Path(__file__).with_name("golden")
REMEDY = "if the change is meant: pytest tests/guard --update, read the diff of tests/guard/golden, commit it"
TARGETS = [*(("modbus", v) for v in ("5.4", "5.11", "5.23", "10.11")), ("rtde", "5.23"), ("rtde", "10.11")]
ALL = list(itertools.product((3, 6), TARGETS, REACTIONS, DETECTORS))
#: Every reaction with every detector, every target with some of both; 3 and 6 joints.
SOME = [x for i, x in enumerate(ALL) if i % 7 == 0]
#: Two texts in full, of two joints so that they stay short.
FULL = {
    "rtde_retract_vote": {"current_source": "rtde", "reaction": "retract", "detector": "vote"},
    "modbus_hold_cusum": {"reaction": "hold", "detector": "cusum", "polyscope": "10.11", "bias": "subtract"},
}


@cache
def printer(dof: int) -> Printer:
    return Printer(model_of("ur5e", dof, 25.0, 8.0))


@cache
def scripts(dof: int, target: tuple[str, str], reaction: str, detector: str) -> dict[str, str]:
    source, version = target
    options = {"current_source": source, "polyscope": version, "reaction": reaction, "detector": detector}
    return printer(dof).scripts(**options)


def remarks(found: dict[str, str], version: str) -> list[str]:
    allowed = {"snapshot.script": {"secondary"}}
    return [
        f"{name}:{d.line}: {d.severity}: {d.message}"
        for name, text in found.items()
        for d in check(text, version)
        if d.severity != "note" or d.code not in allowed.get(name, ())
    ]


@pytest.mark.parametrize("case", SOME, ids=str)
def test_checked_without_a_remark(case) -> None:
    assert remarks(scripts(*case), case[1][1]) == []


@pytest.mark.slow
@pytest.mark.parametrize("dof", [3, 6])
def test_all_combinations_are_checked_without_a_remark(dof) -> None:
    cases = [x for x in ALL if x[0] == dof]
    assert len(cases) == 6 * 3 * 5
    for case in cases:
        assert remarks(scripts(*case), case[1][1]) == [], case


@pytest.mark.parametrize("detector", DETECTORS)
def test_six_joints_with_friction_stay_small(detector) -> None:
    for source, version in (("modbus", "5.11"), ("rtde", "5.23")):
        text = scripts(6, (source, version), "retract", detector)["collision_guard.script"]
        size = guard_size(text)
        assert size.size_in_bytes == len(text) <= 20_000
        assert size.assignments <= 450
        assert size.assignments == text.count(" = ")
        assert max(map(len, text.splitlines())) <= 218, "the longest line known to load"
        assert text.isascii()


def test_the_page_says_how_large_the_guard_is() -> None:
    made = printer(3)
    files = render(made.symbolic, made.listings, Options()).files
    size = guard_size(files["collision_guard.script"])
    line = files["model.md"].splitlines()[-1]
    assert f"{size.size_in_bytes} bytes, {size.assignments} assignments; {size.operations} operations" in line


@pytest.mark.parametrize("version", ["5.4", "5.11", "10.4"])
def test_rtde_values_need_a_controller_that_has_them(version) -> None:
    with pytest.raises(InputError, match="has no get_rtde_value"):
        Options(current_source="rtde", polyscope=version)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"detector": "magic"}, "--detector magic: give one of static"),
        ({"polyscope": "5.1"}, "--polyscope: PolyScope 5.1 is not supported"),
        ({"resume": "register:10"}, "--resume register:10: give register:64"),
        ({"resume": "digital:8"}, "--resume digital:8"),
        ({"resume": "button"}, "--resume button"),
        ({"payload": -1.0}, "--payload -1"),
        ({"payload": float("nan")}, "--payload nan"),
    ],
)
def test_wrong_options_are_named(wrong, words) -> None:
    with pytest.raises(InputError, match=words):
        Options(**wrong)


def test_thresholds_must_be_limits() -> None:
    with pytest.raises(InputError, match="above 0 Nm"):
        Printer(model_of("ur5e", 1, 0.0)).guard()


def test_every_text_is_the_golden_one(request) -> None:
    file = GOLDEN / "manifest.json"
    found = {
        f"dof{dof} {source} {version} {reaction} {detector}": hashlib.sha256(
            "".join(scripts(dof, (source, version), reaction, detector).values()).encode()
        ).hexdigest()[:16]
        for dof, (source, version), reaction, detector in ALL
    }
    if request.config.getoption("--update"):
        file.write_text(json.dumps(found, indent=0) + "\n")
    kept = json.loads(file.read_text())
    changed = [name for name in sorted(found | kept) if found.get(name) != kept.get(name)]
    assert not changed, f"{len(changed)} of {len(found)} texts changed, as {changed[0]}; {REMEDY}"


@pytest.mark.parametrize("name", FULL)
def test_full_texts_are_the_golden_ones(name, request) -> None:
    file = GOLDEN / f"{name}.script"
    found = printer(2).guard(**FULL[name])
    if request.config.getoption("--update"):
        file.write_text(found)
    kept = file.read_text()
    lines = (kept.splitlines(), found.splitlines())
    diff = "\n".join(difflib.unified_diff(*lines, "golden", "found", lineterm="", n=1))
    assert found == kept, f"{diff}\n{REMEDY}"


def test_no_golden_file_is_left_over() -> None:
    assert {x.name for x in GOLDEN.iterdir()} == {"manifest.json", *(f"{name}.script" for name in FULL)}
