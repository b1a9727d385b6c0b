"""What comes and goes: stretches of time in which a joint's residual leaves its noise, and what they can be.

A push by a person or a thing is bounded in time and reaches several joints at once through the arm's
geometry; a brake that drags or a loose plug stays on one.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .grams import Scales, regime
from .physics import Physics, fitted_force, forces
from .rows import Rows
from .segments import stretches

Array = NDArray[np.float64]

#: Noise levels that the mean over the window leaves before an episode begins; s of the window.
LEVEL, WINDOW = 6.0, 0.25
#: s; shorter pauses belong to the episode, shorter episodes are none.
PAUSE, SHORTEST = 0.6, 0.15
#: Share of the time that episodes may take: what is always there does not come and go.
MOST = 0.3
#: Share of the joints' squared residuals that one force must explain; N.
FORCE, STRONGEST, WEAKEST = 0.8, 500.0, 1.0
#: Mean squared residual over noise of a joint that a force reaches.
LOUD = 10.0
#: Share of what comes and goes that pushes make, and those of them that reach two joints loudly.
NEARLY, HALF = 0.8, 0.5


@dataclass(frozen=True)
class Episode:
    """Rows of a run in which residuals leave their noise. strength (N,): mean squared residual over noise."""

    run: int
    rows: slice
    span: tuple[float, float]
    strength: Array
    mean: Array  # (N,) mean residual, Nm
    rms: Array  # (N,)

    @property
    def worth(self) -> float:
        """Squared residuals over the noise, summed."""
        return float(self.strength.sum() * (self.rows.stop - self.rows.start))


def episodes(
    runs: Sequence[Rows], which: Sequence[int], residuals: Sequence[Array], scales: Scales, coulomb: Array
) -> list[Episode]:
    """Find episodes in residuals (n, N) of some runs; none when they take too much of the time.

    coulomb (N,): Nm; a joint at rest holds that much without anything being there.
    """
    sigma = scales.sigma.copy()
    sigma[:, 2] = np.maximum(sigma[:, 2], coulomb)
    found, time, taken = list[Episode](), 0, 0
    for run, left in zip(which, residuals, strict=True):
        rows = runs[run]
        kinds = regime(rows)
        scaled = left / np.take_along_axis(sigma[None], kinds[:, :, None], axis=2)[:, :, 0]
        width = max(1, round(WINDOW / rows.step))
        kernel = np.ones(width) / width
        spread = np.sqrt(np.minimum(scales.inflation, width) / width)
        loud = np.zeros(len(rows), bool)
        for j in range(left.shape[1]):
            mean = np.convolve(np.clip(scaled[:, j], -50, 50) * (kinds[:, j] != 1), kernel, "same")
            loud |= np.abs(mean) > LEVEL * spread[j] + 0.3
        for part in _joined(loud, rows.step):
            found.append(_episode(run, part, rows, left, scaled))
            taken += part.stop - part.start
        time += len(rows)
    return found if taken <= MOST * max(time, 1) else []


def _joined(loud: NDArray[np.bool_], step: float) -> list[slice]:
    parts = list[slice]()
    for part in stretches(loud):
        if parts and (part.start - parts[-1].stop) * step < PAUSE:
            parts[-1] = slice(parts[-1].start, part.stop)
        else:
            parts.append(part)
    return [p for p in parts if (p.stop - p.start) * step >= SHORTEST]


def _episode(run: int, part: slice, rows: Rows, left: Array, scaled: Array) -> Episode:
    return Episode(
        run, part, (float(rows.time[part.start]), float(rows.time[part.stop - 1])),
        np.mean(scaled[part] ** 2, axis=0), left[part].mean(axis=0),
        np.sqrt(np.mean(left[part] ** 2, axis=0)),
    )  # fmt: skip


def involved(found: Sequence[Episode], part: float = 0.08) -> list[int]:
    """Return the joints (0-based) that hold at least a share of the episodes' strength."""
    total = np.sum([e.strength - 1 for e in found], axis=0)
    total = np.maximum(total, 0)
    return [int(j) for j in np.flatnonzero(total > part * max(total.sum(), 1e-12))]


@dataclass(frozen=True)
class Contact:
    """Episodes that a force explains on all joints, and the strongest one's force, N."""

    pushes: tuple[Episode, ...]
    force: float


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
        share, force = max(
            _force(physics, runs[e.run].q[e.rows], left[e.run][e.rows], sigma, frame)
            for frame in range(3, physics.dof + 1)
        )
        if share > FORCE and WEAKEST < force < STRONGEST:
            pushes.append(e)
            most = max(most, force)
            strong += e.worth if np.sum(e.strength > LOUD) >= 2 else 0.0
    total = sum(e.worth for e in found)
    nearly = sum(e.worth for e in pushes) > NEARLY * total and strong > HALF * total
    return Contact(tuple(pushes), most) if nearly else None


def _force(physics: Physics, q: Array, left: Array, sigma: Array, frame: int) -> tuple[float, float]:
    """Return the share of residuals (n, N) that a force at a frame's origin explains, and its size, N."""
    columns = forces(physics, q, frame) / sigma[:, None]  # (n, N, 3)
    target = left / sigma
    force = fitted_force(columns, target)
    rest = float(np.sum((target - np.einsum("tji,ti->tj", columns, force)) ** 2))
    share = 1 - rest / max(float(np.sum(target**2)), 1e-12)
    return share, float(np.median(np.linalg.norm(force, axis=1)))
