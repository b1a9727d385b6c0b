"""Pushes: a force that comes and goes, and reaches several joints at once through the arm's geometry.

A push by a person or a thing bends a fit that does not expect it, so they are looked for in what a fit to the
quiet rows leaves. A brake that drags or a loose plug stays on one joint, and is none.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .acceptance import EVIDENCE
from .episodes import MOST, Episode, episodes, loudness
from .evidence import Evidence, renewed, residual, weighed
from .judging import Judged
from .physics import Physics, fitted_force, forces
from .refit import observed_runs, parameters
from .rows import Rows, kept
from .selection import Directions

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

#: Share of the joints' squared residuals that one force must explain; N; the force's mean over its mean size:
#: a push keeps its direction, what a wrong delay leaves at jerks does not.
FORCE, STRONGEST, WEAKEST, AIMED = 0.8, 500.0, 1.0, 0.5
#: Mean squared residual over noise of a joint that a force reaches.
LOUD = 10.0
#: Share of what comes and goes that pushes make, and those of them that reach two joints loudly.
NEARLY, HALF = 0.8, 0.5
#: Nats; rounds of finding the quiet rows; s around a push in which it may have begun and ended.
_LEAST, _ROUNDS, _AROUND = 10 * EVIDENCE, 6, 0.5


@dataclass(frozen=True)
class Contact:
    """Episodes that a force explains on all joints, and the strongest one's force, N."""

    pushes: tuple[Episode, ...]
    force: float


@dataclass(frozen=True)
class Pushed:
    """Pushes, their evidence (nats), and the rows (n,) of each observed run that are far from any."""

    contact: Contact
    evidence: float
    free: tuple[Flags, ...]


def pushed(evidence: Evidence, judged: Judged) -> Pushed | None:
    """Return the pushes in what a model that is fitted to the quiet rows leaves, or None.

    None, too, where a gear has slack: its blows shake the whole arm.
    """
    if any(a.score.candidate.effect == "backlash" for a in judged.accepted):
        return None
    which = observed_runs(evidence)
    left = dict(zip(which, _left_by_quiet(evidence, judged.model), strict=True))
    scales, runs = evidence.scales, evidence.runs
    found = episodes(runs, which, [left[r] for r in which], scales, evidence.setup.friction[:, 0])
    # half the squared residuals over the noise, memory taken off
    worth = 0.5 * sum(e.worth for e in found) / float(np.mean(scales.inflation))
    force = contact(found, runs, left, evidence.setup.physics, scales.sigma[:, 0])
    if force is None or worth < _LEAST:
        return None
    free = {r: np.ones(len(runs[r]), np.bool_) for r in which}
    for e in force.pushes:
        more = round(_AROUND / runs[e.run].step)
        free[e.run][max(0, e.rows.start - more) : e.rows.stop + more] = False
    if not all(rows.any() for rows in free.values()):
        return None  # nothing is left to learn from
    return Pushed(force, worth, tuple(free[r] for r in which))


def released(evidence: Evidence, found: Pushed) -> Evidence:
    """Return the evidence of the rows without pushes."""
    return renewed(evidence, _keeping(evidence, found.free).runs)


def with_pushes(free: Sequence[Array], whole: Sequence[Array], found: Pushed) -> tuple[Array, ...]:
    """Return residuals (n, N) of all rows of each observed run.

    free: of those without pushes, which take the place of theirs in whole: of all rows, under one fit.
    """
    every = tuple(x.copy() for x in whole)
    for x, own, at in zip(every, free, found.free, strict=True):
        x[at] = own
    return every


def _keeping(evidence: Evidence, rows: Sequence[Flags]) -> Evidence:
    """Return the evidence with some rows (n,) of each observed run, its sums not yet made anew."""
    runs = list(evidence.runs)
    for r, some in zip(observed_runs(evidence), rows, strict=True):
        runs[r] = kept(runs[r], some)
    return replace(evidence, runs=tuple(runs))


def contact(
    found: Sequence[Episode], runs: Sequence[Rows], left: Mapping[int, Array], physics: Physics, sigma: Array
) -> Contact | None:
    """Return the pushes among the episodes, or None where they are not nearly all of what comes and goes.

    At least half of it has to reach two joints loudly: one joint alone is no push.

    left: residuals (n, N) by run; sigma (N,) Nm: noise of the joints. Each push has a link of its own. A
    force has three components and the joints are six, so that what is no force leaves most of itself.
    """
    pushes, strong, most = list[Episode](), 0.0, 0.0
    for e in found:
        share, force, aimed = max(
            _force(physics, runs[e.run].q[e.rows], left[e.run][e.rows], sigma, frame)
            for frame in range(3, physics.dof + 1)
        )
        if share > FORCE and WEAKEST < force < STRONGEST and aimed > AIMED:
            pushes.append(e)
            most = max(most, force)
            strong += e.worth if np.sum(e.strength > LOUD) >= 2 else 0.0
    total = sum(e.worth for e in found)
    nearly = sum(e.worth for e in pushes) > NEARLY * total and strong > HALF * total
    return Contact(tuple(pushes), most) if nearly else None


def _left_by_quiet(evidence: Evidence, model: Directions) -> list[Array]:
    """Return what a model that is fitted to the quiet rows leaves of each observed run (n, N), Nm.

    As long as more than MOST is loud, the quieter part counts as quiet (concentration steps of least trimmed
    squares; Rousseeuw and Van Driessen 2006).
    """
    which, coulomb = observed_runs(evidence), evidence.setup.friction[:, 0]
    space, fit = evidence.setup.space, evidence
    quiet: list[Flags] = [np.ones(len(evidence.runs[r]), bool) for r in which]
    for _ in range(_ROUNDS):
        own = parameters(fit, model)
        left = [residual(evidence.runs[r], space, own) for r in which]
        loud = [
            loudness(evidence.runs[r], e, evidence.scales, coulomb) for r, e in zip(which, left, strict=True)
        ]
        limit = max(1.0, float(np.quantile(np.concatenate(loud), 1 - MOST)))
        before, quiet = quiet, [x <= limit for x in loud]
        if all(np.array_equal(a, b) for a, b in zip(before, quiet, strict=True)):
            break
        fit = weighed(_keeping(evidence, quiet), evidence.noise)
    return left


def _force(physics: Physics, q: Array, left: Array, sigma: Array, frame: int) -> tuple[float, float, float]:
    """Return the share of residuals (n, N) that a force at a frame's origin explains, and its size, N.

    Last, its mean over its mean size: 1 where it keeps its direction.
    """
    columns = forces(physics, q, frame) / sigma[:, None]  # (n, N, 3)
    target = left / sigma
    force = fitted_force(columns, target)
    rest = float(np.sum((target - np.einsum("tji,ti->tj", columns, force)) ** 2))
    share = 1 - rest / max(float(np.sum(target**2)), 1e-12)
    size = np.linalg.norm(force, axis=1)
    aimed = float(np.linalg.norm(force.mean(axis=0)) / max(float(size.mean()), 1e-12))
    return share, float(np.median(size)), aimed
