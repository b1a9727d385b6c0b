"""Which directions the model that is handed over has: masses, friction, and what was named.

With a reference also the shapes of friction that the healthy robot has by itself. These are no finding, but
without them what was named would be bent to stand for them.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .acceptance import EVIDENCE
from .candidates import Candidate
from .evidence import Evidence, evenly_weighed
from .judging import RIGID, Accepted
from .masses import INERTIAL
from .naming import TIGHT, reweighed, shared
from .refit import parameters
from .selection import Directions, log_evidence

Array = NDArray[np.float64]

#: Terms of a healthy gear, and how many of them a joint may have.
SHAPES = (
    "offset", "quadratic", "cubic", "power", "tanh", "stribeck", "load_dependent", "position_dependent",
    "presliding",
)  # fmt: skip
_MOST = 3
_AS_MASSES = (*RIGID, "base_tilt", "encoder_offset")
_HELD = 1e-4


def handed(
    evidence: Evidence, accepted: Sequence[Accepted], shapes: Sequence[Candidate] = (), tight: float = TIGHT
) -> Directions:
    """Return the columns of the model that is handed over.

    tight: of their wide prior, what base parameters have where no finding frees them.
    """
    space, found = evidence.setup.space, evidence.found
    free = evidence.has_reference or any(a.score.candidate.effect in INERTIAL for a in accepted)
    keep = list(range(len(space.base)))
    std = list(evidence.base_std * (1.0 if free else tight))
    for j in range(space.dof):
        for k, c in enumerate(space.own):
            if c.usual:
                keep.append(space.own_index(j, k))
                std.append(float(evidence.own_std[j, k]))
    model = shared(space, keep, std) + _of_both(evidence, shapes)
    inertial = () if evidence.has_reference else INERTIAL  # there the base parameters themselves are free
    named = [
        c for a in accepted if a.score.candidate.effect not in inertial for c in a.score.candidate.columns
    ]
    return model + found.directions.take(named)


def moved(evidence: Evidence, model: Directions) -> NDArray[np.int64]:
    """Return which of the space's parameters a model moves: all base ones first."""
    base = np.arange(len(evidence.setup.space.base))
    return np.concatenate([base, np.setdiff1d(np.unique(model.vectors.nonzero()[0]), base)])


def unnamed(evidence: Evidence, accepted: Sequence[Accepted]) -> Directions:
    """Return the columns of the model without a reference and without its findings.

    Where one of these acts as masses do, masses stay as published: over many rows they would take its place.
    """
    massive = any(a.score.candidate.effect in _AS_MASSES for a in accepted if a.is_finding)
    rest = () if massive else [a for a in accepted if not a.is_finding]
    return handed(evidence, rest, (), _HELD if massive else TIGHT)


def shapes_of(evidence: Evidence, accepted: Sequence[Accepted]) -> tuple[Candidate, ...]:
    """Return the shapes of friction, one of a term a joint, that reference and observed runs share.

    Without a reference what is missing is a finding.
    """
    if not evidence.has_reference:
        return ()
    offered = [c for c in evidence.found.each if c.terms and c.terms[0] in SHAPES]
    found = list[Candidate]()
    weighed = evenly_weighed(evidence)
    for _ in range(_MOST):
        model = handed(weighed, accepted, found)
        weighed = reweighed(weighed, model, even=True)
        taken = {(c.joint, c.terms) for c in found}
        gains = _gains(weighed, model, [c for c in offered if (c.joint, c.terms) not in taken])
        new = [x for j in range(weighed.setup.space.dof) if (x := _best(weighed, model, gains, j))]
        if not new:
            break
        found += new
    return tuple(found)


def _gains(
    evidence: Evidence, model: Directions, offered: Sequence[Candidate]
) -> list[tuple[float, Candidate]]:
    """Return each shape's rise of the log evidence of both sides, nats, and the shape, best first."""
    before = log_evidence(evidence.sums, model)
    gains = [(log_evidence(evidence.sums, model + _of_both(evidence, [c])) - before, c) for c in offered]
    return sorted(gains, key=lambda x: -x[0])


def _best(
    evidence: Evidence, model: Directions, gains: Sequence[tuple[float, Candidate]], joint: int
) -> Candidate | None:
    """Return the shape that a joint's rows ask for most, if they do and it is conceivable."""
    for gain, c in gains:
        if c.joint != joint or gain < EVIDENCE:
            continue
        shape = _of_both(evidence, [c])
        if c.conceivable(shape.vectors.T @ (parameters(evidence, model + shape) - evidence.mean)):
            return c
    return None


def _of_both(evidence: Evidence, shapes: Sequence[Candidate]) -> Directions:
    """Return the columns of shapes as those of both sides."""
    columns = evidence.found.directions.take([c for x in shapes for c in x.columns])
    return Directions(columns.vectors, columns.std, np.ones(len(columns), bool))
