"""From scores to names: what is accepted, what explains what away, and what cannot be told apart."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, partial

import numpy as np

from . import yardstick
from .acceptance import EVIDENCE, objection
from .bodies import bodiless
from .candidates import Candidate, Key
from .coverage import SLOW
from .evidence import Evidence
from .firm import beside_firm
from .local import Rowwise, passing, rowwise, uneven
from .masses import BODIES, INERTIAL, MASSES_OFF, Refusals, all_off, unmoved
from .naming import Scored, at_best, chosen, nuisance, ranked, scored, steadiness
from .pace import paceless
from .plausibility import (
    NEAR_ZERO,
    implausible,
    is_short,
    misshapen,
    near_zero,
    of_all_joints,
    of_friction,
    peakless,
    synchronous,
)  # fmt: skip
from .selection import Directions
from .share import Share, share_of
from .simplest import likelier, simplest, told_apart

#: A rival explains at least this share of what the best does.
RELATED = 0.2
#: Less than this share of a found effect's evidence, on its joints, is what that effect's own form leaves.
SHADOW = 0.1
#: Of what friction does around zero speed, which is known to less.
NEAR_SHADOW = 0.3
#: What raises friction around zero speed, and so what builds up there over a short travel: by as much, given
#: what a peak's grid leaves of it.
LEVELS, _RISEN = ("stribeck", "coulomb_friction"), 2.0
#: What shakes the whole arm: on another joint it is known to this share.
SHAKING, _SHAKEN = ("joint_elasticity", "backlash"), 0.3
#: What stands with the arm's pose, on another joint than that whose gear gives way and so turns the links.
BY_POSE, _TURNED = (
    "cable_spring", "current_offset", "friction_asymmetry", "encoder_offset", "position_dependent_friction",
    "link_inertial",
), 0.2  # fmt: skip
#: Unless a jackknife cannot shake its size by 1 %: what a form leaves varies with the motion.
OWN = 100.0
#: The rigid body's form is exact: what it leaves is time and gains that are off by a few percent, squared.
RIGID = (*INERTIAL, "frozen_joint_coupling", "dropped_coupling")
RIGID_SHADOW = 0.01
#: Hz; up to it a delay d is sought. Its column is a slope, and leaves d^2 / 2 of the torque's second one.
_FASTEST = 4.0
MASSES = ("payload", "link_inertial", "base_free")
#: A body, or two of them, that explain this share of what all base parameters together do have the name.
ALL_OF_IT = 0.9
#: Bodies that are tried as the first of two.
_BODIES = 3
#: Findings and attempts at most.
MOST, TRIES = 12, 24
#: Without a reference: fitted anyway, or only a matter of which masses are believed.
UNSEEN = ("coulomb_friction", "viscous_friction", "drive_gain")
#: What recordings slower than coverage.SLOW cannot show.
FAST = ("time_delay", "joint_elasticity", "backlash", *NEAR_ZERO)


@dataclass(frozen=True)
class Accepted:
    """A hypothesis that stands, the names that do as well, and those that it explains away.

    rivals: (rival, nats behind, steadiness of the lead). share: of what was left unexplained on its joints.
    is_finding: it is physics that is missing, and not the imprecision that every baseline or recorder has.
    """

    score: Scored
    alike: tuple[Candidate, ...]
    rivals: tuple[tuple[Candidate, float, float], ...]
    share: float
    is_finding: bool = True

    @property
    def names(self) -> list[str]:
        """Effects that do as well as this one."""
        return list(dict.fromkeys(c.effect for c in self.alike))


@dataclass(frozen=True)
class Judged:
    """Findings in the order in which they were found, the last model, and what was tried and refused.

    masses: share of their wide prior by which masses as a whole are off, without a reference.
    """

    accepted: tuple[Accepted, ...]
    model: Directions
    refused: tuple[tuple[Scored, str], ...]
    masses: float = MASSES_OFF[0]

    @property
    def masses_off(self) -> float:
        """The share by which masses are off after all that was found: 1 where they were freed."""
        return 1.0 if any(a.score.candidate.effect == "base_free" for a in self.accepted) else self.masses


def judge(
    evidence: Evidence, progress: Callable[[str], None] = lambda _: None, known: Judged | None = None,
    most: int = MOST, masses: tuple[float, ...] = MASSES_OFF, before: Refusals | None = None,
) -> Judged:  # fmt: skip
    """Add one hypothesis after the other while it passes every test.

    known: what stands already (not judged again); most: findings at most; masses: how far all masses may be
    off without a reference, by the next where the recordings ask for it; before: what was refused with less,
    which stands where being off by more changes its evidence by less than APART.
    """
    masses = (known.masses,) if known else masses
    model = known.model if known else nuisance(evidence, masses[0])
    skip = ("base_free",) if evidence.has_reference else UNSEEN
    if max(r.step for r in evidence.runs) > 2.001 / SLOW:  # rows are made at half the rate (track.py)
        skip = (*skip, *FAST)
    accepted, refused = list[Accepted](), list[tuple[Scored, str]]()
    barred, hollow, bent = set[Key](), set[Key](), list[int]()
    tries, early = 0, Refusals()
    while sum(a.is_finding for a in accepted) < most and tries < TRIES:
        progress(f"hypotheses, round {len(accepted) + 1}")
        fitted = evidence.found.directions.take(bent) + model
        every = ranked(evidence, fitted, skip)
        if before:
            early, before = unmoved(before, every), None
            barred |= early.keys()
            refused += [(test, why) for _, test, why in early.values()]
        order = [s for s in every if s.candidate.key not in barred]
        told = bool(order) and order[0].evidence >= EVIDENCE
        if all_off(evidence, fitted, order[0] if told else None, masses):
            return judge(evidence, progress, None, most, masses[1:], early)
        if not told:
            break
        best = likelier(bodies_first(order, partial(_best_beside, evidence, fitted)))
        if why := implausible(evidence, best):
            barred.add(best.candidate.key)
            hollow.add(best.candidate.key)
            refused.append((best, why))
            continue
        best, test, weighed = simplest(evidence, fitted, best, order)
        barred.add(best.candidate.key)
        test = beside_firm(weighed, fitted, test)
        part = share_of(weighed, fitted, test)
        if why := of_friction(weighed, fitted, test):
            hollow.add(best.candidate.key)
        made = cache(partial(rowwise, weighed, fitted, test))  # once, and only if it comes to that
        why = why or _refused(weighed, fitted, test, part, accepted, made)
        tries += 1
        if why and not (accepted or bent):
            early[best.candidate.key] = best.evidence, test, why
        # what is there without being a finding is fitted, or others would explain it; a curve only here,
        # since what the model leaves of it is still to be called unknown
        if not why:
            why, curve = misshapen(weighed, fitted, test)
            bent += curve
        if not why and (why := passing(made, test)):
            bent += test.candidate.columns
        if not why:
            why = of_all_joints(weighed, fitted, test) or yardstick.objection(weighed, fitted, test)
            if why:
                model = evidence.found.directions.take(test.candidate.columns) + model
        if why:
            refused.append((test, why))
            continue
        others = [o for o in every if o.candidate.key not in hollow]
        if unshown := [c for c in evidence.found.unshown if c.joint == best.candidate.joint]:
            others += at_best(evidence, fitted, unshown)
        alike, rivals = _rivals(evidence, fitted, best, others)
        accepted.append(Accepted(test, alike, rivals, part.explained, _is_finding(weighed, test)))
        model = chosen(model, evidence, test.candidate)
    return Judged(tuple(accepted), model, tuple(refused), masses[0])


def _is_finding(evidence: Evidence, test: Scored) -> bool:
    c = test.candidate
    return c.effect != "base_free" and not (c.effect == "time_delay" and synchronous(evidence, test))


def _refused(
    weighed: Evidence, model: Directions, test: Scored, part: Share, accepted: Sequence[Accepted],
    made: Callable[[], Rowwise],
) -> str:  # fmt: skip
    """Return in words why a tested hypothesis is no name.

    part: what it explains of what is left; made: gives what it does row by row.
    """
    return (
        objection(test, part)
        or implausible(weighed, test)
        or shadow(test, accepted, weighed.setup.space.dof)
        or bodiless(weighed, model, test)
        or uneven(made, test)
        or paceless(weighed, model, test)
        or peakless(weighed, model, test)
    )


def bodies_first(order: list[Scored], beside: Callable[[Candidate, list[Candidate]], float]) -> list[Scored]:
    """Return hypotheses with a body, or the first of two, before freed base parameters, which are no name.

    Where they explain no more than the body, or than both. beside: nats of the best of others beside a body.
    """
    free, bodies = order[0], [s for s in order if s.candidate.effect in BODIES]
    if free.candidate.effect != "base_free":
        return order
    for body in bodies[:_BODIES]:
        second = beside(body.candidate, [s.candidate for s in bodies if s is not body])
        if body.evidence + max(second, 0.0) > ALL_OF_IT * free.evidence:
            return [body, *(s for s in order if s is not body)]
    return order


def _best_beside(evidence: Evidence, model: Directions, body: Candidate, others: list[Candidate]) -> float:
    return max((s.evidence for s in scored(evidence, chosen(model, evidence, body), others)), default=0.0)


def shadow(test: Scored, accepted: Sequence[Accepted], joints: int) -> str:
    """Return in words that a hypothesis is what a found effect's own form leaves, or nothing. joints: N."""
    c = test.candidate
    for a in accepted:
        first = a.score.candidate
        late = first.effect == "time_delay" and first.joint in (None, c.joint) and a.score.size[-1] > 0
        if first.effect == c.effect == "time_delay":
            return "is in what the clock's delay leaves"
        if late and (c.effect == "velocity_lag" or is_short(c)):
            return "with a delay friction changes its sign late as well"
        level = first.effect in LEVELS and first.joint == c.joint and is_short(c)
        if level and abs(test.size[0]) < _RISEN * abs(a.score.size[0]):
            return "what friction rose by builds up over the short travel that all of it does"
        moved = _SHAKEN if c.effect in SHAKING else _TURNED if c.effect in BY_POSE else 0.0
        elsewhere = first.effect in SHAKING and first.joint != c.joint
        if elsewhere and test.evidence < moved * a.score.evidence:
            return "is what the other joint's gear moves the arm by"
        both = near_zero(first) and near_zero(c)
        least = max(shade(a, joints), NEAR_SHADOW * a.score.evidence if both else 0.0)
        if first.effect == "time_delay" and c.effect in (*RIGID, "joint_elasticity"):
            least = max(least, (np.pi * _FASTEST * a.score.size[0]) ** 2 * a.score.evidence)
        if first.effect in MASSES and c.effect == "drive_gain":  # a mass scales with the gains
            least = SHADOW / joints * a.score.evidence
        if first.effect in RIGID and c.effect == "nonlinear_viscous":
            continue  # what a rigid body's form leaves turns with its torques, not with the speed alone
        small = test.evidence < least and test.consistency < OWN
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

    others: also those that were refused as not steady, or that are not shown. A rival acts on the same joint,
    or one of the two on all, and has little left to say once the best is in.
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
