"""The answerers. Each takes a case's files and returns the content of a findings.json."""

import numpy as np

from .columns import answer, finding
from .residuals import effective_rows, gain, problem, stepwise, width

SEEN = 0.3  # correlation from which the plain list names something
THRESHOLD = 0.1  # of STLSQ, in residual rms per column rms


def bic(files):
    """Stepwise BIC over candidate columns, every row counted."""
    p = problem(files)
    return answer([finding(g) for g in stepwise(p, [float(len(r)) for r in p.residual])])


def correlations(files):
    """The candidate that correlates best with the residual, if its multiple correlation is above 0.3."""
    p = problem(files)
    ranked = []
    for group in p.groups:
        own = [j for j, places in enumerate(group.places) if places]
        total = sum(float(p.residual[j] @ p.residual[j]) for j in own)
        ranked.append((np.sqrt(max(gain(p, p.residual, group)[0], 0.0) / max(total, 1e-12)), group))
    best, group = max(ranked, key=lambda pair: pair[0])
    return answer([finding(group, float(best))] if best > SEEN else [])


def sindy(files):
    """PySINDy's discrepancy model: sparse regression (STLSQ) of the residual on all candidates of a joint.

    A term is named with the effect that its column belongs to; strongest first.
    """
    import pysindy

    p, found = problem(files), {}
    for j in range(6):
        x = p.columns[j]
        size = np.sqrt((x**2).mean(0)) + 1e-12
        optimizer = pysindy.STLSQ(threshold=THRESHOLD, alpha=1e-3 * len(x), unbias=False)
        optimizer.fit(x / size, p.residual[j][:, None])
        weight = np.abs(np.asarray(optimizer.coef_)).ravel()
        for group in p.groups:
            places = list(group.places[j])
            if places and weight[places].max() > 0.0:
                found[group] = max(found.get(group, 0.0), float(weight[places].max()))
    ranked = sorted(found, key=lambda g: -found[g])
    return answer([finding(g) for g in ranked[:4]])


def flexible_stepwise(files):
    """Attempt 9 of the facts: a flexible fit to the reference removed, then BIC with effective rows."""
    p = problem(files, flexible=True)
    return answer([finding(g) for g in stepwise(p, [effective_rows(p, j) for j in range(6)])])


def joint_model(files):
    """Attempt 10 of the facts; see joint.py."""
    from .joint import named

    return answer([finding(g) for g in named(files)])


PEERS = {
    "bic": bic,
    "sindy": sindy,
    "correlations": correlations,
    "attempt9": flexible_stepwise,
    "attempt10": joint_model,
}
__all__ = ["PEERS", "width"]
