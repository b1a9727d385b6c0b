"""A plain leave-one-run-out namer: least squares, all moving rows alike, one column of the catalogue more.

What `real_noise.py` prints beside `explain`, on the same cases.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from added import plain_columns
from numpy.typing import NDArray

from residuum.mismatch.candidates import Candidate
from residuum.mismatch.evidence import Evidence
from residuum.mismatch.grams import regime

Array = NDArray[np.float64]

#: Of the left-out squared error that a name has to take away, and the share of runs where it does: so chosen that
#: at 0.1 and 0.2 it names about as much, and as much wrongly, as the published crude baseline.
SHARE, RUNS = 0.002, 0.6
#: Of a column's own squares, kept against columns that hardly differ.
RIDGE = 1e-9


@dataclass(frozen=True)
class Namer:
    """Normal equations of every run R and joint: grams[j] (R, P, P) of [fitted anyway | candidates].

    base[j]: how many columns are fitted anyway; known: what is taken for granted besides.
    """

    grams: tuple[Array, ...]
    rows: tuple[tuple[Array, ...], ...]  # [run][joint] (n, P), moving rows alone
    moving: tuple[NDArray[np.bool_], ...]
    base: tuple[int, ...]
    places: tuple[NDArray[np.int64], ...]  # [joint] (D,) of each direction, -1 where the joint has it not
    each: tuple[Candidate, ...]
    known: tuple[Candidate, ...] = ()

    def name(self, torques: Sequence[Array]) -> Candidate | None:
        """Return what lowers the left-out error most, if it is enough. torques: (n, N) by run."""
        gain = np.zeros((len(self.each), len(torques)))
        counts = np.sum([m.sum(axis=0) for m in self.moving], axis=0)  # (N,) rows
        for j, gram in enumerate(self.grams):
            y = [t[m[:, j], j] for t, m in zip(torques, self.moving, strict=True)]
            right = np.array([x[j].T @ v for x, v in zip(self.rows, y, strict=True)])
            squares = np.array([v @ v for v in y])
            fixed = np.concatenate([np.arange(self.base[j]), *(self._of(c, j) for c in self.known)])
            before = _left_out(gram, right, squares, fixed)
            noise = before.sum() / counts[j]
            for i, c in enumerate(self.each):
                own = np.setdiff1d(self._of(c, j), fixed)
                if len(own):
                    after = _left_out(gram, right, squares, np.concatenate([fixed, own]))
                    gain[i] += (before - after) / noise
        best = int(np.argmax(gain.sum(axis=1)))
        whole = counts.sum() if self.each[best].joint is None else counts.mean()
        believed = gain[best].sum() > SHARE * whole and np.mean(gain[best] > 0) >= RUNS
        return self.each[best] if believed else None

    def _of(self, c: Candidate, j: int) -> NDArray[np.int64]:
        """Return where a candidate's columns stand in a joint's rows."""
        own = self.places[j][list(c.columns)]
        return own[own >= 0]

    def knowing(self, torques: Sequence[Array]) -> "Namer":
        """Return the namer that takes for granted all that it names in these torques."""
        known = self
        while (more := known.name(torques)) and more not in known.known:
            known = replace(known, known=(*known.known, more))
        return known


def namer(evidence: Evidence, skip: Sequence[str]) -> Namer:
    """Return the namer for the recordings of some evidence; skip: effects that are no names here."""
    space, vectors = evidence.setup.space, evidence.found.directions.vectors.toarray()
    each = tuple(c for c in evidence.found.each if c.effect not in (*skip, "torque_ripple"))
    used = sorted({c for x in each for c in x.columns})
    moving = tuple(regime(r) < 2 for r in evidence.runs)
    rows = [list[Array]() for _ in evidence.runs]
    grams, base, places = [], [], []
    for j in range(space.dof):
        plain = plain_columns(space, j)
        own = vectors[space.indices[j]][:, used]
        here = np.flatnonzero(np.abs(own).sum(axis=0) > 0)
        place = np.full(vectors.shape[1], -1)
        place[np.array(used)[here]] = len(plain) + np.arange(len(here))
        for r, run in enumerate(evidence.runs):
            all_of = run.columns[j][moving[r][:, j]]
            rows[r].append(np.hstack([all_of[:, plain], all_of @ own[:, here]]))
        grams.append(np.array([x[j].T @ x[j] for x in rows]))
        base.append(len(plain))
        places.append(place)
    return Namer(tuple(grams), tuple(map(tuple, rows)), moving, tuple(base), tuple(places), each)


def _left_out(gram: Array, right: Array, squares: Array, columns: NDArray[np.int64]) -> Array:
    """Return each run's squared error (R,) under the least squares of all others."""
    g, b = gram[:, columns[:, None], columns], right[:, columns]
    rest = g.sum(axis=0) - g
    size = np.sqrt(np.einsum("rii->ri", g.sum(axis=0)[None])) + 1e-12
    scaled = rest / (size[:, :, None] * size[:, None, :]) + RIDGE * np.eye(len(columns))
    x = np.linalg.solve(scaled, ((b.sum(axis=0) - b) / size)[:, :, None])[:, :, 0] / size
    return np.asarray(squares - 2 * np.einsum("ri,ri->r", x, b) + np.einsum("ri,rij,rj->r", x, g, x))
