"""Where a joint's unexplained torque sits: along which variable, in which range, in what part of the time."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .result import Region
from .rows import Rows

Array = NDArray[np.float64]

#: Variables and their units; "t" is the time within the recordings, one after the other.
UNITS = {
    "q": "rad", "qd": "rad/s", "load": "Nm", "temperature": "deg C", "since": "s", "motor": "rad", "t": "s",
}  # fmt: skip
#: What does not vary by this much (in UNITS) locates nothing.
STILL = {"q": 0.02, "qd": 0.01, "load": 0.2, "temperature": 1.0, "since": 0.1, "motor": 0.5, "t": 5.0}
_BINS = 16


def regions(
    runs: Sequence[Rows], names: Sequence[str], left: Sequence[Array], gear: float, least: float = 0.03
) -> list[Region]:
    """Locate residuals (n, N) of some runs, most telling first, at most one region a joint.

    The share is left-out: blocks of the time are predicted by means over bins of the others.
    """
    found = []
    which = np.concatenate([np.full(len(r), k) for k, r in enumerate(runs)])
    for j in range(left[0].shape[1]):
        values = _variables(runs, j, gear)
        error = np.concatenate([e[:, j] for e in left])
        moving = np.concatenate([r.moving[:, j] > 0.5 for r in runs])
        if moving.sum() < 100:
            continue
        shares = {
            name: _explained(x[moving], error[moving])
            for name, x in values.items()
            if float(np.ptp(x[moving])) > STILL[name]
        }
        name = max(shares, key=lambda k: shares[k])
        if shares[name] < least:
            continue
        low, high, inside = _range(values[name], error, moving)
        k = int(np.bincount(which[inside], minlength=len(runs)).argmax())
        spans = _spans(runs[k], inside[which == k])
        found.append(Region(j + 1, name, shares[name], low, high, UNITS[name], names[k], spans))
    return sorted(found, key=lambda r: -r.share)


def _variables(runs: Sequence[Rows], j: int, gear: float) -> dict[str, Array]:
    own = ("q", "qd", "load", "temperature", "since")
    joined = {k: np.concatenate([getattr(r, k)[:, j] for r in runs]) for k in own}
    ends = np.cumsum([0.0] + [float(r.time[-1] - r.time[0]) for r in runs[:-1]])
    time = np.concatenate([r.time - r.time[0] + e for r, e in zip(runs, ends, strict=True)])
    return joined | {"motor": np.mod(gear * joined["q"], 2 * np.pi), "t": time}


def _bins(x: Array) -> NDArray[np.int64]:
    edges = np.unique(np.quantile(x, np.linspace(0, 1, _BINS + 1)[1:-1]))
    return np.asarray(np.searchsorted(edges, x), np.int64)


def _explained(x: Array, error: Array) -> float:
    """Left-out share of the squared error that means over bins of x explain."""
    which = _bins(x)
    half = (np.arange(len(x)) * 8 * _BINS // len(x)) % 2  # each bin of time has both halves
    error = error - error.mean()
    rest = np.empty(len(x))
    for side in (0, 1):
        other = half != side
        count = np.bincount(which[other], minlength=_BINS)
        mean = np.bincount(which[other], error[other], minlength=_BINS) / np.maximum(count, 1)
        rest[half == side] = error[half == side] - mean[which[half == side]]
    return float(1 - np.sum(rest**2) / max(float(np.sum(error**2)), 1e-300))


def _range(x: Array, error: Array, moving: NDArray[np.bool_]) -> tuple[float, float, NDArray[np.bool_]]:
    """Return the run of bins around the largest mean error, ends of its range and the rows in it."""
    which = np.full(len(x), -1)
    which[moving] = _bins(x[moving])
    mean = np.array([np.mean(error[which == b]) if (which == b).any() else 0.0 for b in range(_BINS)])
    level = 0.5 * float(np.abs(mean).max())
    first = last = int(np.abs(mean).argmax())
    while first > 0 and abs(mean[first - 1]) > level:
        first -= 1
    while last < _BINS - 1 and abs(mean[last + 1]) > level:
        last += 1
    inside = (which >= first) & (which <= last)
    return float(x[inside].min()), float(x[inside].max()), inside


def _spans(rows: Rows, inside: NDArray[np.bool_], most: int = 12) -> tuple[tuple[float, float], ...]:
    """Longest stretches of time (s) in which rows lie inside."""
    edges = np.flatnonzero(np.diff(inside.astype(np.int8), prepend=0, append=0)).tolist()
    pairs = zip(edges[::2], edges[1::2], strict=True)
    spans = [(float(rows.time[a]), float(rows.time[b - 1])) for a, b in pairs]
    return tuple(sorted(sorted(spans, key=lambda s: s[0] - s[1])[:most]))
