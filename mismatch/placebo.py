"""Placebos: how often a finding's own columns, shifted in time, would have been named on its joint.

A circular shift inside each run keeps a column's size and memory and takes away its meaning. What is named
all the same is named because residuals remember, not because of physics.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_solve

from .acceptance import EVIDENCE
from .evidence import Evidence, residual
from .grams import roots
from .judging import Judged
from .refit import observed_runs, parameters
from .selection import Directions, fit
from .sharpen import without

Array = NDArray[np.float64]

#: Shifts of each finding, the shortest (s), and the seed of the others.
SHIFTS, SHORTEST, _SEED = 20, 3.0, 5
#: Correlation of a shifted column with the true one above which it is left out.
ALIKE = 0.5


def placebo_rate(evidence: Evidence, judged: Judged) -> float | None:
    """Return the share of shifted columns that would have passed; None when no finding has its own columns.

    evidence: weighed by what the final model leaves.
    """
    passed, count = 0, 0
    for k, a in enumerate(judged.accepted):
        c = a.score.candidate
        if c.joint is None or not c.terms:
            continue
        found = _evidence(evidence, without(judged, k), c.joint, list(c.columns))
        passed += sum(x > EVIDENCE for x in found)
        count += len(found)
    return passed / count if count else None


def _evidence(evidence: Evidence, model: Directions, joint: int, columns: Sequence[int]) -> list[float]:
    """Return nats of each shift of a joint's columns as an addition to a model."""
    space, chosen = evidence.setup.space, evidence.found.directions.take(columns)
    place = space.indices[joint]
    combine = chosen.vectors[place].toarray()  # (P_j, k)
    own = parameters(evidence, model)
    factor = fit(evidence.sums, model, evidence.sums.total).factor
    rng, found = np.random.default_rng(_SEED), list[float]()
    runs = [evidence.runs[r] for r in observed_runs(evidence)]
    whiten = [roots(r, evidence.noise)[joint] for r in runs]
    left = [residual(r, space, own)[:, joint] for r in runs]
    for _ in range(SHIFTS):
        same, whole = 0.0, 1e-300
        square, cross, right = np.diag(1 / chosen.std**2), np.zeros((len(place), len(columns))), 0.0
        for rows, root, e in zip(runs, whiten, left, strict=True):
            edge = min(round(SHORTEST / rows.step), len(rows) // 3)
            shift = int(rng.integers(edge, max(len(rows) - edge, edge + 1)))
            plain = rows.columns[joint] @ combine
            still, moved = root @ plain, root @ np.roll(plain, shift, axis=0)
            same += float(np.sum(still * moved))
            whole += float(np.sum(still**2))
            cross = cross + rows.columns[joint].T @ (root.T @ moved)
            square = square + moved.T @ moved
            right = right + moved.T @ (root @ e)
        if abs(same) > ALIKE * whole:
            continue  # a constant shifted is the same constant: that is no placebo
        b = model.vectors[place].T @ cross
        system = (square - b.T @ cho_solve(factor, b)) * np.outer(chosen.std, chosen.std)
        scaled = chosen.std * right
        gain = 0.5 * scaled @ np.linalg.solve(system, scaled) - 0.5 * np.linalg.slogdet(system)[1]
        found.append(float(gain))
    return found
