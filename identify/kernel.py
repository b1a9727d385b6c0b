"""A low-pass filter as a function of continuous time, and its action on samples at any times.

A Butterworth impulse response is a sum of damped exponentials, so it and its slopes are known at every
instant: the filter acts on the samples where they are, and nothing has to be resampled to a grid. A
derivative is moved from the signal to the kernel (integration by parts; Shinbrot 1957, modulating
functions), so that momentum is differentiated without ever differentiating a noisy sample.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from math import factorial

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Instants filtered at a time: their kernels overlap, so a small dense matrix serves them all.
_TOGETHER = 40
#: Points of the kernel's table on one side; linear interpolation errs by less than 1e-5 of its peak.
_TABLE = 4096


@dataclass(frozen=True)
class Kernel:
    """A Butterworth low-pass of some order and cutoff (Hz).

    zero_phase: the filter run forth and back, gain 1/(1 + (f/cutoff)^(2 order)), no delay; else once,
    causal. It is cut off where its envelope has fallen below `tail`.
    """

    cutoff: float
    order: int = 4
    zero_phase: bool = True
    tail: float = 2e-3

    @property
    def support(self) -> float:
        """Seconds to which the kernel reaches (to both sides when zero-phase)."""
        return float(np.log(1 / self.tail) / -self._poles().real.max())

    @property
    def ahead(self) -> float:
        """Seconds of future that it needs."""
        return self.support if self.zero_phase else 0.0

    def moment(self, slope: int, power: int) -> float:
        """Return the integral of kernel^(slope) * (age/support)^power over all ages, for power <= slope.

        Integrating by parts, only power = slope is not zero: (-1)^slope slope! / support^slope.
        """
        return float((-1) ** slope * factorial(slope) / self.support**slope) if power == slope else 0.0

    def _poles(self) -> NDArray[np.complex128]:
        """Poles in the upper half plane, rad/s (for an odd order the real one is among them)."""
        k = np.arange((self.order + 1) // 2)
        angle = np.pi * (2 * k + self.order + 1) / (2 * self.order)
        return np.asarray(2 * np.pi * self.cutoff * np.exp(1j * angle), dtype=np.complex128)

    @lru_cache(maxsize=16)  # noqa: B019 frozen, and few of them
    def table(self, slope: int = 0) -> tuple[Array, Array]:
        """Return ages t >= 0 (s) and the kernel, or its first or second derivative, there."""
        w, n = 2 * np.pi * self.cutoff, self.order
        every = w * np.exp(1j * np.pi * (2 * np.arange(n) + n + 1) / (2 * n))
        age = np.linspace(0.0, self.support, _TABLE)
        value = np.zeros_like(age)
        for s in self._poles():
            others = np.delete(every, np.argmin(np.abs(every - s)))
            residue = w**n / np.prod(s - others)
            if self.zero_phase:
                residue *= w**n / np.prod(-s - every)
            twice = 1.0 if abs(s.imag) < 1e-9 * w else 2.0
            value += twice * np.real(residue * s**slope * np.exp(s * age))
        return age, value


@dataclass(frozen=True)
class Filter:
    """A kernel ready to act on samples: `smooth` filters, `differentiate` filters the derivative."""

    kernel: Kernel

    def weights(self, time: Array, at: Array, slopes: tuple[int, ...] = (0, 1)) -> list[Array]:
        """Return a matrix (len(at), len(time)) a slope: filtered derivatives at `at` are matrix @ samples.

        Times (s) increase. The sum over the samples is a trapezoid rule, corrected so that a constant and
        a straight line (for the second slope also a parabola) are treated exactly, whatever the jitter.
        """
        age = at[:, None] - time[None, :]
        share = np.gradient(time) if len(time) > 1 else np.ones(1)
        window = (
            np.clip(1 - (age / self.kernel.support) ** 2, 0, None) ** 2 * (age >= -self.kernel.ahead) * share
        )
        return [
            _exact(self._sampled(age, k) * share, window, age / self.kernel.support, k, self.kernel)
            for k in slopes
        ]

    def _sampled(self, age: Array, slope: int) -> Array:
        grid, value = self.kernel.table(slope)
        if not self.kernel.zero_phase:
            return np.interp(age, grid, value, left=0.0, right=0.0)
        sampled = np.interp(np.abs(age), grid, value, right=0.0)
        return np.sign(age) * sampled if slope == 1 else sampled


def _exact(rough: Array, window: Array, age: Array, slope: int, kernel: Kernel) -> Array:
    """Correct a matrix so that polynomials up to the order of its derivative come out right.

    Right is what the continuous kernel makes of them: a causal one delays. The correction is a smooth
    window times 1, age, age^2 (age in supports), and as small as the sum is wrong.
    """
    orders = range(slope + 1)
    wanted = [kernel.moment(slope, m) for m in orders]
    moments = np.stack([[(window * age ** (m + k)).sum(axis=1) for k in orders] for m in orders])  # (m, k, n)
    lack = np.stack([w - (rough * age**m).sum(axis=1) for m, w in enumerate(wanted)])  # (m, n)
    factor = np.linalg.solve(moments.transpose(2, 0, 1), lack.T[:, :, None])[:, :, 0]  # (n, k)
    for k in orders:
        rough = rough + factor[:, k : k + 1] * window * age**k
    return rough


def segments(time: Array, longest_step: float) -> list[slice]:
    """Cut times (s, increasing) wherever a step is longer than `longest_step`: nothing is carried across."""
    cuts = np.flatnonzero(np.diff(time) > longest_step) + 1
    edges = [0, *cuts.tolist(), len(time)]
    return [slice(a, b) for a, b in pairwise(edges) if b > a]


def portions(
    time: Array, stretch: slice, kernel: Kernel, step: float, size: int, times: int = 1
) -> Iterator[tuple[Array, slice]]:
    """Give instants `step` s apart in a stretch with the samples that they need, `size` instants at a time.

    times: how often the kernel acts one after the other.
    """
    behind, ahead = times * kernel.support, times * kernel.ahead
    first, last = time[stretch][0] + behind, time[stretch][-1] - ahead
    at = np.arange(first, last + 1e-9, step)
    for start in range(0, len(at), size):
        some = at[start : start + size]
        left = max(stretch.start, int(np.searchsorted(time, some[0] - behind, "left")) - 1)
        right = min(stretch.stop, int(np.searchsorted(time, some[-1] + ahead, "right")) + 1)
        if right - left > 2:
            yield some, slice(left, right)


def batches(time: Array, at: Array, kernel: Kernel) -> Iterator[tuple[slice, slice]]:
    """Pair a few instants of `at` with the samples that their kernels reach."""
    for start in range(0, len(at), _TOGETHER):
        some = at[start : start + _TOGETHER]
        first = np.searchsorted(time, some[0] - kernel.support, "left")
        last = np.searchsorted(time, some[-1] + kernel.ahead, "right")
        yield slice(start, start + len(some)), slice(int(first), int(last))
