"""What recordings cannot show is said."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
from rows_by_hand import STEP, rows

from residuum.mismatch.columns import REPEAT, Column, Space
from residuum.mismatch.coverage import cannot_show
from residuum.recordings import Recording

#: Two joints whose only column is what came back of the reference.
SPACE = Space(2, (), (Column(REPEAT, "rho"),), (), ((), ()))


def said(
    run, rate: float = 125.0, has_reference: bool = True, came_back: float = 0.1, **fields
) -> tuple[str, bool]:
    time = np.arange(0, 40, 1 / rate)
    q = np.zeros((len(time), 2))
    known = {"qd": q, "joint_temperatures": q + 30} | fields
    recording = Recording("r", time, q, q, **known)
    run = replace(run, columns=(np.full((len(run), 1), came_back),) * 2)
    evidence = SimpleNamespace(
        runs=(run,), observed=(True,), has_reference=has_reference,
        setup=SimpleNamespace(lacking=(), space=SPACE),
    )  # fmt: skip
    found = cannot_show(evidence, [recording])
    return " | ".join(found.texts), found.hopeless


def warming(count: int):
    return np.linspace(25, 35, count)[:, None] * np.ones((1, 2))


def test_a_full_recording_with_reference_lacks_nothing() -> None:
    assert said(rows(2400, temperature=warming(2400))) == ("", False)


def test_a_reference_that_moved_elsewhere_is_told() -> None:
    text, hopeless = said(rows(2400, temperature=warming(2400)), came_back=0.0)
    assert "it holds 0 % of this motion" in text and not hopeless


def test_a_joint_that_stands_is_named() -> None:
    q = np.random.default_rng(1).uniform(-1, 1, (2400, 2))
    q[:, 1] = 0.3
    text, hopeless = said(rows(2400, q=q, temperature=warming(2400)))
    assert "joint 2: it stands still" in text and not hopeless


def test_one_pose_shows_gravity_only() -> None:
    text, _ = said(rows(2400, q=np.zeros((2400, 2)), moving=np.zeros((2400, 2))))
    assert "no joint moves" in text


def test_too_short_is_hopeless() -> None:
    text, hopeless = said(rows(int(3 / STEP)))
    assert "too few to name anything" in text and hopeless


def test_slow_rates_and_missing_columns_are_said() -> None:
    text, _ = said(rows(2400), rate=10.0, has_reference=False, qd=None, joint_temperatures=None)
    for words in (
        "10 Hz is too slow",
        "speeds were not recorded",
        "joint_temperatures were not recorded",
        "published masses",
    ):
        assert words in text


def test_no_rows_at_all() -> None:
    text, hopeless = said(rows(0))
    assert "no recording is long enough" in text and hopeless
