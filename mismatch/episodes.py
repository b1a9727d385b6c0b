"""What comes and goes: stretches of time in which a joint's residual leaves its noise."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .grams import Scales, regime
from .rows import Rows
from .segments import stretches
from .whitening import FREE, REST, ZERO

Array = NDArray[np.float64]

#: Noise levels that the mean over the window leaves before an episode begins; s of the window.
LEVEL, WINDOW = 6.0, 0.25
#: s; shorter pauses belong to the episode, shorter episodes are none.
PAUSE, SHORTEST = 0.6, 0.15
#: A joint at rest holds up to so much of its Coulomb level: breaking away takes more than moving on, and the
#: level of a straight line may be 60 % of that at low speed where friction bends.
HELD = 2.5
#: Of all that comes and goes: pushes, and those of them that reach more than one joint.
NEARLY, HALF = 0.8, 0.5
#: Share of the time that episodes may take: what is always there does not come and go.
MOST = 0.3


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

    coulomb (N,): Nm; a joint at rest holds about that much without anything being there.
    """
    found, time, taken = list[Episode](), 0, 0
    for run, left in zip(which, residuals, strict=True):
        rows = runs[run]
        over = scaled(rows, left, scales, coulomb)
        for part in _joined(_loudness(rows, over, scales) > 1, rows.step):
            found.append(episode(run, part, rows, left, over))
            taken += part.stop - part.start
        time += len(rows)
    return found if taken <= MOST * max(time, 1) else []


def loudness(rows: Rows, left: Array, scales: Scales, coulomb: Array) -> Array:
    """Return how far (n,) the mean of residuals (n, N) over the window leaves the noise: 1 is its end."""
    return _loudness(rows, scaled(rows, left, scales, coulomb), scales)


def _loudness(rows: Rows, over: Array, scales: Scales) -> Array:
    kinds = regime(rows)
    width = max(1, round(WINDOW / rows.step))
    kernel = np.ones(width) / width
    spread = np.sqrt(np.minimum(scales.inflation, width) / width)
    loud = np.zeros(len(rows))
    for j in range(over.shape[1]):
        mean = np.convolve(np.clip(over[:, j], -50, 50) * (kinds[:, j] != ZERO), kernel, "same")
        loud = np.maximum(loud, np.abs(mean) / (LEVEL * spread[j] + 0.3))
    return loud


def scaled(rows: Rows, left: Array, scales: Scales, coulomb: Array) -> Array:
    """Return residuals (n, N) in units of their noise, at rest what is beyond that which friction holds.

    What friction holds is bounded, and no noise: what is beyond has that of free motion.
    """
    kinds = regime(rows)
    beyond = np.sign(left) * np.maximum(np.abs(left) - HELD * coulomb, 0.0)
    noise = np.where(kinds == ZERO, scales.sigma[:, ZERO], scales.sigma[:, FREE])
    return np.where(kinds == REST, beyond, left) / noise


def uncertainty(rows: Rows, scales: Scales, coulomb: Array) -> Array:
    """Return what a residual (n, N) is known to, Nm: the noise, at rest about what friction may hold."""
    known = np.maximum(scales.sigma[:, FREE], coulomb)
    return np.where(regime(rows) == REST, known, scales.sigma[:, FREE])


def _joined(loud: NDArray[np.bool_], step: float) -> list[slice]:
    parts = list[slice]()
    for part in stretches(loud):
        if parts and (part.start - parts[-1].stop) * step < PAUSE:
            parts[-1] = slice(parts[-1].start, part.stop)
        else:
            parts.append(part)
    return [p for p in parts if (p.stop - p.start) * step >= SHORTEST]


def episode(run: int, part: slice, rows: Rows, left: Array, over: Array) -> Episode:
    """Return what residuals (n, N) are in some rows of a run; over (n, N): `scaled`."""
    return Episode(
        run, part, (float(rows.time[part.start]), float(rows.time[part.stop - 1])),
        np.mean(over[part] ** 2, axis=0), left[part].mean(axis=0), np.sqrt(np.mean(left[part] ** 2, axis=0)),
    )  # fmt: skip


def mostly_pushes(total: float, pushes: float, wide: float) -> bool:
    """Return whether what comes and goes is a contact: its worth, that of pushes, that of wide pushes."""
    return pushes > NEARLY * total and wide > HALF * total


def involved(found: Sequence[Episode], part: float = 0.08) -> list[int]:
    """Return the joints (0-based) that hold at least a share of the episodes' strength."""
    total = np.sum([e.strength - 1 for e in found], axis=0)
    total = np.maximum(total, 0)
    return [int(j) for j in np.flatnonzero(total > part * max(total.sum(), 1e-12))]
