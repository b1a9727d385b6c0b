"""Families, outcomes, parameter errors, shares and the report, on answers written by hand."""

import json

import pytest

from residuum.errors import InputError
from residuum.trials.catalogue import CATALOGUE
from residuum.trials.families import ON_A_JOINT, family
from residuum.trials.judging import judge
from residuum.trials.scoring import score, summary
from residuum.trials.sealing import check, seal
from residuum.trials.shares import Share
from residuum.trials.tables import compare, report


def truth(*effects, kind="catalogue", case="001", **fields):
    base = {"case": case, "kind": kind, "robot": "ur5e", "rate": 500, "reference": True}
    base |= {"ratio": [0.1, 0.5], "beside_friction": [1.0, 0.2]}
    return base | {"effects": list(effects)} | fields


def effect(name="stribeck", joints=(2,), size=0.5, **parameters):
    return {"effect": name, "joints": list(joints), "size": size, "parameters": parameters}


def finding(name="stribeck", joints=(2,), rivals=(), **parameters):
    values = {k: {"value": v, "std": None, "unit": ""} for k, v in parameters.items()}
    return {
        "effect": name,
        "joints": list(joints),
        "indistinguishable_from": list(rivals),
        "confidence": 0.9,
        "parameters": values,
    }


def answer(*findings):
    return {"schema": 1, "verdict": "explained", "findings": list(findings)}


@pytest.mark.parametrize(
    ("found", "outcome", "wrong"),
    [
        ([finding()], "right", False),
        ([finding(joints=(3,))], "right", False),
        ([finding("backlash", rivals=["stribeck"])], "right_in_class", False),
        ([finding("backlash")], "wrong", True),
        ([finding(), finding("backlash")], "right", True),
        ([finding("unknown")], "abstained", False),
        ([finding("unknown"), finding()], "right", False),
        ([], "missed", False),
    ],
)
def test_outcomes_of_one_hidden_effect(found, outcome, wrong) -> None:
    verdict = judge(truth(effect()), answer(*found))
    assert (verdict.outcome, verdict.wrong) == (outcome, wrong)


def test_what_comes_along_with_the_hidden_effect_is_neither_wrong_nor_right() -> None:
    slack = effect("backlash") | {"also": ["joint_elasticity"]}
    verdict = judge(truth(slack), answer(finding("joint_elasticity")))
    assert (verdict.outcome, verdict.wrong) == ("right_in_class", False)
    assert judge(truth(slack), answer(finding())).wrong


def test_an_offset_and_an_asymmetry_are_one_family() -> None:
    assert family("current_offset") == family("friction_asymmetry") != family("stribeck")
    verdict = judge(
        truth(effect("current_offset", torque=-0.5)), answer(finding("friction_asymmetry", Fa=0.6))
    )
    assert verdict.right and verdict.joints
    assert verdict.errors == {"current_offset.torque": pytest.approx(0.2)}


def test_joints_are_scored_where_the_effect_sits_on_one() -> None:
    assert judge(truth(effect()), answer(finding())).joints is True
    assert judge(truth(effect()), answer(finding(joints=(2, 3)))).joints is False
    assert judge(truth(effect("payload", ())), answer(finding("payload", (1, 2)))).joints is None


def test_naming_anything_on_a_clean_robot_or_outside_the_catalogue_is_wrong() -> None:
    outside = effect("outside.tooth_defect")
    for hidden, kind in (((), "clean"), ((outside,), "outside")):
        assert judge(truth(*hidden, kind=kind), answer(finding())).wrong
        assert judge(truth(*hidden, kind=kind), answer(finding())).outcome == "named"
        assert judge(truth(*hidden, kind=kind), answer(finding("unknown"))).outcome == "abstained"
        assert judge(truth(*hidden, kind=kind), answer()).outcome == "clean"


def test_two_hidden_effects_count_one_by_one() -> None:
    two = truth(effect(), effect("payload", (), 2.0, mass=1.0))
    verdict = judge(two, answer(finding("payload", (1, 2, 3), mass=1.1), finding()))
    assert verdict.found == 2 and not verdict.wrong and verdict.size == 2.0
    assert verdict.errors == {"payload.mass": pytest.approx(0.1)}


