"""Elimination on Gram matrices against brute force: Gaussian marginal likelihoods of all rows at once."""

import numpy as np
import pytest
from rows_by_hand import random_fold, small_space
from scipy import sparse
from scipy.stats import multivariate_normal

from residuum.mismatch.selection import Directions, Sums, eliminate, log_evidence

SPACE = small_space()


class Case:
    """Three observed folds and two of the reference, a model of shared and one own direction, candidates."""

    def __init__(self, seed: int) -> None:
        rng = np.random.default_rng(seed)
        made = [random_fold(SPACE, rng, observed) for observed in (True, True, True, False, False)]
        self.folds = [f for f, _, _ in made]
        self.data = [(x, y) for _, x, y in made]
        self.mean = rng.normal(size=SPACE.size)
        size = SPACE.size
        self.model = Directions(
            sparse.csc_matrix(rng.normal(size=(size, 4))),
            rng.uniform(0.5, 2, 4),
            np.array([True, True, True, False]),
        )
        self.candidates = Directions(
            sparse.csc_matrix(rng.normal(size=(size, 3))), rng.uniform(0.5, 2, 3), np.zeros(3, bool)
        )
        self.sums = Sums(self.folds, SPACE, self.mean)

    def likelihood(self, directions: Directions, used) -> float:
        """Log marginal likelihood of some folds: torque ~ N(X mean, 1 + X V S^2 V' X'), V by side."""
        designs, centred = [], []
        for k in used:
            x, y = self.data[k]
            on = np.ones(len(directions)) if self.folds[k].observed else directions.shared.astype(float)
            designs.append(x @ directions.vectors.toarray() * (on * directions.std))
            centred.append(y - x @ self.mean)
        whole = np.vstack(designs)
        covariance = np.eye(len(whole)) + whole @ whole.T
        return float(multivariate_normal.logpdf(np.concatenate(centred), cov=covariance))


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("columns", [(0,), (1, 2), (0, 1, 2)])
@pytest.mark.parametrize("left_out", [None, 0, 2])
def test_evidence_is_the_rise_of_the_marginal_likelihood(seed, columns, left_out) -> None:
    case = Case(seed)
    used = [k for k in range(5) if k != left_out]
    found = eliminate(case.sums, case.model, case.candidates, left_out).evidence(columns)
    more = case.likelihood(case.model + case.candidates.take(columns), used)
    assert found == pytest.approx(more - case.likelihood(case.model, used), abs=1e-8)


def test_log_evidence_ranks_models_as_brute_force_does() -> None:
    case = Case(5)
    both = case.model + case.candidates
    rise = log_evidence(case.sums, both) - log_evidence(case.sums, case.model)
    assert rise == pytest.approx(
        case.likelihood(both, range(5)) - case.likelihood(case.model, range(5)), abs=1e-8
    )


def test_log_evidence_of_the_reference_alone() -> None:
    case = Case(6)
    narrow = Directions(case.model.vectors, 0.1 * case.model.std, case.model.shared)
    rise = log_evidence(case.sums, case.model, True) - log_evidence(case.sums, narrow, True)
    assert rise == pytest.approx(
        case.likelihood(case.model, (3, 4)) - case.likelihood(narrow, (3, 4)), abs=1e-8
    )


def test_parameters_are_those_of_the_posterior_mean() -> None:
    case = Case(7)
    both, used = case.model + case.candidates, range(5)
    rows, torque = [], []
    for k in used:
        x, y = case.data[k]
        on = np.ones(len(both)) if case.folds[k].observed else both.shared.astype(float)
        rows.append(x @ both.vectors.toarray() * on)
        torque.append(y - x @ case.mean)
    a, b = np.vstack(rows), np.concatenate(torque)
    weights = np.linalg.solve(a.T @ a + np.diag(1 / both.std**2), a.T @ b)
    eliminated = eliminate(case.sums, case.model, case.candidates, None)
    np.testing.assert_allclose(eliminated.parameters([0, 1, 2]), both.vectors @ weights, atol=1e-9)
    size, covariance = eliminated.solve([0, 1, 2])
    np.testing.assert_allclose(size, weights[-3:], atol=1e-9)
    inverse = np.linalg.inv(a.T @ a + np.diag(1 / both.std**2))
    np.testing.assert_allclose(covariance, inverse[-3:, -3:], atol=1e-9)


def test_an_observed_only_direction_ignores_the_reference() -> None:
    case = Case(8)
    alone = Sums(case.folds[:3], SPACE, case.mean)
    own = Directions(case.model.vectors, case.model.std, np.zeros(4, bool))
    ours = eliminate(case.sums, own, case.candidates, None)
    theirs = eliminate(alone, own, case.candidates, None)
    np.testing.assert_allclose(ours.own, theirs.own, atol=1e-12)
    assert ours.evidence([0, 1]) == pytest.approx(theirs.evidence([0, 1]), abs=1e-10)


def test_a_fold_left_out_is_as_if_it_had_not_been_recorded() -> None:
    case = Case(9)
    without = Sums([f for k, f in enumerate(case.folds) if k != 1], SPACE, case.mean)
    ours, theirs = (
        eliminate(s, case.model, case.candidates, k) for s, k in ((case.sums, 1), (without, None))
    )
    np.testing.assert_allclose(ours.own, theirs.own, atol=1e-10)
    np.testing.assert_allclose(ours.schur, theirs.schur, atol=1e-9)
