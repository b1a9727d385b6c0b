"""Faint pushes: forces that do not leave the noise at any instant, but do over the time that they last.

A matched filter (Kay 1998, Fundamentals of Statistical Signal Processing II, ch. 7): every stretch of 0.25 to
4 s is asked how much likelier a constant force at a link is than nothing, in rows made independent
(whitening.py), so that what the residual remembers does not pass for a push.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from math import log

import numpy as np
from numpy.typing import NDArray

from .acceptance import EVIDENCE
from .episodes import mostly_pushes
from .evidence import Evidence
from .grams import roots
from .matched import Windows, windows
from .naming import APART
from .physics import forces
from .pool import each
from .segments import apart, clear_of, marginal

Array = NDArray[np.float64]

#: s, the shortest stretch; and its multiples that are tried: a longer push is several.
WINDOW, LENGTHS = 0.25, (1, 2, 3, 4, 6, 8, 12, 16)
#: N, prior width of a force's components; share that it explains of what an offset of each joint does.
STRENGTH, SHARE = 20.0, 0.8
#: So many times what comes and goes in the reference.
HEALTHY = 2.0
#: With a reference, so many times the nats: where it has not been, the healthy robot is known to less.
EXTRAPOLATED = 3.0
#: The first link that is pushed: below it a force acts on two joints at most.
_FIRST = 3


@dataclass(frozen=True)
class Stretch:
    """Rows of a run in which a constant force at a link may act, or offsets of the joints.

    nats, otherwise: by which the force, and offsets, are likelier than nothing; force (3,): N, along the
    base's axes; by_force, by_joint (N,): what the force, and an offset of each joint, gain there, nats.
    """

    run: int
    rows: slice
    nats: float
    force: Array
    by_force: Array
    otherwise: float
    by_joint: Array

    @property
    def worth(self) -> float:
        """Nats of what there is, force or not."""
        return max(self.nats, self.otherwise)

    @property
    def is_force(self) -> bool:
        """Whether the force explains nearly what offsets of all joints do."""
        return float(self.by_force.sum()) > SHARE * float(self.by_joint.sum())

    def lead(self, but: Collection[int] = ()) -> float:
        """Return the nats by which the force leads an offset of one joint, on all joints but some."""
        rest = [j for j in range(len(self.by_joint)) if j not in but]
        return float(self.by_force[rest].sum() - self.by_joint[rest].max(initial=0.0))


def faint(
    weighed: Evidence, left: Mapping[int, Array], handled: Mapping[int, NDArray[np.bool_]],
    soft: Collection[int] = (),
) -> list[Stretch]:  # fmt: skip
    """Return the faint pushes in what a model leaves (n, N) Nm of runs, or none.

    Each pays for having been sought everywhere, and they are more than what comes and goes in the reference;
    together they have the evidence for a name. None, too, unless they are nearly all that comes and goes, and
    half of it reaches more than one joint. weighed: by what the model leaves. handled: rows (n,) by observed
    run in which nothing is sought. soft: joints (0-based) whose gear was found to give way: what is left
    there is its own.
    """
    count, usual, every = 1, 0.0, list[Stretch]()
    for run, (tried, some) in zip(left, each(lambda r: _tried(weighed, r, left[r]), left), strict=True):
        if weighed.observed[run]:
            count, every = count + tried, every + [s for s in some if clear_of(handled, run, s.rows)]
        else:
            usual = max([usual, *(s.worth for s in some)])
    times = EXTRAPOLATED if weighed.has_reference else 1.0
    price = max(times * log(count), HEALTHY * usual)
    return believed(every, price, times * EVIDENCE, soft)


def believed(
    every: Sequence[Stretch], price: float, least: float, soft: Collection[int] = ()
) -> list[Stretch]:
    """Return the pushes among stretches that may overlap, if they are mostly that and tell enough together.

    price: nats that each pays for its place; least: nats that they have beyond that. soft: see `faint`.
    """
    loud = sorted((s for s in every if s.worth > price), key=lambda s: -s.worth)
    found = apart(loud, lambda s: (s.run, s.rows))
    pushes = [s for s in found if s.is_force and s.nats > price]
    total, nearly = (sum(s.worth - price for s in some) for some in (found, pushes))
    told = sum(s.worth - price for s in pushes if s.lead(soft) > APART)
    enough = sum(s.nats - price for s in pushes) > least
    return pushes if enough and mostly_pushes(total, nearly, told) else []


def _tried(weighed: Evidence, run: int, left: Array) -> tuple[int, list[Stretch]]:
    """Try every stretch of a run with a force at each link; return how many, and what is worth a look.

    left (n, N): Nm.
    """
    rows, physics = weighed.runs[run], weighed.setup.physics
    width, joints = max(1, round(WINDOW / rows.step)), range(physics.dof)
    noise = weighed.noise if weighed.observed[run] else weighed.scales
    whiten, ones = roots(rows, noise), np.ones((len(rows), 1))
    target = [w @ left[:, j] for j, w in enumerate(whiten)]
    offsets = [windows(whiten[j], ones, target[j], width) for j in joints]
    lengths = [k for k in LENGTHS if k * width <= len(rows)]
    by_joint = {k: _by_joint(offsets, 0.5 * weighed.torque, k) for k in lengths}
    count, found = 0, list[Stretch]()
    for link in range(_FIRST, physics.dof + 1):
        turns = forces(physics, rows.q, link)
        acts = [windows(whiten[j], turns[:, j], target[j], width) for j in joints]
        for length in lengths:
            at = [slice(k * width, (k + length) * width) for k in range(len(rows) // width - length + 1)]
            some = zip(at, *_by_force(acts, length), *by_joint[length], strict=True)
            count += len(at)
            found += [s for s in (Stretch(run, *x) for x in some) if s.worth > EVIDENCE]
    return count, found


def _by_force(acts: Sequence[Windows], length: int) -> tuple[Array, Array, Array]:
    """Return nats (S,), force (S, 3) and what it gains on each joint (S, N), of all stretches."""
    parts = [w.over(length) for w in acts]
    matrix, right = np.stack([a for a, _ in parts], axis=1), np.stack([b for _, b in parts], axis=1)
    nats, force = marginal(matrix.sum(axis=1), right.sum(axis=1), np.full(3, STRENGTH))
    squares = np.einsum("sa,sjab,sb->sj", force, matrix, force)
    return nats, force, np.einsum("sja,sa->sj", right, force) - 0.5 * squares


def _by_joint(offsets: Sequence[Windows], std: Array, length: int) -> tuple[Array, Array]:
    """Return nats (S,) of offsets, prior width std (N,) Nm, where joints ask for one; gains (S, N)."""
    parts = [w.over(length) for w in offsets]
    matrix, right = np.stack([a[:, 0, 0] for a, _ in parts], 1), np.stack([b[:, 0] for _, b in parts], 1)
    gain = 0.5 * right**2 / np.maximum(matrix, 1e-300)
    return np.maximum(gain - 0.5 * np.log1p(matrix * std**2), 0.0).sum(axis=1), gain
