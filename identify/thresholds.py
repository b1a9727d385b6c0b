"""Detection thresholds: extreme values of the residual where nothing was touched.

Peaks over a high level follow a generalised Pareto law (Pickands 1975; Coles 2001, ch. 4). The residual
remembers, so peaks closer than its memory are one event. The law gives the level that is passed at a
stated rate per hour, also beyond what was observed; how far beyond is said.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..robots.model import Thresholds

Array = NDArray[np.float64]

#: Samples above this quantile make events.
_LEVEL = 0.95
#: Share of the events that the law is fitted to, and at least so many: the law holds in the far tail, and
#: a shape that also fits the bulk ends the tail too soon (false alarms came 3.4 times as often as asked).
_TAIL, _FEWEST = 0.1, 25
#: Peaks closer than this are one event, s: the memory of UR residuals is 0.6-1 s.
APART = 1.0
#: Shapes outside are not believed: from a few dozen peaks a short tail is mostly luck, and trusting it costs
#: false alarms; above, the drive bounds a torque residual.
_SHAPES = (-0.1, 0.3)
_BOOTSTRAP = 200


@dataclass(frozen=True)
class Residual:
    """One collision-free stretch: time (T,) s, |residual| (T, N) Nm, |speed| (T, N) rad/s."""

    time: Array
    size: Array
    speed: Array


@dataclass(frozen=True)
class Level:
    """A level with its standard deviation; events: independent peaks that it is from; shape of the tail."""

    value: float
    std: float
    events: int
    shape: float


def fit_thresholds(
    residuals: Sequence[Residual], per_hour: float, inflate: Array, held_out: str
) -> Thresholds:
    """Return thresholds (N joints) that are passed `per_hour` times an hour by each joint.

    inflate (N,): how many times larger errors are on runs that were not fitted; held_out says from what.
    """
    n = residuals[0].size.shape[1]
    hours = sum(float(r.time[-1] - r.time[0]) for r in residuals) / 3600
    static, slopes, constant, static_std, constant_std = [], [], [], [], []
    events = []
    for i in range(n):
        growth = _growth(residuals, i)
        level = _return_level(
            [(r.time, r.size[:, i] / (1 + growth * r.speed[:, i])) for r in residuals], hours, per_hour
        )
        plain = _return_level([(r.time, r.size[:, i]) for r in residuals], hours, per_hour)
        static.append(inflate[i] * level.value)
        slopes.append(inflate[i] * level.value * growth)
        static_std.append(inflate[i] * level.std)
        constant.append(inflate[i] * plain.value)
        constant_std.append(inflate[i] * plain.std)
        events.append(level.events)
    factor = 1 / (per_hour * hours)
    source = (
        f"generalised Pareto law of {min(events)} to {max(events)} independent peaks a joint in"
        f" {60 * hours:.3g} min without contact, times {held_out}"
    )
    if factor > 1:
        source += f"; extrapolated {factor:.2g} times beyond the recordings:"
        source += f" record {1 / per_hour:.3g} h or more to see this rate"
    return Thresholds(
        static=_rounded(static), per_speed=_rounded(slopes), false_alarms_per_hour=per_hour,
        static_only=_rounded(constant), std=_rounded(static_std), static_only_std=_rounded(constant_std),
        hours=float(f"{hours:.6g}"), source=source,
    )  # fmt: skip


def _rounded(values: Sequence[float]) -> tuple[float, ...]:
    return tuple(float(f"{v:.6g}") for v in values)


def _growth(residuals: Sequence[Residual], joint: int) -> float:
    """Relative growth of the residual's size with speed, s/rad: |r| ~ a (1 + growth |qd|), not negative.

    Straight line through the 90 % quantile of |r| in eight groups of equal number along |qd|.
    """
    speed = np.concatenate([r.speed[:, joint] for r in residuals])
    size = np.concatenate([r.size[:, joint] for r in residuals])
    edges = np.unique(np.quantile(speed, np.linspace(0, 1, 9)))
    if len(edges) < 4:
        return 0.0
    group = np.clip(np.searchsorted(edges, speed, "right") - 1, 0, len(edges) - 2)
    points = [
        (speed[group == k].mean(), np.quantile(size[group == k], 0.9))
        for k in range(len(edges) - 1)
        if np.any(group == k)
    ]
    at, quantile = np.array(points).T
    slope, at_rest = np.polyfit(at, quantile, 1)
    return float(max(0.0, slope) / max(at_rest, 0.1 * np.quantile(size, 0.9), 1e-12))


def _return_level(series: Sequence[tuple[Array, Array]], hours: float, per_hour: float) -> Level:
    """Return the level that independent peaks pass `per_hour` times an hour."""
    level = float(np.quantile(np.concatenate([x for _, x in series]), _LEVEL))
    peaks = np.sort(np.concatenate([_peaks(t, x, level) for t, x in series]))
    if not len(peaks):
        return Level(level, 0.0, 0, 0.0)
    value, shape = _level_of(peaks, level, hours, per_hour)
    random = np.random.default_rng(0)
    again = []
    for _ in range(_BOOTSTRAP):
        drawn = np.sort(random.choice(peaks, max(1, random.poisson(len(peaks)))))
        again.append(_level_of(drawn, level, hours, per_hour)[0])
    return Level(value, float(np.std(again)), len(peaks), shape)


def _peaks(time: Array, size: Array, level: float) -> Array:
    """Return the largest of each group of exceedances that lie closer than APART (runs declustering)."""
    above = np.flatnonzero(size > level)
    if not len(above):
        return np.empty(0)
    groups = np.split(above, np.flatnonzero(np.diff(time[above]) > APART) + 1)
    return np.array([size[g].max() for g in groups])


def _level_of(peaks: Array, level: float, hours: float, per_hour: float) -> tuple[float, float]:
    """Return the level passed at the rate, and the tail's shape; peaks: sorted, all above `level`."""
    count = min(len(peaks), max(_FEWEST, round(_TAIL * len(peaks))))
    below = level if count == len(peaks) else float(peaks[-count - 1])
    share = per_hour * hours / count
    if share >= 1:
        return float(peaks[max(0, len(peaks) - round(per_hour * hours))]), 0.0
    shape, scale = _pareto(peaks[-count:] - below)
    return below + _exceeded(share, shape, scale), shape


def _exceeded(share: float, shape: float, scale: float) -> float:
    """Return the excess that a share of the peaks passes: the law's upper quantile (Coles 2001, eq. 4.3)."""
    if abs(shape) < 1e-9:
        return float(-scale * np.log(share))
    return float(scale / shape * (share**-shape - 1))


def _pareto(excess: Array) -> tuple[float, float]:
    """Shape and scale by probability-weighted moments (Hosking and Wallis 1987): closed, sound on few."""
    mean = float(excess.mean())
    if len(excess) < _FEWEST or mean <= 0:
        return 0.0, max(mean, 1e-12)
    rank = (np.arange(1, len(excess) + 1) - 0.35) / len(excess)
    second = float(np.mean((1 - rank) * excess))
    shape = float(np.clip(2 - mean / (mean - 2 * second), *_SHAPES))
    return shape, mean * (1 - shape)
