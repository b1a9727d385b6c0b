"""How far off published masses may be, without a reference, before that is a finding.

Of some robots they are right, and a link that is a tenth lighter stands out; of others all are off by a few
percent, and any body would be named that makes up for most of it. That all are off by more is every
hypothesis' rival: where it explains more, naming starts anew with it.
"""

from collections.abc import Sequence

import numpy as np

from ..identify.solve import PRIOR_SHARE
from .candidates import Key
from .evidence import Evidence
from .naming import APART, TIGHT, Scored, shared
from .selection import Directions, log_evidence

#: Shares of the wide prior of base parameters, one after the other.
MASSES_OFF = (0.007, TIGHT, 0.1)
#: Names that change inertial parameters: told apart from all of these being off, as from any rival.
BODIES = ("payload", "link_inertial", "rotor_inertia")
INERTIAL = (*BODIES, "base_free")
#: What was refused beside the first model: evidence (nats) when it was tried, its test, and why.
Refusals = dict[Key, tuple[float, Scored, str]]


def concealed(share: float) -> tuple[str, ...]:
    """Say what recordings of a robot cannot show whose masses are off by such a share (1: free), if any."""
    if share <= MASSES_OFF[0]:
        return ()
    least = f" by less than {100 * PRIOR_SHARE * share:.2g} % of a base parameter" if share < 1 else ""
    return (f"one body's change{least}: masses as a whole are not as published (the refined model has them)",)


def all_off(evidence: Evidence, model: Directions, best: Scored | None, shares: tuple[float, ...]) -> bool:
    """Return whether masses are all off by the second of some shares, and not by the first.

    model: with masses off by the first; best: the best hypothesis beside it, if one is worth a trial.
    """
    if evidence.has_reference or len(shares) < 2:
        return False
    more = list(np.sqrt(shares[1] ** 2 - shares[0] ** 2) * evidence.base_std)
    looser = model + shared(evidence.setup.space, range(len(evidence.setup.space.base)), more)
    found = log_evidence(evidence.sums, looser) - log_evidence(evidence.sums, model)
    if best is None:
        return found > APART
    return found > best.evidence - (APART if best.candidate.effect in INERTIAL else 0.0)


def unmoved(before: Refusals, every: Sequence[Scored]) -> Refusals:
    """Return the refusals of hypotheses whose evidence is the same to less than APART."""
    now = {s.candidate.key: s.evidence for s in every}
    return {k: v for k, v in before.items() if abs(now.get(k, -np.inf) - v[0]) < APART}
