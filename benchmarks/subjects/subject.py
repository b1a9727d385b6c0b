"""The one shape of everything that is timed: it computes p = M qd and beta = C^T qd - g."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Unavailable(Exception):
    """A peer that is not installed here, or whose code does not compile; the message is one line."""


class States(NamedTuple):
    """Random states, one a row: positions (rad) and speeds (rad/s)."""

    q: Array  # (K, N)
    qd: Array  # (K, N)

    @classmethod
    def random(cls, count: int, dof: int, seed: int = 1) -> "States":
        """Return distinct states: positions within half a turn, speeds up to 2 rad/s."""
        rng = np.random.default_rng(seed)
        return cls(rng.uniform(-np.pi, np.pi, (count, dof)), rng.uniform(-2, 2, (count, dof)))

    @classmethod
    def motion(cls, count: int, dof: int) -> "States":
        """Return what a recording holds: every joint swings by 1.5 rad at 0.1 to 0.35 Hz, at 500 Hz."""
        rate = 2 * np.pi * (0.1 + 0.05 * np.arange(dof))
        phase = rate * 0.002 * np.arange(count)[:, None]
        return cls(1.5 * np.sin(phase), 1.5 * rate * np.cos(phase))


@dataclass(frozen=True)
class Subject:
    """One implementation.

    evaluate: states -> (p, beta), each (K, N). time: states -> ns of processor time per state.
    kind: "native" code runs state by state; "numpy", "motion" (NumPy along a motion) and "python" are
    called from Python.
    operations: of the generated code, where it is straight-line code. whole: False for a part of the work,
    timed to compare with but not checked.
    """

    name: str
    kind: str
    evaluate: Callable[[States], tuple[Array, Array]]
    time: Callable[[States], float]
    operations: int | None = None
    whole: bool = True


def worst_difference(found: tuple[Array, Array], expected: tuple[Array, Array]) -> float:
    """Return the largest difference, relative to each joint's largest value (1 where that is zero)."""
    worst = 0.0
    for a, b in zip(found, expected, strict=True):
        scale = np.abs(b).max(axis=0)
        scale[scale < 1e-12] = 1.0
        worst = max(worst, float((np.abs(a - b) / scale).max()))
    return worst
