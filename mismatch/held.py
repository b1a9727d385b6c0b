"""A load, the rows in which it is held, and the arm, fitted at once."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_solve

from .evidence import Evidence, residual
from .grams import roots
from .pool import each
from .rows import Rows
from .segments import Mask, stretches
from .selection import Directions, Eliminated, fit

Array = NDArray[np.float64]

#: Prior width of what a gripper holds: mass (kg), first moments (kg m), inertias (kg m^2) at the last frame.
WIDTHS = np.array([5.0, 0.5, 0.5, 0.5, 0.05, 0.05, 0.05, 0.05, 0.05, 0.05])
TEN = range(len(WIDTHS))


@dataclass(frozen=True)
class LoadedRun:
    """Rows of an observed run; columns (n, N, 10) of a load that is always there."""

    rows: Rows
    columns: Array


@dataclass(frozen=True)
class Held:
    """States held[i] (n,) of observed run i, and the arm and the load that were fitted to them."""

    evidence: Evidence
    runs: tuple[LoadedRun, ...]
    held: tuple[Mask, ...]
    fit: Eliminated

    @cached_property
    def value(self) -> Array:
        """The load's parameters (10,)."""
        return self.fit.solve(TEN)[0]

    @cached_property
    def left(self) -> list[Array]:
        """What the arm alone leaves of each run (n, N), Nm: the load where it is held."""
        theta = self.evidence.mean + self.fit.parameters(TEN)
        return [residual(x.rows, self.evidence.setup.space, theta) for x in self.runs]

    @cached_property
    def load(self) -> list[Array]:
        """What the load takes where it is held (n, N), Nm, zero elsewhere."""
        return [x.columns @ self.value * h[:, None] for x, h in zip(self.runs, self.held, strict=True)]

    @cached_property
    def events(self) -> list[tuple[LoadedRun, slice, Array]]:
        """Stretches, or pauses if those are more: run, rows, and torque (n, N) that tells the load's size."""
        away = self.share > 0.5
        return [
            (x, part, (x.columns @ self.value - e if away else e)[part])
            for x, e, h in zip(self.runs, self.left, self.held, strict=True)
            for part in stretches(h != away)
        ]

    @property
    def share(self) -> float:
        """Share of the time in which it is held."""
        return float(np.mean(np.concatenate(self.held)))


def fitted(
    evidence: Evidence, arm: Directions, runs: Sequence[LoadedRun], held: Sequence[Mask]
) -> Eliminated:
    """Fit the arm and the load, held in some rows, at once: the arm is eliminated from the load."""
    space, sums = evidence.setup.space, evidence.sums
    alone = fit(sums, arm, sums.total)
    sizes = (space.size, len(TEN)), (len(TEN), len(TEN)), (len(TEN),)

    def of_run(run: tuple[LoadedRun, Mask]) -> tuple[Array, Array, Array]:
        x, h = run
        target, (cross, own, right) = residual(x.rows, space, evidence.mean), map(np.zeros, sizes)
        for j, whiten in enumerate(roots(x.rows, evidence.noise)):
            load = whiten @ (x.columns[:, j] * h[:, None])
            cross[space.indices[j]] += x.rows.columns[j].T @ (whiten.T @ load)
            own += load.T @ load
            right += load.T @ (whiten @ target[:, j])
        return cross, own, right

    cross, own, right = map(sum, zip(*each(of_run, zip(runs, held, strict=True)), strict=True))
    b = arm.vectors.T @ cross
    solved = cho_solve(alone.factor, np.column_stack([b, alone.right]))
    answer = arm.vectors @ solved
    return Eliminated(
        own - b.T @ solved[:, :-1], right - b.T @ solved[:, -1], WIDTHS, -answer[:, :-1], answer[:, -1]
    )
