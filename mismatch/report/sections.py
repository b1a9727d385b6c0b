"""The page's sections as data: findings, numbers by joint, what was ruled out, what to do, what was read."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...symbolic.effects import EFFECTS
from ..result import Explanation, Proof
from . import wording as w
from .places import named

Array = NDArray[np.float64]
Row = dict[str, Any]

#: Joints that a sentence lists one by one.
FEW = 3


def facts(e: Explanation) -> list[tuple[str, str]]:
    """Return the few numbers that stand right below the answer: (what, value)."""
    found = e.findings["findings"]
    rows = []
    joints = sorted({j for f in found for j in f["joints"]})
    if joints:
        rows.append(("Where", w.capital(w.joints_text(joints, e.model.dof))))
    best = _most_lowered(e.proof.before, e.proof.after) if named(e) else None
    if best is not None:
        was, becomes = e.proof.before[best], e.proof.after[best]
        text = f"{w.plain(was)} → {w.plain(becomes)} Nm".replace(" ", w.NARROW)
        rows.append((f"Error, joint {best + 1}", text))
    if found and found[0]["effect"] != "data_fault":
        rows.append(("Confidence", w.percent(found[0]["confidence"])))
    observed = [s for s in e.sources if not s.reference]
    count = f"{len(observed)} recording{'s' * (len(observed) != 1)}"
    rows.append(("From", f"{count}, {w.duration(sum(s.seconds for s in observed))}"))
    return rows


def finding_rows(e: Explanation) -> list[Row]:
    """Return what the page says of each finding."""
    return [_finding(f, e.model.dof) for f in e.findings["findings"]]


def _finding(f: Mapping[str, Any], dof: int) -> Row:
    effect = EFFECTS.get(f["effect"])
    return {
        "title": w.title(f["effect"]),
        "name": f["effect"],
        "joints": _sits_on(f, dof),
        "confidence": w.percent(f["confidence"]),
        "shares": [f"joint {j}: {w.percent(s)}" for j, s in sorted(f["share"].items())],
        "parameters": [
            (w.parameter_name(f["effect"], n), w.quantity(p["value"], p["std"], p["unit"]))
            for n, p in f["parameters"].items()
        ],
        "equations": w.mathml(f["equation"]) if effect else [],
        "alike": [f"“{w.title(n)}”" for n in f["indistinguishable_from"]],
        "signature": effect.signature if effect else "",
        "source": effect.source if effect else "",
        "intervals": w.intervals_text(f.get("intervals", ())),
        "physics": effect is not None,
    }


def _sits_on(f: Mapping[str, Any], dof: int) -> str:
    """Return a finding's joints in words; a fault without joints is one of the whole recording."""
    return w.joints_text(f["joints"], dof) if f["joints"] else "the whole recording"


def by_joint(p: Proof) -> list[Row]:
    """Return the numbers of the proof in words, a row a joint; torques of a kind with the same places."""
    nm, limit = _torques(p.before, p.after), _torques(p.threshold_before, p.threshold_after)
    return [
        {
            "joint": j + 1,
            "before": nm(p.before[j]),
            "after": nm(p.after[j]),
            "interval": f"{nm(p.interval[j, 0])}–{nm(p.interval[j, 1])}",
            "ceiling": nm(p.ceiling[j]),
            "reached": w.percent(p.reached[j]),
            "threshold_before": limit(p.threshold_before[j]),
            "threshold_after": limit(p.threshold_after[j]),
            "threshold_change": w.percent(_change(p.threshold_before[j], p.threshold_after[j])),
        }
        for j in range(len(p.before))
    ]


def reached(p: Proof) -> str:
    """Return in words how much of what the flexible black box explains the named physics does."""
    parts = {j: float(np.clip(s, 0, 1)) for j, s in enumerate(p.reached, start=1) if np.isfinite(s)}
    if len(parts) > FEW:
        return f"{w.percent(min(parts.values()))} to {w.percent(max(parts.values()))}, by joint"
    return w.listed(f"{w.percent(s)} on joint {j}" for j, s in parts.items())


