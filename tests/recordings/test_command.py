import json

import pytest
from click.testing import CliRunner

from residuum.cli.audit import audit


def run(*arguments):
    return CliRunner().invoke(audit, [str(a) for a in arguments], catch_exceptions=False)


def test_a_good_file(make, write):
    result = run(write(make(seconds=3)))
    assert result.exit_code == 0
    assert "good" in result.stdout
    assert result.stderr == ""


def test_dropped_rows_are_named_and_the_file_is_usable(make, changed, write):
    result = run(write(changed(make(seconds=3), current=((5, 0), 1e9))))
    assert result.exit_code == 0
    assert "row 7" in result.stdout


def test_refused_and_unreadable_files_give_one_line_each(make, write, tmp_path):
    made = make(seconds=20)
    turned = write(made.take(slice(None)), "ok.csv")
    bad = write(made.take(slice(0, 4)), "short.csv")
    result = run(turned, bad, tmp_path / "none.csv")
    assert result.exit_code == 2
    lines = result.stderr.splitlines()
    assert len(lines) == 2
    assert "short.csv" in lines[0]
    assert "none.csv" in lines[1]


def test_json_of_all_files(make, write, tmp_path):
    result = run("--json", write(make(seconds=3)), tmp_path / "none.csv")
    first, second = json.loads(result.stdout)
    assert first["verdict"] == "good"
    assert second["verdict"] == "refuse"
    assert result.exit_code == 2


def test_help_has_an_example():
    assert "Example: residuum audit" in run("--help").stdout


@pytest.mark.parametrize("damage", [False, True])
def test_plot(make, changed, write, tmp_path, damage):
    made = changed(make(seconds=3), q=((5, 0), 1e300)) if damage else make(seconds=3)
    picture = tmp_path / "o.png"
    assert run(write(made), "--plot", picture).exit_code == 0
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_plot_that_cannot_be_written(make, write, tmp_path):
    result = run(write(make(seconds=3)), "--plot", tmp_path / "no" / "o.png")
    assert result.exit_code == 2
    assert len(result.stderr.splitlines()) == 1
