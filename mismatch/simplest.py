"""Which of two names comes first: the better one if it is told apart, else the simpler or likelier one."""

from collections.abc import Sequence

from .acceptance import STEADY
from .evidence import Evidence
from .naming import APART, Scored, at_best, steadiness, tested
from .plausibility import near_zero
from .selection import Directions

#: A rival is told apart by APART, and by a steady lead where that is less than this share of the evidence.
CLOSE = 0.05
#: And of two of what friction does around zero speed, which is known to less.
NEAR_CLOSE = 0.25
#: Names that come before one which they cannot be told apart from.
_FIRST = {
    "link_inertial": ("payload",),
    "temperature_dependent_friction": ("coulomb_friction", "viscous_friction"),
    "cable_spring": ("current_offset", "friction_asymmetry"),
    "nonlinear_viscous": ("viscous_friction",),
}
#: And before one of these terms: drag by the root of speed is a Stribeck fall's tail.
_BEFORE_TERM = {"power": ("stribeck",)}


def likelier(order: Sequence[Scored]) -> Scored:
    """Return the best hypothesis, but a load where a changed link explains no more: links rarely change.

    And a level, or straight drag, where a change with temperature or angle, or bent drag, explains no more.
    """
    best = order[0]
    return next((s for s in order if comes_first(s, best) and not told_apart(best, s)), best)


def comes_first(other: Scored, best: Scored) -> bool:
    """Return whether a hypothesis' name is the simpler or likelier one of two that explain as much there."""
    c = best.candidate
    first = [*_FIRST.get(c.effect, ()), *(name for term in c.terms for name in _BEFORE_TERM.get(term, ()))]
    return other.candidate.effect in first and other.candidate.joint in (None, c.joint)


def told_apart(best: Scored, other: Scored) -> bool:
    """Return whether one hypothesis is better than another by more than what recordings like these decide."""
    lead = best.evidence - other.evidence
    if near_zero(best.candidate) and near_zero(other.candidate):
        return lead >= max(APART, NEAR_CLOSE * best.evidence)
    unsteady = steadiness(best.gain - other.gain) < STEADY
    return not (lead < APART or (lead < CLOSE * best.evidence and unsteady))


def simplest(
    evidence: Evidence, model: Directions, best: Scored, order: Sequence[Scored]
) -> tuple[Scored, Scored, Evidence]:
    """Return the best hypothesis, or a simpler one that does as well once rows are weighed by what it leaves.

    As it was scored, as it is tested, and the rows of that.
    """
    test, weighed = tested(evidence, model, best.candidate)
    simpler = [s for s in order if comes_first(s, best)]
    if not simpler:
        return best, test, weighed
    found = likelier([test, *at_best(weighed, model, [s.candidate for s in simpler])])
    if found is test:
        return best, test, weighed
    best = next(s for s in simpler if s.candidate.key == found.candidate.key)
    return best, *tested(evidence, model, best.candidate)
