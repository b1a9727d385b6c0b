"""Pushes: a force that comes and goes, and reaches several joints at once through the arm's geometry.

A push by a person or a thing bends a fit that does not expect it, so loud ones are looked for in what a fit
to the quiet rows leaves, and faint ones (faint.py) where there are none. A brake that drags or a loose plug
stays on one joint, and is none.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .acceptance import EVIDENCE
from .episodes import MOST, Episode, episode, episodes, loudness, mostly_pushes, scaled, uncertainty
from .evidence import Evidence, renewed, residual
from .evidence import weighed as weighed_by
from .faint import faint
from .grams import regime
from .judging import Judged
from .physics import Physics, fitted_force, forces, levers
from .quantities import payload_columns
from .refit import observed_runs, parameters, residuals
from .rows import Rows, kept
from .segments import clear_of
from .selection import Directions
from .weight import Touch, Weight, weight_of
from .whitening import REST

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

#: Share of the joints' squared residuals that one force must explain at a frame's origin, and where its place
#: on the link is fitted as well; N.
FORCE, PLACED, STRONGEST, WEAKEST = 0.8, 0.95, 500.0, 1.0
#: The force's mean over its mean size: a push keeps its direction, what a delay leaves at jerks does not.
AIMED = 0.7
#: Mean squared residual over noise of a joint that a force reaches.
LOUD = 10.0
#: Nats; rounds of finding the quiet rows; s around a push in which it may have begun and ended.
_LEAST, _ROUNDS, _AROUND = 10 * EVIDENCE, 6, 0.5
#: Of an episode's squares, in a fit that has seen it: pushes bend it, but not all the way.
_STAYS = 0.3
#: A force that points down by this share of its size, so many s in all, may be a weight.
_DOWN, _HELD = 0.95, 2.0
#: m; how far from a frame's origin a link or what it holds is touched, usually and at most; rounds.
_GRIP, _REACH, _PLACES = 0.1, 0.3, 20


@dataclass(frozen=True)
class Contact:
    """Episodes that a force explains on all joints, and the strongest one's force, N.

    weighs: it only points down, as a load would that is picked up and put down; weight: of a load that
    explains them.
    """

    pushes: tuple[Episode, ...]
    force: float
    weighs: bool = False
    weight: Weight | None = None


@dataclass(frozen=True)
class Pushed:
    """Pushes, their evidence (nats), and the rows (n,) of each observed run that are far from any."""

    contact: Contact
    evidence: float
    free: tuple[Flags, ...]


def pushed(
    evidence: Evidence, judged: Judged, weighed: Evidence, handled: Mapping[int, Flags]
) -> Pushed | None:
    """Return the pushes in what a model leaves of the observed runs: loud ones, else faint ones, or None.

    None, too, where a gear has slack: its blows shake the whole arm. weighed: by what the model leaves.
    handled: rows (n,) by run in which a load is picked up or put down, which takes a touch.
    """
    if any(a.score.candidate.effect == "backlash" for a in judged.accepted):
        return None
    which, runs = observed_runs(evidence), evidence.runs
    named = [a.score.candidate for a in judged.accepted]
    soft = {c.joint for c in named if c.effect == "joint_elasticity" and c.joint is not None}
    found = _loud(evidence, judged.model, handled) or _faint(weighed, judged.model, handled, soft)
    if found is None:
        return None
    force, worth = found
    free = {r: np.ones(len(runs[r]), np.bool_) for r in which}
    for e in force.pushes:
        more = round(_AROUND / runs[e.run].step)
        free[e.run][max(0, e.rows.start - more) : e.rows.stop + more] = False
    if not all(rows.any() for rows in free.values()):
        return None  # nothing is left to learn from
    return Pushed(force, worth, tuple(free[r] for r in which))


def _loud(
    evidence: Evidence, model: Directions, handled: Mapping[int, Flags]
) -> tuple[Contact, float] | None:
    """Return pushes that leave the noise at once, where the model is fitted to the quiet rows, and nats."""
    which, scales, runs = observed_runs(evidence), evidence.scales, evidence.runs
    coulomb, (bent, quiet) = evidence.setup.friction[:, 0], _left_by_quiet(evidence, model)
    left = dict(zip(which, quiet, strict=True))
    fitted = {r: scaled(runs[r], e, scales, coulomb) for r, e in zip(which, bent, strict=True)}
    found = [
        e for e in episodes(runs, which, quiet, scales, coulomb)
        if _stays(e, fitted[e.run][e.rows]) and clear_of(handled, e.run, e.rows)
    ]  # fmt: skip
    # half the squared residuals over the noise, memory taken off
    worth = 0.5 * sum(e.worth for e in found) / float(np.mean(scales.inflation))
    sigma = {r: uncertainty(runs[r], scales, coulomb) for r in which}
    force = contact(found, runs, left, evidence.setup.physics, sigma)
    if not force or worth < _LEAST:
        return None
    touches = [_touch(evidence, e, left[e.run], sigma[e.run]) for e in force.pushes]
    return replace(force, weight=weight_of(evidence.setup.physics, touches)), worth


def _touch(evidence: Evidence, push: Episode, left: Array, sigma: Array) -> Touch:
    """Return the rows of a push, with what is left (n, N) of its run and known to sigma (n, N), Nm."""
    rows, at = evidence.runs[push.run], push.rows
    columns, moving = payload_columns(evidence, kept(rows, at)), regime(rows)[at] != REST
    return Touch(rows.q[at], left[at], sigma[at], columns, moving, rows.step)


def _stays(left_out: Episode, fitted: Array) -> bool:
    """Return whether an episode is there in a fit to all rows, too: else leaving it out has made it.

    fitted (n, N): what that fit leaves of its rows, in units of the noise.
    """
    return float(np.mean(fitted**2, axis=0).sum()) > _STAYS * float(left_out.strength.sum())


def _faint(
    weighed: Evidence, model: Directions, handled: Mapping[int, Flags], soft: set[int]
) -> tuple[Contact, float] | None:
    """Return pushes that stand out over the time they last alone, and their nats; soft: see `faint`."""
    left = residuals(weighed, model)
    found = faint(weighed, left, handled, soft)
    if not found:
        return None
    scales, coulomb, runs = weighed.scales, weighed.setup.friction[:, 0], weighed.runs
    over = {r: scaled(runs[r], left[r], scales, coulomb) for r in {s.run for s in found}}
    pushes = tuple(episode(s.run, s.rows, runs[s.run], left[s.run], over[s.run]) for s in found)
    strongest = max(float(np.linalg.norm(s.force)) for s in found)
    down = all(-s.force[2] > _DOWN * np.linalg.norm(s.force) for s in found)
    held = sum(e.span[1] - e.span[0] for e in pushes)
    return Contact(pushes, strongest, bool(down and held > _HELD)), sum(s.worth for s in found)


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
    found: Sequence[Episode], runs: Sequence[Rows], left: Mapping[int, Array], physics: Physics,
    sigma: Mapping[int, Array],
) -> Contact | None:  # fmt: skip
    """Return the pushes among the episodes, or None where they are not nearly all of what comes and goes.

    At least half of it has to reach two joints loudly: one joint alone is no push.

    left, sigma: residuals (n, N) by run, and what they are known to, Nm. Each push has a link of its own, and
    a place on it that stays. A force has three components and the joints are six, so that what is no force
    leaves most of itself.
    """
    pushes, strong, most = list[Episode](), 0.0, 0.0
    for e in found:
        force = _force(physics, runs[e.run].q[e.rows], left[e.run][e.rows], sigma[e.run][e.rows])
        if force and WEAKEST < force.size < STRONGEST and force.aimed > AIMED:
            pushes.append(e)
            most = max(most, force.size)
            strong += e.worth if np.sum(e.strength > LOUD) >= 2 else 0.0
    total = sum(e.worth for e in found)
    nearly = mostly_pushes(total, sum(e.worth for e in pushes), strong)
    return Contact(tuple(pushes), most) if nearly else None


def _left_by_quiet(evidence: Evidence, model: Directions) -> tuple[list[Array], list[Array]]:
    """Return what a model leaves of each observed run (n, N), Nm: fitted to all rows, and to the quiet ones.

    As long as more than MOST is loud, the quieter part counts as quiet (concentration steps of least trimmed
    squares; Rousseeuw and Van Driessen 2006).
    """
    which, coulomb = observed_runs(evidence), evidence.setup.friction[:, 0]
    space, fit = evidence.setup.space, evidence
    quiet: list[Flags] = [np.ones(len(evidence.runs[r]), bool) for r in which]
    first = left = list[Array]()
    for _ in range(_ROUNDS):
        own = parameters(fit, model)
        left = [residual(evidence.runs[r], space, own) for r in which]
        first = first or left
        loud = [
            loudness(evidence.runs[r], e, evidence.scales, coulomb) for r, e in zip(which, left, strict=True)
        ]
        limit = max(1.0, float(np.quantile(np.concatenate(loud), 1 - MOST)))
        before, quiet = quiet, [x <= limit for x in loud]
        if all(np.array_equal(a, b) for a, b in zip(before, quiet, strict=True)):
            break
        fit = weighed_by(_keeping(evidence, quiet), evidence.noise)
    return first, left


@dataclass(frozen=True)
class _Force:
    """A force that is fitted instant by instant: the share that it explains, its median size, N.

    aimed: its mean over its mean size, 1 where it keeps its direction.
    """

    share: float
    size: float
    aimed: float


def _force(physics: Physics, q: Array, left: Array, sigma: Array) -> _Force | None:
    """Return the one force that explains residuals (n, N), Nm, known to sigma (n, N), or None.

    It acts at the origin of a link's frame, or at a place on the link that is found with it.
    """
    links, target, per = range(3, physics.dof + 1), left / sigma, 1 / sigma[:, :, None]
    at = {k: forces(physics, q, k) * per for k in links}  # (n, N, 3)
    best = max((_fitted(columns, target) for columns in at.values()), key=lambda f: f.share)
    if best.share > FORCE:
        return best
    moved = {k: levers(physics, q, k) * per[:, :, None] for k in links}  # (n, N, 3, 3)
    placed = [at[k] + arms @ _place(at[k], arms, target) for k, arms in moved.items()]
    best = max((_fitted(columns, target) for columns in placed), key=lambda f: f.share)
    return best if best.share > PLACED else None


def _fitted(columns: Array, target: Array) -> _Force:
    force = fitted_force(columns, target)
    rest = float(np.sum((target - np.einsum("tji,ti->tj", columns, force)) ** 2))
    size = np.linalg.norm(force, axis=1)
    aimed = float(np.linalg.norm(force.mean(axis=0)) / max(float(size.mean()), 1e-12))
    return _Force(1 - rest / max(float(np.sum(target**2)), 1e-12), float(np.median(size)), aimed)


def _place(columns: Array, arms: Array, target: Array) -> Array:
    """Return where on a link (3,), m from its frame's origin, a force explains residuals best."""
    place = np.zeros(3)
    for _ in range(_PLACES):  # force and place in turn
        force = fitted_force(columns + arms @ place, target)
        turned = np.einsum("tjia,ti->tja", arms, force)
        beyond = target - np.einsum("tji,ti->tj", columns, force)
        gram = np.einsum("tja,tjb->ab", turned, turned) + np.eye(3) / _GRIP**2
        place = np.linalg.solve(gram, np.einsum("tja,tj->a", turned, beyond))
        place *= min(1.0, _REACH / max(float(np.linalg.norm(place)), 1e-12))
    return place
