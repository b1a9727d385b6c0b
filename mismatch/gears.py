"""Columns that remember, along a whole recording: terms with state, and gears that are slack or soft."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from .columns import SLACK, WINDUP
from .slack import within_gap
from .track import CALM, Setup, Track, between, remembers, sampled
from .windup import seen, wound

Array = NDArray[np.float64]


def held(track: Track, setup: Setup) -> Array:
    """Return the columns with memory (T, N, H), in the order of the space's own columns."""
    some = [c for c in setup.space.own if remembers(c.term)]
    if not some:
        return track.held
    moved = {
        SLACK: _slack(track, [c.value["gap"] for c in some if c.term == SLACK]),
        WINDUP: _wound(track, [c.value["stiffness"] for c in some if c.term == WINDUP]),
    }
    return np.stack(
        [
            next(moved[c.term])
            if c.term in moved
            else sampled(track, slice(None), c.term, c.parameter, c.values)
            for c in some
        ],
        axis=2,
    )


def _slack(track: Track, gaps: Sequence[float]) -> Iterator[Array]:
    """Give the torque (T, N) that each motor gives more when its gear has slack, gap rad to each side."""
    time, load = track.time, track.calm
    if not gaps:
        return
    inertia, sag = _of_links(track)
    for gap in gaps:
        found = np.empty_like(load)
        for j in range(load.shape[1]):
            place, rate = within_gap(time, load[:, j], inertia[:, j], gap)
            found[:, j] = np.gradient(inertia[:, j] * rate, time) - sag[:, j] * place
        yield found


def _wound(track: Track, stiffnesses: Sequence[float]) -> Iterator[Array]:
    """Give the torque (T, N) that each motor gives more when its gear winds up, stiffness in Nm/rad."""
    if not stiffnesses:
        return
    inertia, sag = _of_links(track)
    smooth = CALM / float(np.median(np.diff(track.time)))
    turning = gaussian_filter1d(np.gradient(track.qd, track.time, axis=0), smooth, axis=0)
    pull = track.calm - inertia * turning
    heavy = seen(inertia).max(axis=0) > min(stiffnesses)  # other links swing too fast at any
    if not heavy.any():
        yield from np.zeros((len(stiffnesses), *track.q.shape))
        return
    q, qd, needs, mass = (x[:, heavy] for x in (track.q, track.qd, pull, inertia))
    place, rate = wound(track.time, q, qd, needs, mass, np.array(stiffnesses))
    for k in range(len(stiffnesses)):
        found = np.zeros_like(track.q)
        found[:, heavy] = np.gradient(mass * rate[:, :, k], track.time, axis=0)
        found[:, heavy] -= sag[:, heavy] * place[:, :, k]
        yield found


def _of_links(track: Track) -> tuple[Array, Array]:
    """Return each link's inertia about its joint (T, N), kg m^2, and its gravity's slope (T, N), Nm/rad."""
    at = track.slopes
    own = (np.ascontiguousarray(np.diagonal(at.values[k], axis1=1, axis2=2)) for k in ("pv", "bq"))
    inertia, sag = (between(track.time, at.time, x) for x in own)
    return inertia, sag
