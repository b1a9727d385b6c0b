"""The table of built-in functions."""

from __future__ import annotations

import pytest

from residuum.urscript import Version, catalogue
from residuum.urscript.dialect import Dialect
from residuum.urscript.library import library


def test_every_row_is_complete() -> None:
    for builtin in catalogue().values():
        assert builtin.source and builtin.certainty in ("manual", "used", "assumed")
        assert builtin.returns in (
            "none",
            "bool",
            "int",
            "float",
            "number",
            "string",
            "list",
            "pose",
            "matrix",
            "any",
        )
        optional = [formal.optional for formal in builtin.parameters]
        assert optional == sorted(optional), f"{builtin.name}: a required parameter after an optional one"
        assert builtin.timed or not builtin.motion


def test_what_only_computes_is_in_the_table_with_as_many_parameters() -> None:
    for name, function in library(Dialect()).items():
        count = function.__code__.co_argcount if hasattr(function, "__code__") else None
        assert name in catalogue()
        assert count == len(catalogue()[name].parameters), name


@pytest.mark.parametrize(
    ("name", "version", "there"),
    [
        ("get_rtde_value", "5.11", False),
        ("get_rtde_value", "5.23", True),
        ("get_rtde_value", "10.9", False),
        ("get_rtde_value", "10.10", True),
        ("get_mass_matrix", "10.10", False),
        ("get_mass_matrix", "10.11", True),
        ("freedrive_mode", "5.4", True),
        ("set_target_payload", "5.4", False),
        ("set_target_payload", "10.0", True),
        ("transpose", "5.4", False),
        ("read_port_register", "5.4", True),
    ],
)
def test_versions(name: str, version: str, there: bool) -> None:
    assert Version.parse(version).has(catalogue()[name]) is there


def test_defaults_are_the_manuals() -> None:
    movej = {formal.name: formal.default for formal in catalogue()["movej"].parameters}
    assert movej == {"q": None, "a": 1.4, "v": 1.05, "t": 0, "r": 0}
    assert "get_actual_joint_currents" not in catalogue()
