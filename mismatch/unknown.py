"""The honest rest: something that no name of the catalogue explains, with its place and a flexible curve."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .acceptance import EVIDENCE, STEADY
from .candidates import Candidate
from .evidence import Evidence
from .judging import Judged, effective, shade, share_from
from .naming import scored

Array = NDArray[np.float64]

#: Of what is left on a joint, a curve must explain this share before it is called unknown.
_SHARE = 0.06
#: Nats and steadiness that a curve without a name needs: it has many shapes to try.
_EVIDENCE, _STEADY = 2 * EVIDENCE, STEADY + 0.5


@dataclass(frozen=True)
class Unknown:
    """Unexplained torque on a joint (0-based): share of what is left that a flexible curve explains."""

    joint: int
    share: float


def unknowns(evidence: Evidence, weighed: Evidence, judged: Judged) -> list[Unknown]:
    """Return joints on which a flexible curve remains after all names; weighed: by what these leave."""
    curves = [Candidate("unknown", j, c) for j, c in enumerate(evidence.found.curve)]
    result = list[Unknown]()
    for s in scored(weighed, judged.model, curves):
        j = s.candidate.joint
        assert j is not None
        share = share_from(s.total, effective(evidence, j))
        mine = (a for a in judged.accepted if a.score.candidate.joint in (None, j))
        if s.evidence < max((shade(a, evidence.setup.space.dof) for a in mine), default=0.0):
            continue
        if min(s.evidence, s.total) > _EVIDENCE and s.steadiness > _STEADY and share > _SHARE:
            result.append(Unknown(j, share))
    return result
