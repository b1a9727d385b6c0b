"""What a model left of the reference is known where a recording does the same, and nowhere else."""

from dataclasses import replace

import numpy as np
import pytest
from rows_by_hand import ar1, rows

from residuum.mismatch.columns import REPEAT, Column, Space
from residuum.mismatch.repeats import coefficients, repeated, share, views

SPACE = Space(2, ("A1",), (Column("coulomb", "Fc"), Column(REPEAT, "rho")), ("roll",), ((0,), ()))
LEVEL = np.array([5.0, 5.0])
TIME = np.arange(1200) / 60


def sweep(shift: float = 0.0, start: float = 0.0):
    """Rows of two joints in slow sines, some angle away."""
    phase = 0.9 * TIME[:, None] + start + np.array([0.0, 1.0])
    return rows(1200, q=shift + np.sin(phase), qd=0.9 * np.cos(phase), load=10 * np.sin(phase))


def bend(run):
    """What no model has: a function of the path."""
    return 0.5 * np.sin(7 * run.q) + 0.2 * np.cos(5 * run.q[:, ::-1])


def test_on_the_same_path_it_comes_back() -> None:
    """Also with another beginning, so that rows do not fall together."""
    before, now = sweep(), sweep(start=0.123)
    found = repeated([before], [bend(before)], LEVEL, now)
    inside = found.any(axis=1)
    assert inside.mean() > 0.95
    assert np.sqrt(np.mean((found - bend(now))[inside] ** 2)) < 0.05


def test_many_passes_take_noise_away() -> None:
    rng, before, now = np.random.default_rng(1), [sweep(start=x) for x in (0, 0.01, 0.02, 0.03)], sweep()
    left = [bend(r) + 0.3 * ar1(1200, 0.5, rng) for r in before]
    error = [
        np.std(repeated(before[:n], left[:n], LEVEL, now) - bend(now)) for n in (1, 4)
    ]  # fmt: skip
    assert error[1] < 0.8 * error[0]


@pytest.mark.parametrize("elsewhere", [{"q": 0.2}, {"qd": 0.3}, {"load": 10.0}], ids=lambda x: next(iter(x)))
def test_what_the_reference_did_not_do_is_not_known(elsewhere) -> None:
    ((name, by),) = elsewhere.items()
    before, now = sweep(), sweep()
    now = replace(now, **{name: getattr(now, name) + by})
    assert not repeated([before], [bend(before)], LEVEL, now).any()


def test_without_rows_nothing_is_known() -> None:
    assert not repeated([rows(0)], [np.zeros((0, 2))], LEVEL, sweep()).any()
    assert repeated([sweep()], [bend(sweep())], LEVEL, rows(0)).shape == (0, 2)


def test_the_column_is_found_among_the_others() -> None:
    run = sweep()
    run = replace(run, columns=tuple(np.zeros((1200, len(ix))) for ix in SPACE.indices))
    views(run.columns, SPACE)[1][:600] = 1.0
    assert [ix[c.any(axis=0)].tolist() for ix, c in zip(SPACE.indices, run.columns, strict=True)] == [
        [],
        [coefficients(SPACE)[1]],
    ]
    assert share([run], SPACE) == pytest.approx(0.5)
