"""The answer in a sentence."""

from residuum.mismatch.sentence import sentence


def finding(effect: str, joint: int, mu: float) -> dict[str, object]:
    return {
        "effect": effect,
        "joints": [joint],
        "parameters": {"A": {"value": mu, "std": 0.01, "unit": "Nm"}},
    }


def test_strong_findings_have_numbers_and_weak_ones_of_a_kind_stand_together() -> None:
    strong = [finding("torque_ripple", j, 0.5) for j in (1, 2, 3, 4)]
    weak = [finding("presliding_hysteresis", j, 0.25) for j in (6, 5)]
    said = sentence("mismatch", [*strong, *weak])
    assert said.count("0.5 ± 0.01 Nm") == 2
    assert "turn on joints 3 and 4; and" in said
    assert "0.25" not in said
    assert sentence("mismatch", strong).count("0.5 ± 0.01 Nm") == 4
    assert "after a reversal on joints 5 and 6." in said
