"""examples/thesis_riddles.py, and that docs/thesis_riddles.md does not promise more than it prints."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLE = Path(__file__).parent.parent / "examples" / "thesis_riddles.py"
WRIST = 3.035  # kg, links 4 to 6


@pytest.fixture(scope="module")
def said(tmp_path_factory):
    """What it prints, for the plain arm and for the one with load-dependent friction."""
    out = tmp_path_factory.mktemp("riddles")
    done = subprocess.run(
        [sys.executable, str(EXAMPLE), "--out", str(out)], capture_output=True, text=True, timeout=1200
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert (out / "plain.png").stat().st_size > 10_000
    return done.stdout.split("\nload_friction.")


def table(text: str) -> dict[str, tuple[float, float, list[float]]]:
    """Model -> alpha of joints 2 and 3 (Nm/rad), and what joint 1's inertia lacks by reach (kg m^2)."""
    found = {}
    for line in text.splitlines():
        name = next(
            (n for n in ("thesis", "links 1-3", "all links", "explained") if line.startswith(n)), None
        )
        if name and " m " in line:
            alpha = re.findall(r"[+-]\d+\.\d\d", line)
            found[name] = float(alpha[0]), float(alpha[1]), [float(x) for x in alpha[2:]]
    return found


@pytest.mark.slow
@pytest.mark.parametrize("arm", [0, 1])
def test_the_riddles_are_the_missing_links(said, arm) -> None:
    seen = table(said[arm])
    for name in ("thesis", "links 1-3"):
        a2, a3, lacks = seen[name]
        assert a2 > 4 and a3 < -4
        assert lacks[-1] > lacks[0] + 1.5
    for name in ("all links", "explained"):
        a2, a3, lacks = seen[name]
        assert abs(a2) < 0.1 and abs(a3) < 0.1
        assert max(map(abs, lacks)) < 0.15
    assert seen["thesis"][2][-1] > seen["links 1-3"][2][-1] + 0.5  # all mass at the total centre of mass


@pytest.mark.slow
@pytest.mark.parametrize("arm", [0, 1])
def test_the_refined_model_has_their_mass(said, arm) -> None:
    mass = float(re.search(r"has ([\d.]+) kg more beyond the elbow", said[arm])[1])
    assert mass == pytest.approx(WRIST, rel=0.03)


@pytest.mark.slow
@pytest.mark.parametrize("arm", [0, 1])
def test_explain_names_the_load_and_the_coupling(said, arm) -> None:
    mass, std = map(float, re.search(r"payload on \[1, 2, 3\].*mass ([\d.]+) ± ([\d.]+)", said[arm]).groups())
    assert abs(mass - WRIST) < std
    share, std = map(
        float, re.search(r"dropped_coupling on \[1, 2, 3\].*share ([\d.]+) ± ([\d.]+)", said[arm]).groups()
    )
    assert abs(share - 1.0) < 0.1 and std < 0.1


@pytest.mark.slow
@pytest.mark.parametrize("arm", [0, 1])
def test_explain_names_nothing_that_is_not_there(said, arm) -> None:
    drag = {"nonlinear_viscous"}  # of the factory sheet
    known = {"payload", "dropped_coupling", "load_dependent_friction"} | drag
    assert set(re.findall(r"^  (\w+) on \[", said[arm], re.M)) <= known
    assert ("load_dependent_friction" in said[arm].partition("explain, told")[2]) == bool(arm)


@pytest.mark.slow
def test_explain_names_load_dependent_friction(said) -> None:
    sizes = re.findall(r"load_dependent_friction on \[[23]\].*mu ([\d.]+)", said[1])
    assert len(sizes) == 4  # joints 2 and 3, under both models
    assert all(float(x) == pytest.approx(0.08, rel=0.1) for x in sizes)
