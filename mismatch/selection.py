"""Held-out gains of many hypotheses at once, by elimination on Gram matrices.

The model that stands is eliminated once a fold; what a hypothesis adds is then a small system of its own
columns, so that hundreds of hypotheses cost little more than one.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.linalg import cho_factor, cho_solve

from .columns import Space
from .grams import Fold, whole

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


@dataclass(frozen=True)
class Directions:
    """D directions in the parameter space: vectors (P, D), sparse; prior std (D,), shared (D,).

    Shared ones hold for reference and observed recordings; the others only for the observed.
    """

    vectors: Any
    std: Array
    shared: NDArray[np.bool_]

    def take(self, index: Sequence[int] | Indices) -> "Directions":
        """Keep some directions."""
        ix = np.asarray(index, np.int64)
        return Directions(self.vectors[:, ix], self.std[ix], self.shared[ix])

    def __add__(self, other: "Directions") -> "Directions":
        return Directions(
            sparse.hstack([self.vectors, other.vectors], format="csc"),
            np.concatenate([self.std, other.std]),
            np.concatenate([self.shared, other.shared]),
        )

    def __len__(self) -> int:
        return len(self.std)


class Sums:
    """Gram matrices of both sides about the prior mean, in the parameter space."""

    def __init__(self, folds: Sequence[Fold], space: Space, mean: Array) -> None:
        """Mean (P,): torques count from columns @ mean."""
        self.space, self.observed = space, [f for f in folds if f.observed]
        self._healthy = [f for f in folds if not f.observed]
        self._mean = mean
        self._each = [self._whole(f) for f in self.observed]
        zero = np.zeros((space.size + 1,) * 2)
        self.reference = sum((self._whole(f) for f in self._healthy), zero)
        self.total: Array = sum(self._each, zero)

    def without(self, k: int | None) -> Array:
        """Return the observed side's sum without its fold k."""
        return self.total if k is None else self.total - self._each[k]

    def apart(self, enough: int) -> tuple[list[Array], list[Array]]:
        """Return the sums of the reference's recordings and of the observed ones, each by itself.

        Fold by fold, where the reference is fewer recordings than enough.
        """
        theirs = [self._whole(f) for f in self._healthy]
        if len({f.run for f in self._healthy}) < enough:
            return theirs, self._each
        return _by_run(self._healthy, theirs), _by_run(self.observed, self._each)

    def _whole(self, fold: Fold) -> Array:
        gram = whole(fold.grams, self.space)
        right = gram[:-1, -1].copy()
        moved = gram[:-1, :-1] @ self._mean
        gram[:-1, -1] = gram[-1, :-1] = right - moved
        gram[-1, -1] += self._mean @ (moved - 2 * right)
        return gram


def _by_run(folds: Sequence[Fold], each: Sequence[Array]) -> list[Array]:
    """Add up what each fold has, by run."""
    runs = [f.run for f in folds]
    return [
        np.sum([x for x, own in zip(each, runs, strict=True) if own == r], axis=0)
        for r in dict.fromkeys(runs)
    ]


@dataclass(frozen=True)
class Eliminated:
    """A model of directions eliminated from C candidate directions.

    schur (C, C), right (C,): normal equations of the candidates, std (C,) their priors; reaction (P, C):
    parameters that a unit of each amounts to, the model's answer included; own (P,): the model's own fit,
    from the prior mean.
    """

    schur: Array
    right: Array
    std: Array
    reaction: Array
    own: Array

    def solve(self, columns: Sequence[int] | Indices) -> tuple[Array, Array]:
        """Return candidate coefficients (k,) and their covariance (k, k)."""
        ix = np.asarray(columns, np.int64)
        inverse = np.linalg.inv(self._system(ix))
        return inverse @ self.right[ix], np.asarray(inverse, np.float64)

    def evidence(self, columns: Sequence[int] | Indices) -> float:
        """Return the rise of the log marginal likelihood that these columns bring, nats."""
        ix = np.asarray(columns, np.int64)
        system = self._system(ix) * np.outer(self.std[ix], self.std[ix])
        right = self.std[ix] * self.right[ix]
        return float(0.5 * right @ np.linalg.solve(system, right) - 0.5 * np.linalg.slogdet(system)[1])

    def parameters(self, columns: Sequence[int] | Indices = ()) -> Array:
        """Return what the model, with these candidates, adds to the prior mean of the parameters (P,)."""
        if not len(columns):
            return self.own
        d, _ = self.solve(columns)
        return np.asarray(self.own + self.reaction[:, np.asarray(columns, np.int64)] @ d, np.float64)

    def _system(self, ix: Indices) -> Array:
        return self.schur[np.ix_(ix, ix)] + np.diag(1 / self.std[ix] ** 2)


def normal_equations(sums: Sums, model: Directions, seen: Array) -> tuple[Array, Array]:
    """Return matrix (D, D), prior not included, and right side (D,) of a model's normal equations.

    seen (P + 1, P + 1): Gram matrix of the observed side; the reference's is added to what is shared.
    """
    shared = model.vectors @ sparse.diags(model.shared.astype(float))
    a = model.vectors.T @ (model.vectors.T @ seen[:-1, :-1]).T
    a = a + shared.T @ (shared.T @ sums.reference[:-1, :-1]).T
    r = model.vectors.T @ seen[:-1, -1] + shared.T @ sums.reference[:-1, -1]
    return np.asarray(a, np.float64), np.asarray(r, np.float64)


@dataclass(frozen=True)
class Fit:
    """A model's normal equations, its prior in them: factor of the matrix (D, D), right side (D,)."""

    model: Directions
    factor: Any
    right: Array


def fit(sums: Sums, model: Directions, seen: Array) -> Fit:
    """Fit a model to what is seen of the observed side and to the reference."""
    a, r = normal_equations(sums, model, seen)
    return Fit(model, cho_factor(a + np.diag(1 / model.std**2)), r)


def eliminate(sums: Sums, model: Directions, candidates: Directions, left_out: int | None) -> Eliminated:
    """Fit a model without a fold of the observed side (None: with all), and eliminate it from candidates.

    Candidates are of the observed side only.
    """
    seen = sums.without(left_out)
    return eliminated(fit(sums, model, seen), seen, candidates)


def eliminated(fitted: Fit, seen: Array, candidates: Directions) -> Eliminated:
    """Eliminate a model from candidates that only the rows of a Gram matrix (P + 1, P + 1) have."""
    model = fitted.model
    b = (model.vectors.T @ seen[:-1, :-1]) @ candidates.vectors
    solved = cho_solve(fitted.factor, np.column_stack([b, fitted.right]))
    reaction = candidates.vectors.toarray() - model.vectors @ solved[:, :-1]
    own = model.vectors @ solved[:, -1]
    right = candidates.vectors.T @ (seen[:-1, -1] - seen[:-1, :-1] @ own)
    schur = candidates.vectors.T @ (seen[:-1, :-1] @ reaction)
    return Eliminated((schur + schur.T) / 2, np.asarray(right), candidates.std, reaction, own)


def log_evidence(sums: Sums, model: Directions, reference_only: bool = False) -> float:
    """Return the log marginal likelihood of a model, up to a constant of the data, nats."""
    seen = 0.0 * sums.total if reference_only else sums.total
    a, r = normal_equations(sums, model, seen)
    scaled = a * np.outer(model.std, model.std) + np.eye(len(model))
    right = model.std * r
    return float(0.5 * right @ np.linalg.solve(scaled, right) - 0.5 * np.linalg.slogdet(scaled)[1])
