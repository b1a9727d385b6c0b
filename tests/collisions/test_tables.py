"""Tables and page from made-up rows: means, brackets, dashes; and what the hour counts."""

import csv
import io

import numpy as np
import pytest

from residuum.collisions import tables
from residuum.collisions.campaign import Row, spread
from residuum.collisions.cells import Cell
from residuum.collisions.free_hour import MOTIONS, Quiet, _count, hour, path
from residuum.collisions.page import html, page
from residuum.collisions.run import Figures


def row(joint: int, pace: str, strategy: int, delay: float, impulse: float) -> Row:
    figures = Figures(delay, impulse, 0.1 * strategy, 20.0, False, joint)
    return Row(Cell(joint, pace), strategy, "thesis", "refined", figures, 10.0)


@pytest.fixture
def rows():
    return [row(j, p, s, 0.02, 3.0 / s) for j in (1, 2, 3) for p in ("slow", "fast") for s in (1, 2, 3)]


def test_tables_hold_ours_and_theirs(rows) -> None:
    text = tables.thesis_tables(rows)
    assert (
        "| 1 | 3.00 (3.46) | 1.50 (0.71) | 1.00 (1.14) | 100 (168) | 200 (440) | 300 (800) | 20 (136) | 232 / 96 |"
        in text
    )
    assert "**20.0** (145) | 336 / 228" in text
    assert "at most half" in tables.verdict(rows)
    assert "S3 < S2 < S1 | S2 < S3 < S1 | S1 < S2 < S3 | S1 < S2 < S3" in tables.ordering(rows)


def test_no_detection_is_a_dash_and_is_counted(rows) -> None:
    rows = [*rows, row(1, "slow", 1, np.nan, np.nan)]
    assert "19 runs: 18 detected after contact, 0 alarms before it, 1 without detection." in tables.verdict(
        rows
    )
    last = list(csv.DictReader(io.StringIO(tables.runs_csv(rows))))[-1]
    assert (last["delay"], last["impulse"], last["detecting_joint"]) == ("", "", "1")


def test_beyond_counts_each_group(rows) -> None:
    text = tables.beyond_table(rows)
    assert "| foam | warm | refined | thesis | 18 | 0 | 0 | 20 | 20 | 20 | 20 |" in text


def test_alarms_a_second_apart_are_two() -> None:
    score = np.zeros((3000, 2))
    score[[500, 502, 1500], 0] = 1.5
    quiet = _count({"static": score})
    assert quiet.alarms == {"static": 2} and quiet.peak == {"static": 1.5}


def test_the_motion_of_a_minute_is_a_minute(robot) -> None:
    for motion in MOTIONS:
        made = path(robot, motion, 3)
        assert 50.0 < made.duration < 70.0
        assert np.abs(made.qd[[0, -1]]).max() < 1e-6


def test_an_hour_resumes_from_its_pieces(robot, seen, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("residuum.collisions.free_hour.PIECE", 4.0)
    monkeypatch.setattr("residuum.collisions.free_hour.MOTIONS", ("thesis",))
    once = hour(robot, (seen,), 2, tmp_path, 1)
    assert len(list(tmp_path.glob("*.json"))) == 2
    monkeypatch.setattr("residuum.collisions.free_hour.piece", None)
    again = hour(robot, (seen,), 2, tmp_path, 1)
    assert again == once
    assert again["thesis", "test"].hours > 0.001
    assert "| thesis | test | static |" in tables.hour_table(again)


def test_the_page_needs_nothing_from_elsewhere(rows) -> None:
    text = page("# Title\n\n| a | b |\n|---|---|\n| 1 | <2> |\n", rows, {})
    assert "<h1>Title</h1>" in text and "<td>&lt;2&gt;</td>" in text
    assert "<script src=" not in text and '<link rel="stylesheet"' not in text
    assert html("plain **bold**") == "<p>plain bold</p>"


def test_spread_keeps_the_order() -> None:
    assert spread([lambda k=k: k for k in range(5)], 1, lambda _a, _b: None) == [0, 1, 2, 3, 4]


def test_quiet_adds() -> None:
    total = Quiet()
    total.add(Quiet(0.5, {"a": 1}, {"a": 0.9}))
    total.add(Quiet(0.5, {"a": 2}, {"a": 1.2}))
    assert (total.hours, total.alarms, total.peak) == (1.0, {"a": 3}, {"a": 1.2})
