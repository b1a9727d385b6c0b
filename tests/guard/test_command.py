"""gen-model's options for the guard, as a user meets them."""

import pytest
from click.testing import CliRunner

from residuum.cli.gen_model import gen_model, main
from residuum.urscript import check


def run_main(monkeypatch, capsys, *arguments: object) -> tuple[int, str]:
    """Run the installed command; return its exit code and stderr."""
    monkeypatch.setattr("sys.argv", ["gen-model", *map(str, arguments)])
    with pytest.raises(SystemExit) as ended:
        main()
    return int(ended.value.code or 0), capsys.readouterr().err


def test_options_reach_the_program(tmp_path) -> None:
    motion = tmp_path / "work.script"
    motion.write_text("def work():\n  movej([0.0, -1.57, 0.0, 0.0, 0.0, 0.0])\nend\n")
    arguments = ["--dof", "1", "--out", str(tmp_path), "--motion", str(motion), "--detector", "vote"]
    arguments += ["--current-source", "rtde", "--polyscope", "10.11", "--reaction", "retract"]
    done = CliRunner().invoke(gen_model, [*arguments, "--resume", "digital:2", "--payload", "0.7"])
    assert done.exit_code == 0, done.output
    text = (tmp_path / "ur5e_dof1" / "collision_guard.script").read_text()
    assert [d for d in check(text, "10.11") if d.severity != "note"] == []
    for words in (
        "movej([0.0, -1.57",
        "get_standard_digital_in(2)",
        "rs_payload = 0.7",
        "speedj(away",
        "rs_votes",
    ):
        assert words in text
    assert (tmp_path / "ur5e_dof1" / "probe.script").read_text().startswith("def probe():\n")
    assert (tmp_path / "ur5e_dof1" / "snapshot.script").read_text().startswith("sec snapshot():\n")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--motion", "MOTION"], "work.script:2:7: "),
        (["--motion", "nowhere.script"], "--motion nowhere.script: No such file"),
        (["--current-source", "rtde", "--polyscope", "5.11"], "use modbus, or --polyscope 5.23"),
        (["--polyscope", "3.15"], "--polyscope: PolyScope 3.15 is not supported"),
        (["--resume", "register:5"], "--resume register:5: give register:64"),
    ],
)
def test_bad_input_is_one_line_and_writes_nothing(arguments, words, tmp_path, monkeypatch, capsys) -> None:
    motion = tmp_path / "work.script"
    motion.write_text("def work():\n  x = unknown_function()\n  sync()\nend\n")
    arguments = [str(motion) if x == "MOTION" else x for x in arguments]
    code, err = run_main(monkeypatch, capsys, "--dof", 1, "--out", tmp_path / "out", *arguments)
    assert code == 2
    assert words in err and len(err.strip().splitlines()) == 1
    assert not (tmp_path / "out").exists()


def test_a_binary_motion_is_refused(tmp_path, monkeypatch, capsys) -> None:
    motion = tmp_path / "work.urp"
    motion.write_bytes(b"\x1f\x8b\x08\xff")
    code, err = run_main(monkeypatch, capsys, "--dof", 1, "--out", tmp_path / "out", "--motion", motion)
    assert code == 2 and "is no text" in err
