"""The whole chain, as examples/whole_chain.py runs it: files and sockets between processes, nothing else."""

import json
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parent.parent / "examples"


@pytest.fixture(scope="module")
def chain(tmp_path_factory):
    """The folder of a finished chain of six joints, and what it printed."""
    out = tmp_path_factory.mktemp("chain")
    done = subprocess.run(
        [sys.executable, str(EXAMPLES / "whole_chain.py"), "--out", str(out)],
        capture_output=True, text=True, timeout=1200,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    return out, done.stdout


@pytest.mark.slow
def test_a_step_a_line_and_a_freedrive_at_the_end(chain) -> None:
    _, said = chain
    steps = [line.split("  ")[0] for line in said.splitlines()]
    assert steps[:4] == [f"record {name} {k}" for name in ("healthy", "changed") for k in (1, 2)]
    assert steps[4:8] == ["fit", "explain", "gen-model before", "gen-model after"]
    assert said.count("0 lost, 0 repeated") == 4
    assert "changed arm, old guard" in said and "refused" in said
    assert "measuring -> guarding -> stopping -> freedrive" in said


@pytest.mark.slow
def test_payload_and_friction_are_named_with_their_size(chain) -> None:
    answer = json.loads((chain[0] / "answer" / "findings.json").read_text())
    named = {f["effect"]: f for f in answer["findings"]}
    mass = named["payload"]["parameters"]["mass"]
    assert abs(mass["value"] - 2.5) < 2 * mass["std"]
    friction = named["coulomb_friction"]
    assert friction["joints"] == [2]
    assert friction["parameters"]["Fc"]["value"] == pytest.approx(3.0, abs=0.15)


@pytest.mark.slow
def test_the_generated_guard_is_that_of_the_explained_model(chain) -> None:
    out, _ = chain
    model = tomllib.loads((out / "after" / "ur5e_dof6" / "model.toml").read_text())
    healthy = tomllib.loads((out / "healthy.toml").read_text())
    added = model["base"]["MX2"]["value"] - healthy["base"]["MX2"]["value"]
    assert added == pytest.approx(-0.425 * 2.5, rel=0.1)  # the payload hangs beyond the upper arm
    assert (out / "after" / "ur5e_dof6" / "collision_guard.script").stat().st_size > 10_000


@pytest.mark.slow
def test_a_step_that_fails_ends_it_with_one_line(tmp_path) -> None:
    done = subprocess.run(
        [sys.executable, str(EXAMPLES / "whole_chain.py"), "--out", str(tmp_path), "--seconds", "-1"],
        capture_output=True, text=True, timeout=300,
    )  # fmt: skip
    assert done.returncode == 1
    assert done.stderr.startswith("failed: residuum record") and done.stderr.count("\n") == 1
