"""`residuum explain` from files to answer, on simulated recordings, and what its model generates."""

import json
import subprocess
import tomllib
from pathlib import Path

import numpy as np
import pytest
from answers import FILES, check, findings, names
from commands import gen_model, residuum
from json_schema import problems

from residuum.codegen.load import STRICT_FLAGS, c_compiler, load_text
from residuum.recordings import read
from residuum.urscript import parse

pytestmark = pytest.mark.slow

SCHEMA = Path(__file__).resolve().parents[3] / "shared" / "findings.schema.json"
KINDS = ("clean", "payload", "load", "gain", "asymmetry")


@pytest.fixture(scope="session")
def answer(simulated, tmp_path_factory):
    """Kind -> folder of the answer to two recordings of it, with two of the healthy robot."""
    folder, made = tmp_path_factory.mktemp("answers"), {}
    reference = [x for seed in (1, 2) for x in ("--reference", simulated("clean", seed))]

    def of(kind: str) -> Path:
        if kind not in made:
            done = residuum(
                "explain", simulated(kind, 3), simulated(kind, 4), *reference, "--out", folder / kind
            )
            assert (done.returncode, done.stderr) == (0, ""), done.stderr
            made[kind] = folder / kind
        return made[kind]

    return of


def only(folder: Path, name: str) -> dict:
    """The strongest finding, which has to be this name."""
    found = findings(folder)["findings"]
    assert found and found[0]["effect"] == name, [f["effect"] for f in found]
    return found[0]


def near(quantity: dict, truth: float, deviations: float = 3.0) -> bool:
    return abs(quantity["value"] - truth) < deviations * quantity["std"]


@pytest.mark.parametrize("kind", KINDS)
def test_the_answer_has_the_contracts_form(answer, kind) -> None:
    assert {p.name for p in answer(kind).iterdir()} >= FILES
    check(findings(answer(kind)))


@pytest.mark.parametrize("kind", KINDS)
def test_the_answer_keeps_the_json_schema(answer, kind) -> None:
    if not SCHEMA.exists():
        pytest.skip("the contract's schema is not beside this checkout")
    assert problems(findings(answer(kind)), json.loads(SCHEMA.read_text())) == []


def test_nothing_has_changed_and_nothing_is_named(answer) -> None:
    found = findings(answer("clean"))
    assert (found["verdict"], found["findings"]) == ("nothing_missing", [])


def test_a_payload_and_its_numbers(answer) -> None:
    found = only(answer("payload"), "payload")
    assert found["joints"] == [1, 2, 3, 4, 5, 6]
    numbers = found["parameters"]
    assert near(numbers["mass"], 2.0)
    assert numbers["mass"]["std"] >= 0.02 * numbers["mass"]["value"]  # gains are no better known
    centre = numbers["centre_of_mass"]
    np.testing.assert_allclose(centre["value"], [0.0, 0.02, 0.05], atol=0.003)


def test_friction_that_grows_with_the_load(answer) -> None:
    found = only(answer("load"), "load_dependent_friction")
    assert found["joints"] == [2]
    assert found["parameters"]["mu"]["value"] == pytest.approx(0.1, rel=0.1)


def test_a_drive_gain(answer) -> None:
    """The catalogue has torque = (1 + e) K i."""
    found = only(answer("gain"), "drive_gain")
    assert found["joints"] == [3]
    assert found["parameters"]["error"]["value"] == pytest.approx(0.2, rel=0.1)


def test_asymmetry_without_rest_is_a_class_with_the_offset(answer) -> None:
    found = findings(answer("asymmetry"))["findings"][0]
    assert found["joints"] == [1]
    assert "friction_asymmetry" in {found["effect"], *found["indistinguishable_from"]}
    assert "current_offset" in {found["effect"], *found["indistinguishable_from"]}
    assert found["next_motion"]


@pytest.mark.parametrize("kind", ["payload", "load", "gain", "asymmetry"])
def test_one_change_is_one_finding(answer, kind) -> None:
    assert len(names(findings(answer(kind)))) == 1, names(findings(answer(kind)))


@pytest.mark.parametrize("kind", ["payload", "load", "gain", "asymmetry"])
def test_left_out_error_falls_on_the_joints_that_are_named(answer, kind) -> None:
    found = findings(answer(kind))
    fit = found["fit"]
    j = found["findings"][0]["joints"][-1] - 1
    assert fit["after"][j] < 0.8 * fit["before"][j]
    low, high = fit["after_interval95"][j]
    assert low <= fit["after"][j] <= high


@pytest.fixture(scope="session")
def generated_from(answer, tmp_path_factory):
    """Kind -> folder that gen-model writes from the answer's model.toml."""
    made = {}

    def of(kind: str) -> Path:
        if kind not in made:
            out = tmp_path_factory.mktemp(f"generated_{kind}")
            done = gen_model("--model", answer(kind) / "model.toml", "--out", out)
            assert done.returncode == 0, done.stderr
            (made[kind],) = out.iterdir()
        return made[kind]

    return of


@pytest.mark.parametrize("kind", ["payload", "load", "gain"])
def test_the_refined_model_becomes_numpy_c_and_urscript(generated_from, tmp_path, kind) -> None:
    folder = generated_from(kind)
    load_text((folder / "observer.py").read_text())
    parse((folder / "collision_guard.script").read_text())
    if c_compiler() is None:
        pytest.skip("no C compiler")
    done = subprocess.run(
        [c_compiler(), *STRICT_FLAGS, "-c", folder / "observer.c", "-o", tmp_path / "observer.o"],
        capture_output=True,
        text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(("kind", "joints"), [("payload", (0, 1, 2, 3, 4)), ("load", (1,)), ("gain", (2,))])
def test_the_refined_observer_leaves_less_than_the_nominal_one(
    generated_from, generated, simulated, kind, joints
) -> None:
    """Where the reference's refined model is the healthy robot's, the changed robot's own is better yet."""
    recording = read(simulated(kind, 3))
    left = {}
    texts = {
        "nominal": generated("ur5e", 6).files["observer.py"],
        "healthy": (generated_from("clean") / "observer.py").read_text(),
        "refined": (generated_from(kind) / "observer.py").read_text(),
    }
    for name, text in texts.items():
        observer = load_text(text).Observer(dt=0.008)
        found = observer.run(recording.q, recording.qd, recording.current, recording.joint_temperatures)
        left[name] = np.sqrt(np.mean(found[125:] ** 2, axis=0))
    for j in joints:
        assert left["refined"][j] < left["healthy"][j] < left["nominal"][j]
    assert left["refined"][joints[-1]] < 0.8 * left["healthy"][joints[-1]]


def test_the_model_says_where_it_is_from(answer) -> None:
    model = tomllib.loads((answer("payload") / "model.toml").read_text())
    inputs = {i["name"] for i in model["inputs"]}
    assert {"payload_3.csv", "payload_4.csv", "clean_1.csv", "clean_2.csv"} <= inputs
    assert "covariance" in model


def test_the_same_files_give_the_same_answer(simulated, tmp_path) -> None:
    texts = []
    for k in range(2):
        done = residuum(
            "explain", simulated("gain", 3), "--reference", simulated("clean", 1), "--out", tmp_path / str(k)
        )
        assert done.returncode == 0, done.stderr
        texts.append([(tmp_path / str(k) / name).read_bytes() for name in ("findings.json", "model.toml")])
    assert texts[0] == texts[1]