@pytest.mark.parametrize(
    ("name", "true", "found", "error"),
    [
        ("payload", {"centre_of_mass": [0, 0, 0.1]}, {"centre_of_mass": [0, 0.01, 0.1]}, 0.1),
        ("encoder_offset", {"offset": 0.01}, {"offset": -0.011}, 0.1),
        ("position_dependent_friction", {"sine": 3, "cosine": 4}, {"A": 5.0, "B": 0.0}, 0.0),
        ("torque_ripple", {"torque": [0.3, 0.1]}, {"A": 0.0, "B": 0.33}, 0.1),
        ("base_tilt", {"roll": 0.03, "pitch": 0.04}, {"roll": 0.05, "pitch": 0.0}, 0.0),
        ("load_dependent_friction", {"mu": 0.05}, {"mu": -0.05}, 2.0),
    ],
)
def test_parameters_are_compared_by_meaning(name, true, found, error) -> None:
    (value,) = judge(
        truth(effect(name, (2,), 0.5, **true)), answer(finding(name, (2,), **found))
    ).errors.values()
    assert value == pytest.approx(error, abs=1e-9)


@pytest.mark.parametrize(
    ("size", "bin"), [(0.16, 0.2), (0.3, 0.35), (0.45, 0.5), (0.7, 0.5), (0.8, 1.0), (9, 1.0)]
)
def test_sizes_fall_into_the_nearest_bin(size, bin) -> None:
    assert judge(truth(effect(size=size)), answer()).bin == bin


def test_what_is_visible_depends_on_the_reference() -> None:
    assert judge(truth(effect()), answer()).visible == 0.5
    assert judge(truth(effect(), reference=False), answer()).visible == pytest.approx(0.1)
    assert judge(truth(kind="clean", ratio=[0.0], beside_friction=[]), answer()).visible == 0.0


def test_wilson_as_published() -> None:
    """Newcombe 1998, table I: 81/263 is 0.2553-0.3662, 0/20 is 0-0.1611."""
    assert Share(81, 263).interval == pytest.approx((0.2553, 0.3662), abs=5e-5)
    assert Share(0, 20).interval == pytest.approx((0.0, 0.1611), abs=5e-5)
    assert Share(0, 0).interval == (0.0, 1.0)


def test_only_catalogue_names_are_on_a_joint() -> None:
    assert set(CATALOGUE) >= ON_A_JOINT


def test_an_empty_trial_has_a_report() -> None:
    assert "0 cases" in report(summary([]))


def written(out, cases):
    for name in ("sealed", "answers"):
        (out / name).mkdir()
    for k, (sealed, found) in enumerate(cases, 1):
        (out / "sealed" / f"{k:03d}.json").write_text(json.dumps(sealed | {"case": f"{k:03d}"}))
        (out / "answers" / f"{k:03d}.json").write_text(json.dumps(found))


def test_the_score_is_written_with_all_its_tables(tmp_path) -> None:
    named = (truth(effect(torque=1.0)), answer(finding(Fs=1.1)))
    written(tmp_path, [named, (truth(kind="clean"), answer()), (truth(kind="clean"), answer(finding()))])
    seal(tmp_path)
    found = score(tmp_path)
    assert found["clean"]["all"]["named"]["share"] == 0.5
    assert found["catalogue"]["size"]["0.5"]["right"]["count"] == 1
    assert found["parameters"]["all"]["median"] == pytest.approx(0.1)
    assert found["confidence"]["0.8-0.95"]["share"] == 0.5
    assert len((tmp_path / "cases.csv").read_text().splitlines()) == 4
    text = (tmp_path / "score.md").read_text()
    assert "| stribeck | stribeck 1 |" in text and "100 % (1/1; 21-100)" in text
    assert compare({"ours": found}).count("\n") == 3


def test_a_broken_seal_is_said(tmp_path) -> None:
    written(tmp_path, [(truth(effect()), answer(finding()))])
    with pytest.raises(InputError, match="never sealed"):
        check(tmp_path)
    seal(tmp_path)
    check(tmp_path)
    (tmp_path / "sealed" / "001.json").write_text(json.dumps(truth(kind="clean")))
    with pytest.raises(InputError, match="not those that were sealed"):
        score(tmp_path)
