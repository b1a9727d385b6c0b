"""What is believed: every rule refuses by itself, and one block proves nothing."""

import numpy as np
import pytest

from residuum.mismatch.candidates import Candidate
from residuum.mismatch.judging import EVIDENCE, SHARE, objection
from residuum.mismatch.naming import Scored

HERE = Candidate("stribeck", 1, (0,))


def scored(gain, evidence: float = 100.0, candidate: Candidate = HERE, consistency: float = 4.5) -> Scored:
    return Scored(candidate, np.asarray(gain, float), evidence, np.ones(1), 0.1 * np.ones(1), consistency)


def test_what_passes_every_rule_is_believed() -> None:
    assert objection(scored([9, 11, 10, 12, 8]), 0.3) == ""


@pytest.mark.parametrize(
    ("test", "share", "word"),
    [
        (scored([9, 11, 10], evidence=EVIDENCE - 1), 0.3, "nats"),
        (scored([1, 2, 1, 2]), 0.3, "nats"),
        (scored([60, -3, 1, -2, 3]), 0.3, "steady"),
        (scored([9, 11, 10, 12], consistency=2.9), 0.3, "jackknife"),
        (scored([60, -3, -1, -2, 3], consistency=6.0), 0.3, "improves only"),
        (scored([9, 11, 10, 12]), SHARE / 2, "explains only"),
    ],
    ids=["evidence", "left-out evidence", "one block has it all", "no size", "sure, in few", "too little"],
)
def test_each_rule_refuses(test, share, word) -> None:
    assert word in objection(test, share)


def test_a_sure_size_may_gain_unevenly() -> None:
    """As heat does, which tells in warm blocks alone."""
    uneven = [60.0, -1, 1, -2, 3, 25]
    assert objection(scored(uneven, consistency=6.0), 0.3) == ""
    assert "steady" in objection(scored(uneven, consistency=4.5), 0.3)


def test_what_the_baseline_imitates_may_gain_little_when_nothing_shakes_it() -> None:
    bent = [1.0, 0.5, 1.5, -0.5, 1.0]
    assert objection(scored(bent, evidence=30.0, consistency=9.0), 0.3) == ""
    assert "nats" in objection(scored(bent, evidence=15.0, consistency=9.0), 0.3)
    assert "nats" in objection(scored(bent, evidence=30.0, consistency=7.0), 0.3)


def test_one_block_proves_nothing() -> None:
    """Without a second block there is nothing to be steady over: no name."""
    with np.errstate(all="ignore"):
        alone = scored([100.0], consistency=0.0)
        assert objection(alone, 0.3) != ""
        assert not np.isnan(alone.steadiness)
