"""The four commands as a user types them, on the real ports."""

import pytest
from commands import residuum
from virtual_robot import fixed_ports, serving

from residuum.recordings import read


@pytest.fixture(scope="module")
def served():
    with fixed_ports(), serving() as process:
        yield process


def test_record(served, tmp_path) -> None:
    out = tmp_path / "run.csv"
    done = residuum("record", "--host", "127.0.0.1", "--seconds", "1", "--out", str(out))
    assert (done.returncode, done.stderr) == (0, "")
    assert "500 rows at 500 Hz, 0.998 s of the robot's time, 0 lost, 0 repeated" in done.stdout
    assert len(read(out)) == 500


def test_upload(served, tmp_path) -> None:
    script = tmp_path / "a.script"
    script.write_text("def a():\n  while True:\n    sync()\n  end\nend\n")
    done = residuum("upload", str(script), "--host", "127.0.0.1")
    assert (done.returncode, done.stdout, done.stderr) == (0, "a started on 127.0.0.1\n", "")
    script.write_text("def a():\n  x = 1 +\nend\n")
    done = residuum("upload", str(script), "--host", "127.0.0.1")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith(f"{script}: line ") and done.stderr.count("\n") == 1


def test_monitor(served) -> None:
    done = residuum("monitor", "--host", "127.0.0.1", "--seconds", "1.2")
    assert (done.returncode, done.stderr) == (0, "")
    assert "external torque, Nm" in done.stdout
    assert ", 0 lost, 0 detection(s)" in done.stdout
