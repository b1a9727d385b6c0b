"""Every detector gives the same score in one block and sample by sample, and Page's sum is Page's sum."""

import numpy as np
import pytest
from guarding import cusum

from residuum.codegen.guard import CUSUM_TIME
from residuum.collisions.detectors import DETECTORS, Samples, Watch, first


@pytest.fixture(scope="module")
def samples() -> Samples:
    noise = np.random.default_rng(3)
    t = np.arange(600)[:, None] * 0.002
    turn = np.array([0.3, 0.2, 0.4, 0.5, 0.6, 0.7])
    qd = turn * np.sin(3.0 * t + turn) + 0.001 * noise.standard_normal((600, 6))
    q = np.array([0.0, -1.2, 1.2, -1.4, -1.6, 0.0]) + np.cumsum(qd, axis=0) * 0.002
    current = 2.0 * np.cos(3.0 * t) + 0.03 * noise.standard_normal((600, 6))
    return Samples(
        q, qd, current, np.full((600, 6), 40.0), qd + 0.01 * np.sin(9 * t), 1.9 * np.cos(3.0 * t) + 0 * qd
    )


def part(x: Samples, where: slice) -> Samples:
    return Samples(*(column[where] for column in vars(x).values()))


def test_in_pieces_as_in_one(seen, samples) -> None:
    whole = Watch(seen).run(samples)
    watch, pieces = Watch(seen), []
    for cut in (slice(0, 1), slice(1, 250), slice(250, 251), slice(251, 600)):
        pieces.append(watch.run(part(samples, cut)))
    for name in DETECTORS:
        assert np.concatenate([p[name] for p in pieces]) == pytest.approx(whole[name], rel=1e-9, abs=1e-9), (
            name
        )


def test_one_alone_scores_as_among_all(seen, samples) -> None:
    whole = Watch(seen).run(samples)
    for name in DETECTORS:
        alone = Watch(seen, (name,)).run(samples)
        assert list(alone) == [name]
        assert alone[name] == pytest.approx(whole[name], rel=1e-12)


def test_cusum_is_that_of_the_guard(seen, samples) -> None:
    found = Watch(seen, ("cusum",)).run(samples)["cusum"]
    external = seen.observer.Observer(gain=25.0).run(samples.q, samples.qd, samples.current, samples.heat)
    limit = seen.speed + seen.per_speed * np.abs(samples.qd)
    assert found == pytest.approx(cusum(external / limit) / CUSUM_TIME, abs=1e-9)


def test_thesis_thresholds_hold_only_while_a_joint_moves(seen, samples) -> None:
    still = Samples(
        samples.q, 0 * samples.qd, samples.current, samples.heat, samples.target_qd, samples.target_current
    )
    score = Watch(seen, ("static", "thesis-25")).run(still)
    assert np.array_equal(score["static"], score["thesis-25"])


def test_first_names_sample_and_joint() -> None:
    score = np.zeros((5, 3))
    score[1, 0], score[3, 2] = 2.0, 1.0
    assert first(score, 0) == (1, 1)
    assert first(score, 2) == (3, 3)
    assert first(score, 4) is None
