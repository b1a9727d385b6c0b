"""Nonlinear values between the points of their grid, with their uncertainty (variable projection)."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from .candidates import Candidate, of_key
from .evidence import Evidence
from .grid import peak
from .judging import Judged
from .naming import added, scored
from .selection import Directions


@dataclass(frozen=True)
class Sharp:
    """A finding's nonlinear value by name, and its standard deviation (None: at the border of its grid)."""

    value: Mapping[str, float]
    std: float | None


def sharpened(evidence: Evidence, judged: Judged) -> dict[int, Sharp]:
    """Return, by position among the accepted, the nonlinear value at which the evidence peaks.

    evidence: weighed by what the final model leaves.
    """
    found: dict[int, Sharp] = {}
    for k, a in enumerate(judged.accepted):
        c = a.score.candidate
        free = [n for n, _ in c.values if n not in ("width", "n", "around", "jerk")]
        if c.whole or not free:  # a mixture has its value between the two already
            continue
        along = [x for x in of_key(evidence.found.each, c.key) if x.terms == c.terms]
        same = [x for x in along if _but(x, free[0]) == _but(c, free[0])]
        some = [s for s in scored(evidence, without(judged, k), same) if s.candidate.conceivable(s.size)]
        if len(some) < 3:
            continue
        places = [dict(s.candidate.values)[free[0]] for s in some]
        value, std = peak(places, [s.evidence for s in some])
        found[k] = Sharp({free[0]: value}, std)
    return found


def settled(evidence: Evidence, judged: Judged) -> Judged:
    """Return findings with the coefficients that they have once all others are known, too.

    evidence: as of `sharpened`.
    """
    if len(judged.accepted) < 2:
        return judged
    found = []
    for k, a in enumerate(judged.accepted):
        c = a.score.candidate
        size, covariance = added(evidence, without(judged, k), c).solve(range(len(c.columns)))
        found.append(replace(a, score=replace(a.score, size=size, std=np.sqrt(np.diag(covariance)))))
    return replace(judged, accepted=tuple(found))


def _but(candidate: Candidate, name: str) -> dict[str, float]:
    """Return a hypothesis' nonlinear values but one."""
    return {n: v for n, v in candidate.values if n != name}


def without(judged: Judged, k: int) -> Directions:
    """Return the model of all findings but the k-th."""
    size = len(judged.model)
    widths = [len(a.score.candidate.columns) for a in judged.accepted]
    first = size - sum(widths)
    start = first + sum(widths[:k])
    return judged.model.take([i for i in range(size) if not start <= i < start + widths[k]])
