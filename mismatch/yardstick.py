"""Whether a change is more than how the reference recordings differ among themselves.

Real friction is not the same from one recording to the next. Each recording in turn, of either side, is held
against what all share: how much of the change does it show by itself?
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import logsumexp
from scipy.stats import chi2

from .evidence import Evidence
from .naming import Scored
from .selection import Directions, eliminated, fit

Array = NDArray[np.float64]

#: Nats by which a change has to be likelier than that the recordings just differ.
LIKELIER = float(np.log(1000))
#: Recordings of the reference from which on they tell how recordings differ.
ENOUGH = 4
#: Recordings differ by Student's t of four degrees of freedom, now and then one by much: normal with one of
#: these variances, as likely each. Of what scale, as a share of the change, is unknown: these are as likely.
_DEGREES, _NODES = 4, (np.arange(64) + 0.5) / 64
TAIL, SCALES = _DEGREES / chi2.ppf(_NODES, _DEGREES), np.geomspace(0.02, 4.0, 24)
#: Std of the share that a recording shows which does not tell: one too cold, say.
UNTOLD = 10.0
#: Shares of the change that the observed recordings may have in common.
COMMON = np.linspace(0.0, 2.0, 41)


@dataclass(frozen=True)
class Shares:
    """How much of a change each recording shows (R,), its std (R,), and which are the observed ones."""

    value: Array
    std: Array
    observed: NDArray[np.bool_]

    @property
    def likelier(self) -> float:
        """Nats by which a change is likelier than that the recordings just differ."""
        moved = self.value - COMMON[:, None] * self.observed  # (C, R)
        variance = SCALES[:, None, None] ** 2 * TAIL[:, None] + self.std**2  # (S, T, R)
        log = -0.5 * (moved[:, None, None] ** 2 / variance + np.log(variance))  # (C, S, T, R)
        found = logsumexp(logsumexp(log, axis=2).sum(axis=2), axis=1)
        return float(found.max() - found[0])

    @property
    def largest(self) -> float:
        """What the reference recording shows that shows most."""
        theirs = self.value[~self.observed]
        return float(theirs[np.argmax(np.abs(theirs))])


def shares(weighed: Evidence, model: Directions, test: Scored) -> Shares:
    """Return how much of a change, that may be added to a model, the recordings show one by one, as it is.

    Few of them do not tell how they differ: there it is block by block.
    """
    some, sums = weighed.found.directions.take(test.candidate.columns), weighed.sums
    shared = model.take(np.flatnonzero(model.shared))
    among = fit(sums, shared, np.zeros_like(sums.total))
    theirs, mine = sums.apart(ENOUGH)
    each = [eliminated(among, part, some) for part in theirs]
    each += [eliminated(fit(sums, model, part), part, some) for part in mine]
    told = np.array([test.size @ e.schur @ test.size for e in each]) + 1 / UNTOLD**2
    value = np.array([test.size @ e.right for e in each]) / told
    return Shares(value, 1 / np.sqrt(told), np.arange(len(each)) >= len(theirs))


def objection(weighed: Evidence, model: Directions, test: Scored) -> str:
    """Return in words that the reference recordings differ among themselves by as much, or nothing."""
    if not weighed.has_reference or (found := shares(weighed, model, test)).likelier >= LIKELIER:
        return ""
    return f"a reference recording shows {100 * found.largest:.0f} % of it"
