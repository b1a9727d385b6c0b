"""Composes the answer: findings.json, the sentence, what was ruled out."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm

from ..recordings import Recording
from ..recordings.report import AuditReport
from ..robots import Robot
from ..robots.model import Model
from ..symbolic.effects import EFFECTS
from ..symbolic.terms import CATALOGUE
from ..symbolic.terms.forms import equation
from .acceptance import EVIDENCE
from .candidates import Candidate
from .carried import Carried
from .episodes import Contact, Episode, involved
from .evidence import Evidence
from .judging import Accepted, Judged, effective, nats_from
from .quantities import Quantity, parameters_of, payload_numbers, quantity
from .refit import LeftOut, observed_runs
from .report.wording import joints_text, title
from .result import Explanation, NextMotion, Proof, Region, RuledOut, Source, Trace
from .sharpen import Sharp, without
from .unknown import Unknown

Array = NDArray[np.float64]

#: On concealed cases (docs/trials.md), some outside the catalogue, this share of the surest names was right.
SUREST = 0.85
#: Of a joint's left-out squares, for episodes to be worth a word; nats, for those that are a force.
_EPISODE_SHARE, _PUSH = 0.1, 10 * EVIDENCE


@dataclass(frozen=True)
class Parts:
    """Everything that was found out, before it is put into words; left: what all names leave, by run."""

    robot: Robot
    nominal: Model
    sources: tuple[Source, ...]
    evidence: Evidence
    judged: Judged
    sharp: Mapping[int, Sharp]
    episodes: Sequence[Episode]
    left: Sequence[Array]
    contact: Contact | None
    unknowns: Sequence[Unknown]
    proof: Proof
    before: LeftOut
    after: LeftOut
    placebos: float | None
    regions: tuple[Region, ...]
    names: Sequence[str]
    lacks: tuple[str, ...]
    model: Model
    next_motion: NextMotion | None = None
    carried: Carried | None = None


def compose(p: Parts) -> Explanation:
    """Return the whole answer."""
    strengths = [(_strength(p, a), _named(p, k, a)) for k, a in enumerate(p.judged.accepted) if a.is_finding]
    pushes = _contact(p)
    strengths += [(_squares(p), f) for f in pushes]
    strengths += [(c.evidence, _carried(p, c)) for c in (p.carried,) if c]
    findings = [f for _, f in sorted(strengths, key=lambda x: -x[0])]
    strange = _strange(p, bool(pushes))
    findings += strange
    verdict = _verdict(findings, strange)
    answer = {
        "schema": 1,
        "verdict": verdict,
        "findings": findings,
        "where": [_place(r) for r in p.regions],
        "fit": {
            "unit": "Nm",
            "scheme": p.proof.scheme,
            "before": _row(p.proof.before),
            "after": _row(p.proof.after),
            "after_interval95": [_row(x) for x in p.proof.interval],
        },
        "placebo_rate": p.placebos,
    }
    return Explanation(
        p.robot.title, p.sources, answer, sentence(verdict, findings), p.model, p.proof, p.regions,
        _traces(p), _ruled_out(p), _curves(p), p.lacks, p.next_motion,
    )  # fmt: skip


def _row(values: Array) -> list[float]:
    return [float(f"{v:.5g}") for v in values]


def _verdict(findings: Sequence[Mapping[str, Any]], strange: Sequence[Mapping[str, Any]]) -> str:
    if not findings:
        return "nothing_missing"
    if len(strange) == len(findings):
        return "unexplained"
    return "partly_explained" if strange else "explained"


def _named(p: Parts, k: int, a: Accepted) -> dict[str, Any]:
    c = a.score.candidate
    sharp = p.sharp.get(k)
    numbers: dict[str, Quantity] = dict(
        parameters_of(
            p.evidence,
            without(p.judged, k),
            a.score,
            p.nominal,
            sharp.std if sharp else None,
        )
    )
    for name, value in (sharp.value if sharp else {}).items():
        numbers[name] = quantity(value, sharp.std if sharp else None, numbers[name]["unit"])
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
    return list(range(1, p.evidence.setup.space.dof + 1)) if c.joint is None else [c.joint + 1]


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
    joints = list(range(1, p.evidence.setup.space.dof + 1))
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
    if p.carried is None:
        return 0.0
    left = np.concatenate([e[:, j] for e in p.before.residual])
    load = np.concatenate([t[:, j] for t in p.carried.torque])
    rest = float(np.sum((left - load) ** 2)) / max(float(np.sum(left**2)), 1e-12)
    return float(np.clip(1 - rest, 0, 1))


def _contact(p: Parts) -> list[dict[str, Any]]:
    """Episodes that a force explains on several joints are forces from outside, however short they are.

    But not where a gear has slack: its blows shake the whole arm.
    """
    slack = any(a.score.candidate.effect == "backlash" for a in p.judged.accepted)
    if p.contact is None or slack or _squares(p) < _PUSH:
        return []
    pushes = p.contact.pushes
    joints = [j + 1 for j in involved(pushes)]
    return [
        {
            "effect": "external_contact",
            "joints": joints,
            "indistinguishable_from": [],
            "confidence": 0.9,
            "parameters": {"force": quantity(p.contact.force, None, "N")}
            | {f"torque_{j}": quantity(_strongest(pushes, j - 1), None, "Nm") for j in joints},
            "equation": EFFECTS["external_contact"].equation,
            "share": {str(j): round(_episode_share(p, pushes, j - 1), 3) for j in joints},
            "intervals": [[round(x, 3) for x in e.span] for e in pushes],
            "next_motion": None,
        }
    ]


def _strength(p: Parts, a: Accepted) -> float:
    """Nats on the rows of the slow band, from the share that it explains there."""
    return nats_from(a.share, effective(p.evidence, a.score.candidate.joint))


def _squares(p: Parts) -> float:
    """Evidence of the episodes, nats: half their squared residuals over the noise, memory taken off."""
    return 0.5 * sum(e.worth for e in p.episodes) / float(np.mean(p.evidence.scales.inflation))


def _strongest(episodes: Sequence[Episode], j: int) -> float:
    return float(max((e.mean[j] for e in episodes), key=abs))


def _episode_share(p: Parts, episodes: Sequence[Episode], j: int) -> float:
    inside = sum(float(e.rms[j] ** 2) * (e.rows.stop - e.rows.start) for e in episodes)
    total = sum(float((x[:, j] ** 2).sum()) for x in p.left)
    return float(min(inside / max(total, 1e-12), 1.0))


def _strange(p: Parts, contact: bool) -> list[dict[str, Any]]:
    """Return what stays unexplained, a joint at a time; contact: whether episodes have a name."""
    shares = {u.joint: u.share for u in p.unknowns}
    if p.episodes and not contact:
        for j in involved(p.episodes):
            if (share := _episode_share(p, p.episodes, j)) > _EPISODE_SHARE:
                shares[j] = max(shares.get(j, 0.0), share)
    spans = [] if contact else [[round(x, 3) for x in e.span] for e in p.episodes]
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


def _place(r: Region) -> dict[str, Any]:
    return {
        "joint": r.joint, "share": round(r.share, 3), "variable": r.variable,
        "range": [float(f"{r.low:.4g}"), float(f"{r.high:.4g}")], "recording": r.recording,
        "intervals": [[round(a, 3), round(b, 3)] for a, b in r.intervals],
    }  # fmt: skip


def sentence(verdict: str, findings: Sequence[Mapping[str, Any]]) -> str:
    """Return the answer in a sentence."""
    if verdict == "nothing_missing":
        return "Nothing is missing: the model explains these recordings to within their noise."
    if verdict == "bad_data":
        return "These recordings cannot be used: nothing was concluded from them."
    named = [f for f in findings if f["effect"] != "unknown"]
    unknown = sorted({j for f in findings if f["effect"] == "unknown" for j in f["joints"]})
    parts = [
        f"{title(f['effect'])}{_held(f)} on {joints_text(f['joints'])}{_numbers(f['parameters'])}"
        for f in named
    ]
    if unknown:
        parts.append(f"{title('unknown')} on {joints_text(unknown)}")
    return "Missing from the model: " + "; and ".join(parts) + "."


def _held(finding: Mapping[str, Any]) -> str:
    count = len(finding.get("intervals", ())) if finding["effect"] == "payload" else 0
    return f", held in {count} stretch{'es' * (count > 1)} of time," if count else ""


def _numbers(parameters: Mapping[str, Quantity]) -> str:
    shown = []
    for name, x in list(parameters.items())[:2]:
        if isinstance(x["value"], float):
            spread = "" if x["std"] is None else f" ± {x['std']:.2g}"
            unit = "" if x["unit"] == "1" else f" {x['unit']}"
            shown.append(f"{name} {x['value']:.3g}{spread}{unit}")
    return f" ({', '.join(shown)})" if shown else ""


def _ruled_out(p: Parts) -> tuple[RuledOut, ...]:
    found = []
    for a in p.judged.accepted:
        c = a.score.candidate
        for rival, lead, steady in a.rivals:
            joint = None if rival.joint is None else rival.joint + 1
            found.append(
                RuledOut(
                    rival.effect, joint,
                    f"{title(c.effect)} explains the same data better"
                    f" by {lead:.0f} nats (steady: t = {steady:.1f})",
                )
            )  # fmt: skip
    for s, why in p.judged.refused:
        if s.candidate.effect != "base_free":
            joint = None if s.candidate.joint is None else s.candidate.joint + 1
            found.append(RuledOut(s.candidate.effect, joint, why))
    return tuple(found)


def _traces(p: Parts) -> tuple[Trace, ...]:
    """Residuals over time of the joints that matter, or of all when nothing was found."""
    space = p.evidence.setup.space
    mattering = {a.score.candidate.joint for a in p.judged.accepted} | {u.joint for u in p.unknowns}
    mattering |= set(involved(p.episodes)) if p.episodes else set()
    mattering |= set(range(space.dof)) if p.carried else set()
    joints = sorted(j for j in mattering if j is not None) or list(range(space.dof))
    found = []
    for i, run in enumerate(observed_runs(p.evidence)):
        rows = p.evidence.runs[run]
        for j in joints:
            found.append(
                Trace(
                    p.names[i], j + 1, rows.time, p.before.residual[i][:, j], p.after.residual[i][:, j],
                    p.before.residual[i][:, j] - p.after.residual[i][:, j], rows.q[:, j], rows.qd[:, j],
                    rows.load[:, j], rows.temperature[:, j], rows.since[:, j],
                )
            )  # fmt: skip
    return tuple(found)


def _curves(p: Parts) -> dict[int, tuple[str, Array, Array]]:
    """For unknown joints: mean residual over the variable that locates it. Not physics."""
    found = {}
    places = {r.joint - 1: r for r in p.regions}
    for u in p.unknowns:
        if (place := places.get(u.joint)) is None or place.variable in ("t", "motor"):
            continue
        runs = [p.evidence.runs[r] for r in observed_runs(p.evidence)]
        x = np.concatenate([getattr(r, place.variable)[:, u.joint] for r in runs])
        y = np.concatenate([e[:, u.joint] for e in p.after.residual])
        edges = np.unique(np.quantile(x, np.linspace(0, 1, 25)))
        which = np.clip(np.searchsorted(edges, x) - 1, 0, len(edges) - 2)
        mean = np.array([y[which == b].mean() if (which == b).any() else 0.0 for b in range(len(edges) - 1)])
        found[u.joint + 1] = (place.variable, (edges[:-1] + edges[1:]) / 2, mean)
    return found


def bad_data(
    robot: Robot, nominal: Model, sources: tuple[Source, ...],
    refusals: Sequence[tuple[Recording, AuditReport]], texts: tuple[str, ...] = (),
) -> Explanation:  # fmt: skip
    """Return the answer to recordings from which nothing can be concluded."""
    n = nominal.dof
    findings = []
    for recording, report in refusals:
        for f in report.findings:
            if f.severity == "refuse":
                texts = (*texts, f"{recording.name}: {f.text}" + (f"; {f.remedy}" if f.remedy else ""))
                findings.append(
                    {
                        "effect": "data_fault", "joints": [j for j in f.joints if j <= 6],
                        "indistinguishable_from": [], "confidence": 0.99, "parameters": {}, "equation": "",
                        "share": {}, "intervals": [list(i) for i in f.intervals],
                        "next_motion": f.remedy or None,
                    }
                )  # fmt: skip
    none = np.zeros(n)
    proof = Proof("nothing was fitted", none, none, np.zeros((n, 2)), none, none * np.nan, none, none, 1.0)
    answer = {
        "schema": 1, "verdict": "bad_data", "findings": findings, "where": [],
        "fit": {"unit": "Nm", "scheme": proof.scheme, "before": [], "after": [], "after_interval95": []},
        "placebo_rate": None,
    }  # fmt: skip
    said = sentence("bad_data", findings) + (f" {texts[0][0].upper()}{texts[0][1:]}." if texts else "")
    return Explanation(robot.title, sources, answer, said, nominal, proof, (), (), (), {}, texts, None)
