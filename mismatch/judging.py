"""From scores to names: what is accepted, what explains what away, and what cannot be told apart."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .candidates import Candidate
from .evidence import Evidence
from .flexible import names
from .grams import regime
from .naming import Scored, chosen, nuisance, ranked, scored, steadiness, tested
from .selection import Directions

Array = NDArray[np.float64]
Key = tuple[str, int | None]

#: Nats on left-out data and all data: odds of e^10 against, for a few hundred hypotheses tried.
EVIDENCE = 10.0
#: Mean gain of a fold over its standard error; share of folds that improve.
STEADY, IMPROVED = 2.0, 0.6
#: Or, where some folds tell far more than others (the warm ones, those with jerks): a size that no fold alone
#: makes (jackknife), with nearly all folds improved, or surer and with twice the evidence.
ALWAYS, CONSISTENT, SURE = 0.75, 4.0, 5.0
#: Or the baseline bends to imitate it, so that left-out blocks gain little, but no block shakes its size, and
#: twice the evidence counts how far the baseline had to bend: then this share of the left-out nats will do,
#: and half the steadiness.
UNSHAKEN, BENT = 8.0, 0.3
#: A size that is not this many of its jackknife's standard errors away from zero is no size at all.
SIZED = 3.0
#: Or it is a blow, which is rare: so many times the evidence.
BLOWS = 3.0
#: A named effect explains at least this share of what its joint's model leaves: less is of no use to anyone.
SHARE = 0.01
#: Friction over the angle is a wave unless any curve explains so much more than it.
NO_WAVE = 0.5
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
RIGID_SHADOW = 0.001
#: One body that explains this share of what all base parameters together do has that name.
ONE_BODY = 0.9
#: Findings and failed attempts at most.
MOST, TRIES = 6, 10
#: Without a reference: fitted anyway, or only a matter of which masses are believed.
UNSEEN = ("coulomb_friction", "viscous_friction", "drive_gain")
#: s; current and motion may be less than this apart without anything being wrong: a cycle and a half.
SYNCHRONOUS = 0.003
#: What builds up with travel or late is much of the Coulomb level, or it is something else; over less travel
#: (rad) than the catalogue's, which every gear shows a little of, more of it. A reference holds what every
#: gear has: a change may be small.
_PART_OF_COULOMB = {"presliding_hysteresis": 0.2, "velocity_lag": 0.5}
_TRAVEL, _PART_WITHIN = 0.005, 0.35
_PART_CHANGED = 0.1
#: What slack does follows from its width: the size of its column is one, or at least this.
_LEAST_GAP = 0.3


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
    barred, hollow = set[Key](), set[Key]()
    tries = 0
    while len(accepted) < most and tries < TRIES:
        progress(f"hypotheses, round {len(accepted) + 1}")
        every = ranked(evidence, model, skip)
        order = [s for s in every if s.candidate.key not in barred]
        if not order or order[0].evidence < EVIDENCE:
            break
        best = _likelier(order)
        barred.add(best.candidate.key)
        if why := implausible(evidence, best):
            hollow.add(best.candidate.key)
            refused.append((best, why))
            continue
        test, weighed = tested(evidence, model, best.candidate)
        part = share_of(evidence, test)
        why = (
            objection(test, part)
            or implausible(evidence, test)
            or shadow(test, accepted, evidence.setup.space.dof)
            or _misshapen(weighed, model, test)
        )
        tries += 1
        if why:
            refused.append((test, why))
            continue
        alike, rivals = _rivals(evidence, model, best, [o for o in every if o.candidate.key not in hollow])
        accepted.append(Accepted(test, alike, rivals, part))
        model = chosen(model, evidence, best.candidate)
    return Judged(tuple(accepted), model, tuple(refused))


def _likelier(order: Sequence[Scored]) -> Scored:
    """Return the best hypothesis, but a name where freed base parameters, which are none, explain no more.

    And a load where a changed link explains no more: links rarely change.
    """
    best = order[0]
    if best.candidate.effect == "base_free":
        bodies = [s for s in order if s.candidate.effect in ("payload", "link_inertial")]
        best = next((s for s in bodies if s.evidence > ONE_BODY * best.evidence), best)
    if best.candidate.effect == "link_inertial":
        loads = [s for s in order if s.candidate.effect == "payload" and not told_apart(best, s)]
        return loads[0] if loads else best
    return best


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
    return float(
        1 - np.exp(-2 * max(test.evidence, 0.0) / max(effective(evidence, test.candidate.joint), 1.0))
    )


def effective(evidence: Evidence, joint: int | None) -> float:
    """Return the number of independent rows that a joint (None: one on average) has on the observed side."""
    found = np.zeros(evidence.setup.space.dof)
    for rows, seen in zip(evidence.runs, evidence.observed, strict=True):
        if seen:
            found += ((regime(rows) < 2) / evidence.scales.inflation).sum(axis=0)
    return float(found.mean() if joint is None else found[joint])


def objection(test: Scored, part: float) -> str:
    """Return in words why a hypothesis is not believed, or nothing."""
    if test.candidate.effect == "backlash":
        return _objection_to_blows(test, part)
    unshaken = test.consistency >= UNSHAKEN and test.evidence >= 2 * EVIDENCE and test.steadiness >= 1
    if test.evidence < EVIDENCE or test.total < (BENT if unshaken else 1.0) * EVIDENCE:
        return f"evidence {min(test.evidence, test.total):.1f} nats, {EVIDENCE:g} asked"
    if test.consistency < SIZED:
        return f"its size is not the same over the recordings (jackknife t = {test.consistency:.1f})"
    consistent = test.improved >= ALWAYS and test.consistency >= CONSISTENT
    sure = test.total >= 2 * EVIDENCE and test.consistency >= SURE
    if test.steadiness < STEADY and not (consistent or sure or unshaken):
        return f"not steady over the recordings (t = {test.steadiness:.1f})"
    if test.improved < (0.5 if sure or unshaken else IMPROVED):
        return f"improves only {100 * test.improved:.0f} % of the left-out parts"
    if part < SHARE:
        return f"explains only {100 * part:.1f} % of what is left"
    return ""


def _objection_to_blows(test: Scored, part: float) -> str:
    """Return in words why slack is not believed, or nothing.

    A blow lasts 20 ms: blocks in which it comes gain or, where it is mistimed, lose more than all the others,
    so neither gain nor size is steady. Instead its size has to be that of the gap (`implausible`).
    """
    if test.evidence < BLOWS * EVIDENCE or test.total < EVIDENCE:
        return f"evidence {min(test.evidence, test.total):.1f} nats, {BLOWS * EVIDENCE:g} asked"
    if test.improved < IMPROVED:
        return f"improves only {100 * test.improved:.0f} % of the left-out parts"
    return f"explains only {100 * part:.1f} % of what is left" if part < SHARE else ""


def implausible(evidence: Evidence, test: Scored) -> str:
    """Return in words why a hypothesis is no physics at the size that it would have, or nothing."""
    c = test.candidate
    if c.effect == "backlash" and not _LEAST_GAP < (times := float(test.size.sum())) < 1 / _LEAST_GAP:
        return f"moves the arm {times:.2g} times as much as such a gap does"
    if c.effect in _PART_OF_COULOMB and c.joint is not None:
        level = evidence.setup.friction[c.joint, 0]
        least = _PART_WITHIN if _is_short(c) else _PART_OF_COULOMB[c.effect]
        if abs(test.size[0]) < (_PART_CHANGED if evidence.has_reference else least) * level:
            return f"is {100 * abs(test.size[0]) / level:.0f} % of the Coulomb level: too little for it"
    return ""


def _is_short(c: Candidate) -> bool:
    return dict(c.values).get("zs", _TRAVEL) < _TRAVEL


def _misshapen(weighed: Evidence, model: Directions, test: Scored) -> str:
    """Return in words that a curve which is no physics explains it far better, or nothing.

    Friction over the angle that is no wave is a damaged tooth's. What turns with the sign of the drive's
    torque, and not with that of motion, is the amplifier's. weighed: by what the hypothesis leaves.
    """
    c = test.candidate
    if c.joint is None:
        return ""
    over, least = "drive sign", EVIDENCE
    if c.effect == "position_dependent_friction":
        over, least = "q sign", max(EVIDENCE, NO_WAVE * test.evidence)
    curve = [weighed.found.curve[c.joint][k] for k, (name, _) in enumerate(names()) if name == over]
    other = scored(weighed, model, [Candidate("unknown", c.joint, tuple(curve))])[0]
    if (lead := other.evidence - test.evidence) > least:
        what = {"q sign": "a curve over the angle that is no wave", "drive sign": "the torque's own sign"}
        return f"{what[over]} explains {lead:.0f} nats more"
    return ""


def shadow(test: Scored, accepted: Sequence[Accepted], joints: int) -> str:
    """Return in words that a hypothesis is what a found effect's own form leaves, or nothing. joints: N."""
    c = test.candidate
    for a in accepted:
        first = a.score.candidate
        if first.effect == "time_delay" and (c.effect == "velocity_lag" or _is_short(c)):
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
