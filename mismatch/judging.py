"""From scores to names: what is accepted, what explains what away, and what cannot be told apart."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from . import yardstick
from .acceptance import EVIDENCE, STEADY, objection
from .candidates import Candidate
from .evidence import Evidence
from .grams import regime
from .local import at_one_place
from .naming import Scored, chosen, nuisance, ranked, scored, steadiness, tested
from .plausibility import implausible, is_short, misshapen, of_all_joints
from .selection import Directions

Array = NDArray[np.float64]
Key = tuple[str, int | None]

#: A rival is told apart by this many nats, and by a steady lead where that is a small share of the evidence.
APART, CLOSE = 5.0, 0.05
#: A rival explains at least this share of what the best does.
RELATED = 0.2
#: Less than this share of a found effect's evidence, on its joints, is what that effect's own form leaves.
SHADOW = 0.1
#: Unless a jackknife cannot shake its size by 1 %: what a form leaves varies with the motion.
OWN = 100.0
#: The rigid body's form is exact: what it leaves is time and gains that are off by a few percent, squared.
RIGID = (
    "payload", "link_inertial", "rotor_inertia", "base_free", "frozen_joint_coupling", "dropped_coupling",
)  # fmt: skip
RIGID_SHADOW = 0.01
#: One body that explains this share of what all base parameters together do has that name.
ONE_BODY = 0.9
#: Names that come before one which they cannot be told apart from.
_FIRST = {
    "link_inertial": ("payload",),
    "temperature_dependent_friction": ("coulomb_friction", "viscous_friction"),
}
#: Findings and failed attempts at most.
MOST, TRIES = 6, 10
#: Without a reference: fitted anyway, or only a matter of which masses are believed.
UNSEEN = ("coulomb_friction", "viscous_friction", "drive_gain")
#: s; current and motion may be less than this apart without anything being wrong: a cycle and a half.
SYNCHRONOUS = 0.003


@dataclass(frozen=True)
class Accepted:
    """A hypothesis that stands, the names that do as well, and those that it explains away.

    rivals: (rival, nats behind, steadiness of the lead). share: of what was left unexplained on its joints.
    """

    score: Scored
    alike: tuple[Candidate, ...]
    rivals: tuple[tuple[Candidate, float, float], ...]
    share: float

    @property
    def names(self) -> list[str]:
        """Effects that do as well as this one."""
        return list(dict.fromkeys(c.effect for c in self.alike))

    @property
    def is_finding(self) -> bool:
        """Whether it is physics that is missing, and not the imprecision that every baseline has."""
        c = self.score.candidate
        small = c.effect == "time_delay" and self.score.size[0] < SYNCHRONOUS
        return c.effect != "base_free" and not small


@dataclass(frozen=True)
class Judged:
    """Findings in the order in which they were found, the last model, and what was tried and refused."""

    accepted: tuple[Accepted, ...]
    model: Directions
    refused: tuple[tuple[Scored, str], ...]


def judge(
    evidence: Evidence, progress: Callable[[str], None] = lambda _: None, known: Judged | None = None,
    most: int = MOST,
) -> Judged:  # fmt: skip
    """Add one hypothesis after the other while it passes every test.

    known: what stands already (not judged again); most: findings at most.
    """
    model = known.model if known else nuisance(evidence)
    skip = ("base_free",) if evidence.has_reference else UNSEEN
    accepted, refused = list[Accepted](), list[tuple[Scored, str]]()
    barred, hollow, bent = set[Key](), set[Key](), list[int]()
    tries = 0
    while len(accepted) < most and tries < TRIES:
        progress(f"hypotheses, round {len(accepted) + 1}")
        fitted = evidence.found.directions.take(bent) + model
        every = ranked(evidence, fitted, skip)
        order = [s for s in every if s.candidate.key not in barred]
        if not order or order[0].evidence < EVIDENCE:
            break
        best = likelier(order)
        barred.add(best.candidate.key)
        if why := implausible(evidence, best):
            hollow.add(best.candidate.key)
            refused.append((best, why))
            continue
        test, weighed = tested(evidence, fitted, best.candidate)
        part = share_of(evidence, test)
        why = (
            objection(test, part)
            or implausible(evidence, test)
            or shadow(test, accepted, evidence.setup.space.dof)
            or of_all_joints(weighed, fitted, test)
            or at_one_place(weighed, fitted, test)
        )
        tries += 1
        # what is there without being a finding is fitted, or others would explain it; a curve only here,
        # since what the model leaves of it is still to be called unknown
        if not why:
            why, curve = misshapen(weighed, fitted, test)
            bent += curve
        if not why and (why := yardstick.objection(weighed, fitted, test)):
            model = evidence.found.directions.take(best.candidate.columns) + model
        if why:
            refused.append((test, why))
            continue
        alike, rivals = _rivals(evidence, fitted, best, [o for o in every if o.candidate.key not in hollow])
        accepted.append(Accepted(test, alike, rivals, part))
        model = chosen(model, evidence, best.candidate)
    return Judged(tuple(accepted), model, tuple(refused))


def likelier(order: Sequence[Scored]) -> Scored:
    """Return the best hypothesis, but a name where freed base parameters, which are none, explain no more.

    And a load where a changed link explains no more, since links rarely change; and a level of friction where
    its change with temperature explains no more: recordings that barely warm cannot show one.
    """
    best = order[0]
    if best.candidate.effect == "base_free":
        bodies = [s for s in order if s.candidate.effect in ("payload", "link_inertial")]
        best = next((s for s in bodies if s.evidence > ONE_BODY * best.evidence), best)
    first = _FIRST.get(best.candidate.effect, ())
    here = (s for s in order if s.candidate.joint in (None, best.candidate.joint))
    return next((s for s in here if s.candidate.effect in first and not told_apart(best, s)), best)


def told_apart(best: Scored, other: Scored) -> bool:
    """Return whether one hypothesis is better than another by more than what recordings like these decide."""
    lead = best.evidence - other.evidence
    unsteady = steadiness(best.gain - other.gain) < STEADY
    return not (lead < APART or (lead < CLOSE * best.evidence and unsteady))


def share_of(evidence: Evidence, test: Scored) -> float:
    """Return the share of its joints' squared errors that a hypothesis explains, by its evidence.

    Ripple is seen in the fast band: its share is that of its power in the slow band's noise.
    """
    c = test.candidate
    if c.effect == "torque_ripple" and c.joint is not None:
        power = float(np.sum(test.size**2)) / 2
        return power / (power + float(evidence.scales.sigma[c.joint, 0]) ** 2)
    return share_from(test.evidence, effective(evidence, test.candidate.joint))


def share_from(nats: float, rows: float) -> float:
    """Return the share of squared errors that evidence (nats) on so many independent rows explains."""
    return float(1 - np.exp(-2 * max(nats, 0.0) / max(rows, 1.0)))


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


def shadow(test: Scored, accepted: Sequence[Accepted], joints: int) -> str:
    """Return in words that a hypothesis is what a found effect's own form leaves, or nothing. joints: N."""
    c = test.candidate
    for a in accepted:
        first = a.score.candidate
        if first.effect == "time_delay" and (c.effect == "velocity_lag" or is_short(c)):
            return "with a delay friction changes its sign late as well"
        small = test.evidence < shade(a, joints) and test.consistency < OWN
        if first.joint in (None, c.joint) and small:
            return f"is {100 * test.evidence / a.score.evidence:.1f} % of what {first.effect} explains there"
    return ""


