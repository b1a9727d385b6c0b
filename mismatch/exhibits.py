"""What the page shows beside the findings: residuals over time, what was ruled out, curves of the unknown."""

import numpy as np
from numpy.typing import NDArray

from .episodes import involved
from .parts import Parts
from .report.wording import title
from .result import RuledOut, Trace

Array = NDArray[np.float64]


def traces(p: Parts) -> tuple[Trace, ...]:
    """Return residuals over time of the joints that matter, or of all when nothing was found."""
    space = p.evidence.setup.space
    mattering = {a.score.candidate.joint for a in p.judged.accepted} | {u.joint for u in p.unknowns}
    touched = (*p.episodes, *(p.pushed.contact.pushes if p.pushed else ()))
    mattering |= set(involved(touched)) if touched else set()
    mattering |= set(range(space.dof)) if p.carried else set()
    joints = sorted(j for j in mattering if j is not None) or list(range(space.dof))
    found = []
    for i, rows in enumerate(p.runs):
        for j in joints:
            found.append(
                Trace(
                    p.names[i], j + 1, rows.time, p.before.residual[i][:, j], p.after.residual[i][:, j],
                    p.before.residual[i][:, j] - p.after.residual[i][:, j], rows.q[:, j], rows.qd[:, j],
                    rows.load[:, j], rows.temperature[:, j], rows.since[:, j],
                )
            )  # fmt: skip
    return tuple(found)


def ruled_out(p: Parts) -> tuple[RuledOut, ...]:
    """Return the rivals that were beaten, and the hypotheses that were refused, with the reason."""
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


def curves(p: Parts) -> dict[int, tuple[str, Array, Array]]:
    """Return for unknown joints the mean residual over the variable that locates it. Not physics."""
    found = {}
    places = {r.joint - 1: r for r in p.regions}
    for u in p.unknowns:
        if (place := places.get(u.joint)) is None or place.variable in ("t", "motor"):
            continue
        x = np.concatenate([getattr(r, place.variable)[:, u.joint] for r in p.runs])
        y = np.concatenate([e[:, u.joint] for e in p.after.residual])
        edges = np.unique(np.quantile(x, np.linspace(0, 1, 25)))
        which = np.clip(np.searchsorted(edges, x) - 1, 0, len(edges) - 2)
        mean = np.array([y[which == b].mean() if (which == b).any() else 0.0 for b in range(len(edges) - 1)])
        found[u.joint + 1] = (place.variable, (edges[:-1] + edges[1:]) / 2, mean)
    return found
