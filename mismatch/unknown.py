"""The honest rest: something that no name of the catalogue explains, with its place.

A flexible curve shows it, or a hypothesis that was refused: no physics at its size, but it knows where.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .acceptance import EVIDENCE, STEADY
from .candidates import Candidate
from .evidence import Evidence
from .judging import Judged, shade
from .naming import scored
from .share import share_of

Array = NDArray[np.float64]

#: Of what is left on a joint, a curve must explain this share before it is called unknown.
_SHARE = 0.06
#: Nats and steadiness that a curve without a name needs: it has many shapes to try.
_EVIDENCE, _STEADY = 2 * EVIDENCE, STEADY + 0.5


@dataclass(frozen=True)
class Unknown:
    """Unexplained torque on a joint (0-based): share of what is left that something nameless explains."""

    joint: int
    share: float


def unknowns(evidence: Evidence, weighed: Evidence, judged: Judged) -> list[Unknown]:
    """Return joints on which something remains after all names; weighed: by what these leave."""
    some = [Candidate("unknown", j, c) for j, c in enumerate(evidence.found.curve)]
    some += [s.candidate for s, _ in judged.refused if s.candidate.joint is not None]
    result = dict[int, Unknown]()
    for s in scored(weighed, judged.model, some):
        j = s.candidate.joint
        assert j is not None
        share = share_of(weighed, judged.model, s).explained
        mine = (a for a in judged.accepted if a.score.candidate.joint in (None, j))
        if s.evidence < max((shade(a, evidence.setup.space.dof) for a in mine), default=0.0):
            continue
        if min(s.evidence, s.total) > _EVIDENCE and s.steadiness > _STEADY and share > _SHARE:
            result[j] = max(result.get(j, Unknown(j, 0.0)), Unknown(j, share), key=lambda u: u.share)
    return [result[j] for j in sorted(result)]
