"""Slack in a gear: where the link stands within the gap, sample by sample.

The encoder sits on the motor. The load presses the link against one flank; when it changes its sign, nothing
holds the link until it has crossed the gap by its own inertia, and the other flank stops it (no rebound).
Torques follow from the arm's Lagrangian at the link's place and speed (physics.slopes).
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Samples that a crossing is followed at a time.
_AHEAD = 64
#: kg m^2; what a link has at least: a fitted wrist may have none.
_LEAST = 1e-3


def within_gap(time: Array, load: Array, inertia: Array, gap: float) -> tuple[Array, Array]:
    """Return the link's angle less the motor's (T,), rad, and its rate (T,), rad/s.

    load (T,): torque, Nm, that would make the link follow the motor; inertia (T,): of the link about the
    joint, kg m^2. gap: half of the slack, rad.
    """
    place, rate = np.empty(len(time)), np.zeros(len(time))
    dt = np.diff(time, append=2 * time[-1] - time[-2])
    pull = load / np.maximum(inertia, _LEAST)
    flank, at = (1.0 if load[0] >= 0 else -1.0), 0
    lifts = {side: np.flatnonzero(load * side < 0) for side in (1.0, -1.0)}  # off the flank of that side
    while at < len(time):
        later = lifts[flank][np.searchsorted(lifts[flank], at) :]
        start = int(later[0]) if len(later) else len(time)
        place[at:start] = -gap * flank
        at, crossed = _crossing(start, flank, pull, dt, gap, place, rate)
        flank = -flank if crossed else flank
    return place, rate


def _crossing(
    start: int, flank: float, pull: Array, dt: Array, gap: float, place: Array, rate: Array
) -> tuple[int, bool]:
    """Fill in a crossing from `start`; return where a flank holds the link again, and whether the other."""
    at, speed, way = start, 0.0, 0.0  # along the crossing: 0 to 2 gap
    while at < len(place):
        part = slice(at, min(at + _AHEAD, len(place)))
        speeds = speed - flank * np.cumsum(pull[part] * dt[part])
        ways = way + np.cumsum(speeds * dt[part])
        over = np.flatnonzero((ways >= 2 * gap) | (ways < 0))
        count = int(over[0]) if len(over) else len(ways)
        place[at : at + count] = flank * (ways[:count] - gap)
        rate[at : at + count] = flank * speeds[:count]
        if len(over):
            crossed = bool(ways[count] >= 2 * gap)
            return at + count, crossed
        at, speed, way = part.stop, float(speeds[-1]), float(ways[-1])
    return at, False
