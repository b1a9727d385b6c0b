"""What is believed of a score: evidence, steadiness, a size, and a share that is worth a name."""

import numpy as np

from .naming import Scored
from .plausibility import AT_REVERSALS
from .share import Share

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
#: Or so loud that some mistimed blows do not matter.
LOUD = 30.0
#: A named effect explains at least this share of what its joint's model leaves (0.07 of its rms): less is of
#: no use to anyone.
SHARE = 0.005
#: Or its own torque is this share, and no block shakes its size: then the baseline had bent to imitate it.
LARGE = 0.1


def objection(test: Scored, part: Share) -> str:
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
    rare = _tells_when_it_tells(test)
    if test.steadiness < STEADY and not (consistent or sure or unshaken or rare):
        return f"not steady over the recordings (t = {test.steadiness:.1f})"
    if test.improved < (0.5 if sure or unshaken else IMPROVED) and not rare:
        return f"improves only {100 * test.improved:.0f} % of the left-out parts"
    if part.explained < SHARE and not (unshaken and part.own > LARGE):
        return _too_small(part)
    return ""


def _tells_when_it_tells(test: Scored) -> bool:
    """Return whether what acts at reversals improves nearly all blocks that have any: others say nothing."""
    telling = test.gain[np.abs(test.gain) > 1]
    enough = len(telling) >= 3 and min(test.evidence, test.total) >= BLOWS * EVIDENCE
    return test.candidate.effect in AT_REVERSALS and enough and float(np.mean(telling > 0)) >= ALWAYS


def _objection_to_blows(test: Scored, part: Share) -> str:
    """Return in words why slack is not believed, or nothing.

    A blow lasts 20 ms: blocks in which it comes gain or, where it is mistimed, lose more than all the others,
    so neither gain nor size is steady. Its size has to be that of the gap instead (`implausible`), and most
    blocks gain, or no block shakes it, or it is loud.
    """
    if test.evidence < BLOWS * EVIDENCE or test.total < EVIDENCE:
        return f"evidence {min(test.evidence, test.total):.1f} nats, {BLOWS * EVIDENCE:g} asked"
    sure = test.total >= BLOWS * EVIDENCE and test.consistency >= SURE
    loud = test.total >= LOUD * EVIDENCE and test.consistency >= SIZED
    if test.improved < IMPROVED and not (sure or loud):
        return f"improves only {100 * test.improved:.0f} % of the left-out parts"
    return _too_small(part) if part.explained < SHARE else ""


def _too_small(part: Share) -> str:
    return f"explains only {100 * part.explained:.1f} % of what is left"
