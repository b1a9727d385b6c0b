"""Attempt 10 of the facts: one model, rich in every term, fitted to reference and observed runs together.

One effect at a time may differ on the observed runs. It is scored on left-out blocks of 10 s and named when
its gain is large, repeated over blocks and steady. Without a reference the published rigid body with Coulomb
and viscous friction takes the rich model's place.
"""

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from .columns import ROWS, load

BLOCK = 10.0  # s
RIDGE = 1e-5
GAIN, REPEATED, STEADY = 0.06, 0.7, 2.5  # share of the error, share of blocks, mean over standard error
MOST = 3


class Joint:
    """Gram matrices by block of one joint, of [common | candidates on observed rows | torque]."""

    def __init__(self, seen, before, j):
        grams, self.blocks = [], 0
        for k, track in enumerate((*seen, *before)):
            observed = k < len(seen)
            y = track.torque[:, j] - (0.0 if before else track.nominal[:, j])
            common = self.common(track, j, bool(before))
            self.width = common.shape[1]
            x = np.column_stack([common, track.candidates[j] * observed, y]) * track.moving[:, j][:, None]
            count = max(round(len(x) / (BLOCK * ROWS)), 1)
            grams += [part.T @ part for part in np.array_split(x, count)]
            self.blocks += count * observed
        size = np.sqrt(np.diag(sum(grams)))
        size[size == 0.0] = 1.0
        self.grams = [g / np.outer(size, size) for g in grams]
        self.total = sum(self.grams)

    @staticmethod
    def common(track, j, rich):
        if not rich:
            return track.friction[j][:, :2]
        return np.hstack([track.base[j], track.friction[j], track.candidates[j]])

    def errors(self, free, options):
        """Squares of every observed block when it is left out: (blocks,) as it is, and with each option free.

        free, options: places among the candidates; the torque's own squares are 1 in sum.
        """
        use = [*range(self.width), *(self.width + c for c in free)]
        last, now = len(self.total) - 1, np.empty(self.blocks)
        found = np.empty((len(options), self.blocks))
        for b in range(self.blocks):
            g, rest = self.grams[b], self.total - self.grams[b]
            factor = cho_factor(rest[np.ix_(use, use)] + RIDGE * np.eye(len(use)))
            solved = cho_solve(factor, rest[use])
            now[b] = squares(g, use, solved[:, last], last)
            for k, places in enumerate(options):
                own = [self.width + c for c in places]
                schur = rest[np.ix_(own, own)] - rest[use][:, own].T @ solved[:, own]
                right = rest[own, last] - solved[:, own].T @ rest[use, last]
                theta = np.linalg.solve(schur + RIDGE * np.eye(len(own)), right)
                whole = np.concatenate([solved[:, last] - solved[:, own] @ theta, theta])
                found[k, b] = squares(g, [*use, *own], whole, last)
        return now, found


def squares(g, use, theta, last):
    return g[last, last] - 2.0 * theta @ g[use, last] + theta @ g[np.ix_(use, use)] @ theta


def named(files):
    """Return the groups that pass, in the order in which they were taken."""
    seen = [load(path, files.robot) for path in files.recordings]
    before = [load(path, files.robot)[0] for path in files.reference]
    groups, tracks = seen[0][1], [t for t, _ in seen]
    joints = [Joint(tracks, before, j) for j in range(6)]
    free: list[list[int]] = [[] for _ in range(6)]
    found = []
    while len(found) < MOST:
        saved = savings([g for g in groups if g not in found], joints, free)
        best = max(saved, key=lambda g: saved[g].sum())
        if not passes(saved[best]):
            break
        found.append(best)
        for j, places in enumerate(best.places):
            free[j] += places
    return found


def savings(groups, joints, free):
    """Share of the held-out squares that a group saves, by block, averaged over the joints that it moves."""
    parts = {g: [] for g in groups}
    for j, joint in enumerate(joints):
        own = [g for g in groups if g.places[j]]
        now, then = joint.errors(free[j], [g.places[j] for g in own])
        for g, squares_then in zip(own, then, strict=True):
            parts[g].append((now - squares_then) / now.sum())
    return {g: np.mean(p, axis=0) for g, p in parts.items() if p}


def passes(saved):
    error = saved.std(ddof=1) / np.sqrt(len(saved))
    return saved.sum() > GAIN and (saved > 0.0).mean() > REPEATED and saved.mean() > STEADY * error
