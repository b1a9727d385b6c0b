"""Real UR10e recordings: friction that grows with the load, not its impostor; a load that is known."""

from html import unescape

import pytest
from answers import check, findings
from commands import residuum

from residuum.mismatch.report.wording import title

pytestmark = pytest.mark.slow

MASS = 2.602  # kg, weighed by those who recorded


@pytest.fixture(scope="module")
def unloaded(real_recordings):
    return sorted((real_recordings / "ur10e").glob("unloaded_*.csv"))


@pytest.fixture(scope="module")
def without_load(unloaded, tmp_path_factory):
    out = tmp_path_factory.mktemp("unloaded") / "o"
    done = residuum("explain", *unloaded, "--robot", "ur10e", "--out", out)
    assert done.returncode == 0, done.stderr
    return out


@pytest.fixture(scope="module")
def with_load(real_recordings, unloaded, tmp_path_factory):
    out = tmp_path_factory.mktemp("loaded") / "o"
    loaded = real_recordings / "ur10e" / "loaded_2602g_same_path_as_unloaded_03.csv"
    reference = [x for path in unloaded for x in ("--reference", path)]
    done = residuum("explain", loaded, *reference, "--robot", "ur10e", "--out", out)
    assert done.returncode == 0, done.stderr
    return out


def named(folder) -> list[tuple[str, list[int]]]:
    return [(f["effect"], f["joints"]) for f in findings(folder)["findings"]]


def test_load_dependent_friction_on_joints_2_and_3_comes_first(without_load) -> None:
    check(findings(without_load))
    found = named(without_load)
    assert [f for f, _ in found[:2]] == ["load_dependent_friction"] * 2, found
    assert {j for _, joints in found[:2] for j in joints} == {2, 3}


def test_its_coefficients_are_plausible(without_load) -> None:
    for f in findings(without_load)["findings"]:
        if f["effect"] == "load_dependent_friction":
            assert 0.02 <= f["parameters"]["mu"]["value"] <= 0.15


def test_the_impostor_is_ruled_out(without_load) -> None:
    """Position-dependent friction improves joint 2 on all runs, and nothing once the load is in."""
    assert "position_dependent_friction" not in {f for f, _ in named(without_load)}
    page = unescape((without_load / "report.html").read_text())
    assert title("position_dependent_friction").lower() in page.lower()


def test_nobody_touched_the_unloaded_arm(without_load) -> None:
    """Nor did its gains change between runs: the published ones are not known to better than 15 %."""
    assert {f for f, _ in named(without_load)}.isdisjoint({"external_contact", "payload", "drive_gain"})


@pytest.mark.parametrize("run", [0, 2], ids=["on a path of the reference", "on a path of its own"])
def test_how_recordings_differ_anyway_is_no_change(unloaded, run, tmp_path) -> None:
    """Friction of this arm is another in each recording: by itself that is not what changed."""
    reference = [x for k, path in enumerate(unloaded) if k != run for x in ("--reference", path)]
    done = residuum("explain", unloaded[run], *reference, "--robot", "ur10e", "--out", tmp_path / "o")
    assert done.returncode == 0, done.stderr
    assert named(tmp_path / "o") == []
    elsewhere = "a reference on the same path would show" in done.stdout + done.stderr
    assert elsewhere == (run == 2)


def test_the_known_load_is_in_the_interval(with_load) -> None:
    check(findings(with_load))
    first = findings(with_load)["findings"][0]
    assert first["effect"] == "payload", named(with_load)
    mass = first["parameters"]["mass"]
    low, high = (mass["value"] + k * mass["std"] for k in (-1.96, 1.96))
    assert low <= MASS <= high
    assert high - low < 0.6 * MASS  # an interval that says something
    centre = first["parameters"]["centre_of_mass"]
    assert all(abs(x) < 0.3 for x in centre["value"])
