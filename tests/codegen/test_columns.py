"""Columns of every catalogue term: against plain Python, sample by sample, and against differences."""

import time

import numpy as np
import pytest
from terms_by_hand import motion, parameters, torque_by_hand

from residuum.codegen.columns import columns, states
from residuum.symbolic.terms import CATALOGUE

STATEFUL = [name for name, term in CATALOGUE.items() if term.state]


@pytest.mark.parametrize("term", CATALOGUE)
@pytest.mark.parametrize("samples", [1, 2, 400])
def test_columns_are_the_slopes_of_the_torque_by_each_parameter(term, samples) -> None:
    data, values = motion(samples, 3), parameters(term)
    found = columns(term, values, **data)
    assert list(found) == list(CATALOGUE[term].linear_in)
    for joint in range(3):
        own = {k: v if k == "dt" else v[:, joint] for k, v in data.items()}
        base = torque_by_hand(term, values, **own)
        for name, column in found.items():
            # The torque is linear, so a step of 1 has no error of its own.
            step = torque_by_hand(term, values | {name: values[name] + 1}, **own) - base
            np.testing.assert_allclose(
                column[:, joint], step, rtol=1e-8, atol=1e-8 * np.abs(base).max() + 1e-9
            )


@pytest.mark.parametrize("term", CATALOGUE)
def test_columns_times_parameters_are_the_torque(term) -> None:
    data, values = motion(1000, 1, seed=3), parameters(term, seed=3)
    total = sum(values[n] * c[:, 0] for n, c in columns(term, values, **data).items())
    own = {k: v if k == "dt" else v[:, 0] for k, v in data.items()}
    np.testing.assert_allclose(total, torque_by_hand(term, values, **own), rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("term", STATEFUL)
def test_no_update_depends_on_a_linear_parameter(term) -> None:
    entry = CATALOGUE[term]
    names = {x.name for update in entry.state.values() for x in update.free_symbols}
    assert names.isdisjoint(entry.linear_in)


@pytest.mark.parametrize("term", ["lag", "delay", "elasticity"])
def test_what_starts_settled_is_silent_while_nothing_changes(term) -> None:
    constant = np.full((50, 2), 7.0)
    (column,) = columns(term, {}, constant, constant, constant, constant, np.full(50, 0.002)).values()
    assert np.abs(column).max() < 1e-9


def test_delay_and_elasticity_are_slope_and_curvature_of_the_load() -> None:
    t = np.arange(0, 8, 0.002)
    load, dt = np.sin(2 * t)[:, None], np.full(len(t), 0.002)
    late = slice(1000, None)
    (slope,) = columns("delay", {"tau0": 0.004}, load, load, load, None, dt).values()
    (curvature,) = columns("elasticity", {"tau0": 0.004}, load, load, load, None, dt).values()
    assert np.abs(slope[late, 0] + 2 * np.cos(2 * t[late])).max() < 0.03
    assert np.abs(curvature[late, 0] + 4 * np.sin(2 * t[late])).max() < 0.12


def test_presliding_builds_up_with_travel_whatever_the_rate() -> None:
    for speed in (0.02, 0.2):
        dt = np.full(3000, 0.02 / speed / 3000)
        qd = np.full((3000, 1), speed)
        z = states("presliding", {"zs": 0.01, "width": 1e-9}, qd, qd, qd, None, dt)["z"]
        assert z[-1, 0] == pytest.approx(1 - np.exp(-2), rel=1e-6)


def test_backlash_keeps_its_flank_until_the_load_is_beyond_the_band() -> None:
    load = np.array([0.0, 1.5, 0.4, -0.4, 0.0, -1.0, 0.4, 1.1])[:, None]
    flank = states("backlash", {"band": 0.5}, load, load, load, None, np.full(8, 0.002))["s"][:, 0]
    np.testing.assert_allclose(flank, [0, 1, 1, 0.2, 0.2, -1, -0.2, 1], atol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("term", CATALOGUE)
def test_ten_minutes_of_500_hz_take_less_than_a_second(term) -> None:
    data, values = motion(300_000, 6), parameters(term)
    begin = time.perf_counter()
    columns(term, values, **data)
    assert time.perf_counter() - begin < 1.0
