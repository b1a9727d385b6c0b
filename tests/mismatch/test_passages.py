"""What acts at reversals acts at nearly all of them."""

import numpy as np
import pytest

from residuum.mismatch.passages import ENOUGH, few


@pytest.mark.parametrize(
    ("gain", "believed"),
    [
        ([3.0] * 20, True),
        ([3.0] * 17 + [-1.0] * 3, True),
        ([14.0, 8.0, 5.0, -4.0, -3.3, -2.0, 1.4, -1.0, 0.6, -0.6], False),
        ([3.0] * 7 + [0.1, -0.2] * 30, True),  # most say nothing
        ([9.0, -2.0, -2.0, -2.0], True),  # too few to tell
    ],
    ids=["all", "nearly all", "a few", "those that tell", "few in all"],
)
def test_a_few_strange_passages_make_no_late_sign(gain, believed) -> None:
    assert (few(np.array(gain)) == "") == believed


def test_noise_at_every_passage_is_believed_as_seldom_as_coins_allow() -> None:
    """Of gains that are as often lost as won, four of five are won by few in a hundred of twenty passages."""
    rng = np.random.default_rng(1)
    said = [few(rng.normal(scale=3.0, size=4 * ENOUGH)) for _ in range(400)]
    assert np.mean([s == "" for s in said]) < 0.05