def shade(found: Accepted, joints: int) -> float:
    """Return the nats on one joint that a found effect's own form may leave. joints: N."""
    c = found.score.candidate
    if c.effect in RIGID:
        return RIGID_SHADOW * found.score.evidence
    # what acts on all has its evidence from all
    return SHADOW / (1 if c.joint is not None else joints) * found.score.evidence


def _rivals(
    evidence: Evidence, model: Directions, best: Scored, others: Sequence[Scored]
) -> tuple[tuple[Candidate, ...], tuple[tuple[Candidate, float, float], ...]]:
    """Split rivals into those that do as well and those beaten: (rival, nats, steadiness of the lead).

    others: also those that were refused as not steady. A rival acts on the same joint, or one of the two on
    all, and has little left to say once the best is in.
    """
    joint = best.candidate.joint
    near = [
        o for o in others
        if o is not best and o.evidence > RELATED * best.evidence
        and o.candidate.effect not in ("base_free", best.candidate.effect)
        and (joint is None or o.candidate.joint in (None, joint))
    ][:12]  # fmt: skip
    if not near:
        return (), ()
    after = scored(evidence, chosen(model, evidence, best.candidate), [o.candidate for o in near])
    alike, beaten = list[Candidate](), []
    for other, left in zip(near, after, strict=True):
        if left.evidence > 0.5 * other.evidence:
            continue  # it explains something else
        if told_apart(best, other):
            lead = best.evidence - other.evidence
            beaten.append((other.candidate, lead, steadiness(best.gain - other.gain)))
        else:
            alike.append(other.candidate)
    return tuple(alike), tuple(beaten)
