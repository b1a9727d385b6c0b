"""Physics gains wherever it acts; what one damaged tooth lends it, it gains at that place alone."""

import numpy as np
import pytest

from residuum.mismatch.local import concentrated

N, NOISE = 4000, 1.0
Q = np.random.default_rng(1).uniform(-2, 2, N)


def told(true, fitted, seed: int = 2) -> str:
    """What is said of a hypothesis `fitted` to a torque `true` in noise of one Nm."""
    torque = true + NOISE * np.random.default_rng(seed).normal(size=N)
    change = fitted * (fitted @ torque) / (fitted @ fitted)
    return concentrated(Q, 0.5 * (torque**2 - (torque - change) ** 2), 0.5 * change**2)


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("size", [0.08, 0.3, 1.0])
def test_a_wave_over_the_angle_gains_everywhere(size, seed) -> None:
    assert told(size * np.cos(Q), np.cos(Q), seed=seed) == ""


def test_what_acts_at_one_place_may_gain_there() -> None:
    """As friction does at reversals that are always at the same angle."""
    here = np.exp(-0.5 * ((Q - 0.7) / 0.05) ** 2)
    assert told(here, here) == ""


@pytest.mark.parametrize("at", [-1.3, 0.0, 0.7])
def test_what_a_tooth_lends_to_a_wave_is_told_with_its_place(at) -> None:
    tooth = 3 * np.exp(-0.5 * ((Q - at) / 0.04) ** 2)
    said = told(tooth, np.cos(Q - at - 0.4))
    place = float(said.split(" is at ")[1].split()[0])
    assert place == pytest.approx(at, abs=0.11)
