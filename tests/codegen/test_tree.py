"""The checked-in trees are gen-model's output, to the byte, whatever the machine's hash seed."""

import importlib
import os
from pathlib import Path

import pytest
from commands import gen_model

from residuum.codegen.check import TOLERANCE, worst_disagreement
from residuum.codegen.generate import generate, model_toml
from residuum.robots import load_robot
from residuum.robots.model import Model
from residuum.robots.toml import parse
from residuum.symbolic.nominal import nominal_model

ROOT = Path(__file__).resolve().parents[2]
REMEDY = "run `make generated` and commit what changed"


@pytest.mark.parametrize("dof", [3, 6])
def test_checked_in_tree_is_current(dof, tmp_path) -> None:
    gen_model("--dof", dof, "--out", tmp_path, check=True)
    fresh = {p.name: p.read_bytes() for p in (tmp_path / f"ur5e_dof{dof}").iterdir()}
    folder = ROOT / "generated" / f"ur5e_dof{dof}"
    kept = {p.name: p.read_bytes() for p in folder.iterdir() if p.is_file()}
    assert sorted(fresh) == sorted(kept), REMEDY
    for name, text in fresh.items():
        assert text == kept[name], f"{folder.name}/{name}: {REMEDY}"


def test_output_does_not_depend_on_the_hash_seed(tmp_path) -> None:
    trees = []
    for seed in ("1", "2"):
        machine = os.environ | {"PYTHONHASHSEED": seed}
        gen_model("--dof", 4, "--robot", "ur10e", "--out", tmp_path / seed, env=machine, check=True)
        trees.append({p.name: p.read_bytes() for p in (tmp_path / seed / "ur10e_dof4").iterdir()})
    assert trees[0] == trees[1]


@pytest.mark.parametrize("dof", [3, 6])
def test_checked_in_tree_is_importable(dof) -> None:
    module = importlib.import_module(f"residuum.generated.ur5e_dof{dof}.observer")
    assert dof == module.DOF
    assert module.Observer(gain=30.0, dt=0.002).dt == 0.002


@pytest.mark.parametrize("variant", ["full", "thesis"])
def test_model_toml_leads_back_to_the_same_code(variant) -> None:
    model = nominal_model(*load_robot("ur5e"), 3, variant=variant)
    again = parse(Model, model_toml(model), "model.toml")
    assert again == model
    assert generate(again).files == generate(model).files


@pytest.mark.parametrize(("dof", "variant"), [(2, "full"), (3, "thesis"), (6, "full")])
def test_self_check_passes_and_notices_a_wrong_sign(dof, variant, generated) -> None:
    tree = generated("ur5e", dof, variant)
    text = tree.files["observer.py"]
    assert worst_disagreement(tree.model, text) < TOLERANCE
    place = text.index("def _beta(")
    wrong = text[:place] + text[place:].replace("np.cos(", "-np.cos(", 1)
    assert worst_disagreement(tree.model, wrong) > 1e-3


def test_equations_are_readable_at_three_joints(generated) -> None:
    page = generated("ur5e", 3).files["model.md"]
    assert r"$$M_{33} = \mathit{IA}_{3} + \mathit{ZZ}_{3}$$" in page
    assert r"$$\beta_{1} = 0$$" in page
    assert "kg m^2" in page
    assert "Hash of the inputs" in page


def test_no_line_of_the_page_is_longer_than_an_equation_can_be(generated) -> None:
    for dof, variant in ((3, "full"), (3, "thesis"), (6, "full")):
        assert max(map(len, generated("ur5e", dof, variant).files["model.md"].splitlines())) < 1500
