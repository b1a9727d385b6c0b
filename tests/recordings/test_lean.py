"""What a fit needs of a recording, and its rate."""

import numpy as np
import pytest

from residuum.recordings import Recording


def made(time) -> Recording:
    two = np.zeros((len(time), 2))
    return Recording(
        "r", time, two, two, qd=two, target_q=two, target_qd=two, target_moment=two, joint_temperatures=two,
        others={"robot_mode": np.zeros(len(time))},
    )  # fmt: skip


def test_lean_keeps_what_fits_use() -> None:
    lean = made(np.arange(5.0)).lean()
    assert set(lean.arrays()) == {"timestamp", "q", "current", "qd", "target_qd", "joint_temperatures"}
    assert (lean.others, lean.dropped, len(lean)) == ({}, (), 5)


def test_the_rate_is_that_of_the_median_step() -> None:
    assert made(np.array([0.0, 0.1, 0.2, 0.9, 1.0])).rate == pytest.approx(10.0)
    assert made(np.zeros(1)).rate == 0.0