def detection(p: Proof) -> str:
    """Return in words what the findings do for collision detection."""
    rate = f"at the same rate of false alarms, {w.plain(p.false_alarms)} an hour"
    best = _most_lowered(p.threshold_before, p.threshold_after)
    if best is None:
        return f"Thresholds {rate}: none gets lower."
    nm = _torques(p.threshold_before, p.threshold_after)
    was, becomes = nm(p.threshold_before[best]), nm(p.threshold_after[best])
    return f"On joint {best + 1} a contact shows from {becomes} Nm on, instead of {was} Nm, {rate}."


def ruled_out(e: Explanation) -> list[Row]:
    """Return what was considered and is not the answer."""
    return [
        {
            "title": w.capital(w.title(r.effect)),
            "joint": "all" if r.joint is None else str(r.joint),
            "reason": w.capital(r.reason),
        }
        for r in e.ruled_out
    ]


def advice(e: Explanation) -> list[tuple[str, str]]:
    """Return what to do next: (what for, what to do)."""
    rows = []
    for f in e.findings["findings"]:
        effect = EFFECTS.get(f["effect"])
        about = f"{w.capital(w.title(f['effect']))} ({_sits_on(f, e.model.dof)})"
        if effect:
            rows.append((about, w.capital(effect.remedy)))
        if f["next_motion"] and e.next_motion is None:
            rows.append(("To settle it" if effect else about, w.capital(f["next_motion"])))
    return rows + _GENERAL.get(e.findings["verdict"], [])


_GENERAL: Mapping[str, list[tuple[str, str]]] = {
    "nothing_missing": [("The model", "Keep it: it describes these motions as well as anything does.")],
    "unexplained": [
        (
            "The place",
            "Look at the joint where it is marked: a cable, a bracket, a contact, a tool.",
        ),
        ("The model", "Do not put the flexible curve into the model: it is no physics and holds only here."),
    ],
    "bad_data": [("The recording", "Mend what is listed above and record anew; residuum audit checks it.")],
}


def next_motion(e: Explanation) -> Row | None:
    """Return the motion that would settle what these recordings cannot; waypoints in degrees."""
    if e.next_motion is None:
        return None
    m = e.next_motion
    return {
        "text": m.text,
        "waypoints": [[f"{x:.1f}".replace("-", "−") for x in row] for row in np.rad2deg(m.waypoints)],
        "speed": f"{w.plain(m.speed)} rad/s",
        "script": m.script,
        "lines": len(m.script.splitlines()),
        "separation": [(w.capital(k.replace(" | ", " or ")), w.plain(v)) for k, v in m.separation.items()],
    }


def sources(e: Explanation) -> list[Row]:
    """Return the recordings that were read."""
    return [
        {
            "name": s.name,
            "role": "reference" if s.reference else "explained",
            "seconds": w.duration(s.seconds),
            "rate": f"{w.plain(s.rate)}{w.NARROW}Hz",
            "notes": [w.capital(n) for n in s.notes],
        }
        for s in e.sources
    ]


def _most_lowered(before: Array, after: Array) -> int | None:
    """Return the joint (from 0) whose torque (N,) fell most, None where none did."""
    gain = np.where(np.isfinite(before - after), before - after, -np.inf)
    return int(np.argmax(gain)) if len(gain) and gain.max() > 0 else None


def _torques(*values: Array) -> Callable[[float], str]:
    """Return what prints torques (Nm) with two places, or three where the least of them needs it."""
    each = np.concatenate(values)
    small = each[np.isfinite(each) & (each > 0)]
    places = 3 if len(small) and small.min() < 0.05 else 2
    return lambda x: f"{x:.{places}f}" if np.isfinite(x) else "–"


def _change(before: float, after: float) -> float:
    return after / before - 1 if before > 0 else float("nan")
