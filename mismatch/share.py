"""How large a hypothesis is: the share that it explains of what is left on its joints, as it is recorded."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .evidence import Evidence, residual
from .grams import even_weights, regime
from .naming import Scored
from .refit import observed_runs
from .selection import Directions, eliminate

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Share:
    """Shares of a joint's squared errors in motion, each beside what the model with the addition leaves.

    explained: what of an addition the model cannot imitate; own: its torque as such.
    """

    explained: float
    own: float


def share_of(weighed: Evidence, model: Directions, test: Scored) -> Share:
    """Return how large an addition to a model is on its joints.

    Squares count as they are or by each regime's noise, whichever shows more: what acts around reversals is
    little beside the noise there, and what acts in free motion beside the errors at reversals. weighed: by
    what it leaves. Ripple is seen in the fast band: its share is that of its power in the slow band's noise.
    """
    c, space = test.candidate, weighed.setup.space
    if c.effect == "torque_ripple" and c.joint is not None:
        power = float(np.sum(test.size**2)) / 2
        part = power / (power + float(weighed.scales.sigma[c.joint, 0]) ** 2)
        return Share(part, part)
    addition = weighed.found.directions.take(c.columns)
    fitted = eliminate(weighed.sums, model, addition, None)
    changes = np.column_stack([fitted.reaction @ test.size, addition.vectors @ test.size])
    all_of = weighed.mean + fitted.parameters(range(len(c.columns)))
    moved, left = np.zeros((2, 2)), np.zeros((2, 1))
    for run in observed_runs(weighed):
        rows = weighed.runs[run]
        evenly, errors = even_weights(rows, weighed.noise), residual(rows, space, all_of)
        for j in range(space.dof) if c.joint is None else (c.joint,):
            weights = np.stack([evenly[:, j] > 0, evenly[:, j]])
            moved += weights @ (rows.columns[j] @ changes[space.indices[j]]) ** 2
            left += weights @ errors[:, j : j + 1] ** 2
    explained, own = (moved / np.maximum(moved + left, 1e-300)).max(axis=0)
    return Share(float(explained), float(own))


def nats_from(share: float, rows: float) -> float:
    """Return the nats on so many independent rows of a share of squared errors."""
    return -0.5 * rows * float(np.log1p(-min(share, 0.999999)))


def effective(evidence: Evidence, joint: int | None) -> float:
    """Return the number of independent rows that a joint (None: one on average) has on the observed side."""
    found = np.zeros(evidence.setup.space.dof)
    for rows, seen in zip(evidence.runs, evidence.observed, strict=True):
        if seen:
            found += ((regime(rows) < 2) / evidence.scales.inflation).sum(axis=0)
    return float(found.mean() if joint is None else found[joint])
