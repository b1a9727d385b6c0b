"""Rows, spaces and folds made by hand, for what works on them without a robot."""

import numpy as np

from residuum.mismatch.columns import Column, Space
from residuum.mismatch.episodes import episodes
from residuum.mismatch.grams import Fold, Scales
from residuum.mismatch.rows import Rows

STEP = 1 / 60


def rows(count: int, joints: int = 2, fast=None, **given) -> Rows:
    """Rows in which every joint moves steadily, far from a reversal, unless something else is given."""
    rng = np.random.default_rng(1)
    plain = {
        "torque": np.zeros((count, joints)),
        "moving": np.ones((count, joints)),
        "sliding": np.ones((count, joints)),
        "q": rng.uniform(-2, 2, (count, joints)),
        "qd": rng.choice([-1.0, 1.0], (count, joints)) * rng.uniform(0.2, 1.0, (count, joints)),
        "load": rng.uniform(-20, 20, (count, joints)),
        "temperature": np.full((count, joints), 35.0),
        "since": np.full((count, joints), 2.0),
    } | given
    columns = tuple(np.zeros((count, 0)) for _ in range(joints))
    time = STEP * np.arange(count)
    return Rows(time, columns=columns, step=STEP, fast=fast, **plain)


def ar1(count: int, keep: float, rng, joints: int = 2):
    """Noise (count, joints) of unit variance whose correlation falls by `keep` a row; 0 is white."""
    drive, found = rng.normal(size=(count, joints)), np.empty((count, joints))
    found[0] = drive[0]
    for k in range(1, count):
        found[k] = keep * found[k - 1] + np.sqrt(1 - keep**2) * drive[k]
    return found


LONG, PUSH = 3600, slice(1200, 1500)


def scales(joints: int = 3) -> Scales:
    """Noise of 0.3 Nm in free motion, four rows to an independent one."""
    return Scales(np.tile([0.3, 0.6, 0.9], (joints, 1)), np.full(joints, 4.0), np.full(joints, np.inf))


def quiet(seed: int = 1, joints: int = 3):
    """LONG residuals of that noise."""
    return 0.3 * ar1(LONG, 0.6, np.random.default_rng(seed), joints)


def found_in(left, run):
    """The episodes in residuals of one run."""
    joints = left.shape[1]
    return episodes([run], [0], [left], scales(joints), np.zeros(joints))


def small_space() -> Space:
    """Two joints, three base parameters (the second joint does not see the first), two own columns, a common one."""
    own = (Column("coulomb", "Fc"), Column("viscous", "Fv"))
    return Space(2, ("A1", "B2", "C2"), own, ("roll",), ((0, 1, 2), (1, 2)))


def random_fold(space: Space, rng, observed: bool, count: int = 12):
    """A fold of random rows; also its rows as one matrix (2 count, P) and torque (2 count,)."""
    grams, matrix, torque = [], [], []
    for indices in space.indices:
        data = rng.normal(size=(count, len(indices) + 1))
        grams.append(data.T @ data)
        whole = np.zeros((count, space.size))
        whole[:, indices] = data[:, :-1]
        matrix.append(whole)
        torque.append(data[:, -1])
    fold = Fold(tuple(grams), observed, 0, (0.0, 1.0))
    return fold, np.vstack(matrix), np.concatenate(torque)
