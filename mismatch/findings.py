"""The findings as findings.json has them: named physics, a load that comes and goes, pushes, the unknown."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.stats import norm

from ..symbolic.effects import EFFECTS
from ..symbolic.terms import CATALOGUE
from ..symbolic.terms.forms import equation
from .candidates import Candidate
from .carried import Carried
from .episodes import Episode, involved
from .judging import Accepted
from .parts import Parts
from .pushes import Pushed
from .quantities import Quantity, parameters_of, payload_numbers, quantity
from .share import effective, nats_from
from .sharpen import without

#: On concealed cases (docs/trials.md), some outside the catalogue, this share of the surest names was right.
SUREST = 0.85
#: Of a joint's left-out squares, for episodes to be worth a word.
_EPISODE_SHARE = 0.1


def findings_of(p: Parts) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Return what has a name, strongest evidence first, and what has none."""
    found = [(_strength(p, a), _named(p, k, a)) for k, a in enumerate(p.judged.accepted) if a.is_finding]
    found += [(x.evidence, _contact(p, x)) for x in (p.pushed,) if x]
    found += [(c.evidence, _carried(p, c)) for c in (p.carried,) if c]
    return [f for _, f in sorted(found, key=lambda x: -x[0])], _strange(p)


def _named(p: Parts, k: int, a: Accepted) -> dict[str, Any]:
    c = a.score.candidate
    sharp = p.sharp.get(k)
    numbers: dict[str, Quantity] = dict(parameters_of(p.evidence, without(p.judged, k), a.score, p.nominal))
    if sharp:
        numbers |= {n: quantity(v, sharp.std, numbers[n]["unit"]) for n, v in sharp.value.items()}
    joints = _joints(p, c)
    return {
        "effect": c.effect,
        "joints": joints,
        "indistinguishable_from": a.names,
        "confidence": _confidence(a),
        "parameters": numbers,
        "equation": equation(CATALOGUE[c.terms[0]])
        if c.terms and c.terms[0] in CATALOGUE
        else EFFECTS[c.effect].equation,
        "share": {str(j): round(x, 3) for j, x in _shares(p, joints, a).items()},
        "next_motion": _what_next(p, c, a),
    }


def _what_next(p: Parts, c: Candidate, a: Accepted) -> str | None:
    if not a.alike:
        return None
    return p.next_motion.text if p.next_motion is not None else EFFECTS[c.effect].motion


def _joints(p: Parts, c: Candidate) -> list[int]:
    return _every_joint(p) if c.joint is None else [c.joint + 1]


def _every_joint(p: Parts) -> list[int]:
    return list(range(1, p.evidence.setup.space.dof + 1))


def _confidence(a: Accepted) -> float:
    """Probability of the name: odds of the evidence, tempered by steadiness, split with its rivals."""
    sure = float(norm.cdf(a.score.steadiness)) * float(1 - np.exp(-max(a.score.total, 0.0) / 10))
    return round(SUREST * sure / (1 + 0.5 * len(a.names)), 3)


def _shares(p: Parts, joints: Sequence[int], a: Accepted) -> dict[int, float]:
    """Share of each joint's unexplained left-out variance; several findings on a joint share by evidence."""
    before, after = p.proof.before, p.proof.after
    found = {}
    for j in joints:
        same = [x for x in p.judged.accepted if x.is_finding and x.score.candidate.joint in (None, j - 1)]
        part = a.score.evidence / max(sum(x.score.evidence for x in same), 1e-12)
        whole = 1 - (after[j - 1] / max(before[j - 1], 1e-12)) ** 2 - _carried_share(p, j - 1)
        found[j] = float(np.clip(whole * part, 0, 1))
    return found


def _carried(p: Parts, load: Carried) -> dict[str, Any]:
    """Return the finding of a load that is picked up and put down: a payload with intervals."""
    joints = _every_joint(p)
    return {
        "effect": "payload",
        "joints": joints,
        "indistinguishable_from": [],
        "confidence": SUREST,
        "parameters": payload_numbers(load.value, load.covariance, p.nominal),
        "equation": EFFECTS["payload"].equation,
        "share": {str(j): round(_carried_share(p, j - 1), 3) for j in joints},
        "intervals": [[round(x, 3) for x in span] for span in load.intervals],
        "next_motion": None,
    }


def _carried_share(p: Parts, j: int) -> float:
    """Share of a joint's unexplained left-out variance that the load takes where it is held."""
    if p.unloaded is None:
        return 0.0
    return float(np.clip(1 - (p.unloaded[j] / max(p.proof.before[j], 1e-12)) ** 2, 0, 1))


def _contact(p: Parts, found: Pushed) -> dict[str, Any]:
    """Return the finding of pushes, however short they are, or of a load that is held for as short."""
    pushes, weight = found.contact.pushes, found.contact.weight
    if weight:
        effect, alike, joints = "payload", ["external_contact"], _every_joint(p)
        numbers = payload_numbers(weight.value, weight.covariance, p.nominal)
    else:
        effect, alike = "external_contact", ["payload"] if found.contact.weighs else []
        joints = [j + 1 for j in involved(pushes)]
        numbers = {"force": quantity(found.contact.force, None, "N")}
        numbers |= {f"torque_{j}": quantity(_strongest(pushes, j - 1), None, "Nm") for j in joints}
    return {
        "effect": effect,
        "joints": joints,
        "indistinguishable_from": alike,
        "confidence": 0.45 if alike else 0.9,
        "parameters": numbers,
        "equation": EFFECTS[effect].equation,
        "share": {str(j): round(_episode_share(p, pushes, j - 1), 3) for j in joints},
        "intervals": [[round(x, 3) for x in e.span] for e in pushes],
        "next_motion": EFFECTS["payload"].motion if alike else None,
    }


def _strength(p: Parts, a: Accepted) -> float:
    """Nats on the rows of the slow band, from the share that it explains there."""
    return nats_from(a.share, effective(p.evidence, a.score.candidate.joint))


def _strongest(episodes: Sequence[Episode], j: int) -> float:
    return float(max((e.mean[j] for e in episodes), key=abs))


def _episode_share(p: Parts, episodes: Sequence[Episode], j: int) -> float:
    inside = sum(float(e.rms[j] ** 2) * (e.rows.stop - e.rows.start) for e in episodes)
    total = sum(float((x[:, j] ** 2).sum()) for x in p.left)
    return float(min(inside / max(total, 1e-12), 1.0))


def _strange(p: Parts) -> list[dict[str, Any]]:
    """Return what stays unexplained, a joint at a time; beside pushes, episodes are what is left of them."""
    shares = {u.joint: u.share for u in p.unknowns}
    if p.episodes and not p.pushed:
        for j in involved(p.episodes):
            if (share := _episode_share(p, p.episodes, j)) > _EPISODE_SHARE:
                shares[j] = max(shares.get(j, 0.0), share)
    spans = [] if p.pushed else [[round(x, 3) for x in e.span] for e in p.episodes]
    found = []
    for j, share in sorted(shares.items(), key=lambda x: -x[1]):
        item: dict[str, Any] = {
            "effect": "unknown", "joints": [j + 1], "indistinguishable_from": [], "confidence": 0.9,
            "parameters": {}, "equation": r"\tau_{\mathrm{unexplained}}",
            "share": {str(j + 1): round(share, 3)},
            "next_motion": "slow and fast sweeps of this joint alone, then with the arm in another pose",
        }  # fmt: skip
        if spans:
            item["intervals"] = spans
        found.append(item)
    return found
