"""A soft gear: where each link stands beside its motor, by the spring's own motion.

The encoder sits on the motor, so the motor's angle is known and drives the link through the spring (Spong
1987). A link of 3 kg m^2 on 10 kNm/rad swings at 9 Hz: within the rows' band, where a link that just follows
its load (rows.py) is far off. Angles drive it, not accelerations, whose noise would.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline

from .track import between

Array = NDArray[np.float64]

#: Hz; a gear is known by its link's swing where that is no faster: rows end at 15 Hz, and errors of speeds
#: and of the clock grow towards it.
FASTEST = 12.0
#: Damping ratio of a gear's spring; wider than most, so that neighbouring stiffnesses can be mixed.
DAMPING = 0.05
#: s; a step at most, and a pause after which the link is taken to rest on its spring again.
STEP, PAUSE = 0.0021, 0.1
#: kg m^2; what a link has at least: a fitted wrist may have none.
_LEAST = 1e-3


def seen(inertia: Array) -> Array:
    """Return the stiffest gears, Nm/rad, whose swing is slow enough to be seen; inertia: of links, kg m^2."""
    return np.asarray(inertia * (2 * np.pi * FASTEST) ** 2, np.float64)


def wound(
    time: Array, q: Array, qd: Array, pull: Array, inertia: Array, stiffness: Array
) -> tuple[Array, Array]:
    """Return the links' angles less the motors', rad, and their rates, rad/s, each (T, N, K).

    q, qd (T, N): of the motors; pull (T, N): what links need beside their own inertia, Nm; inertia (T, N):
    of the links about their joints, kg m^2; stiffness (K,), Nm/rad. Implicit midpoint rule: stable at any
    stiffness, and it damps nothing by itself.
    """
    steps = max(1, int(np.ceil(float(np.median(np.diff(time))) / STEP)))
    parts = np.diff(time)[:, None] * np.arange(steps) / steps
    grid = np.append((time[:-1, None] + parts).ravel(), time[-1])
    angle = CubicHermiteSpline(time, q, qd)(grid)
    speed, load, mass = (between(grid, time, x) for x in (qd, pull, np.maximum(inertia, _LEAST)))
    damping = 2 * DAMPING * np.sqrt(stiffness * mass.mean(axis=0)[:, None])
    place, rate = (np.empty((len(time), q.shape[1], len(stiffness))) for _ in range(2))
    width = np.diff(grid)
    middle = [0.5 * (x[1:] + x[:-1])[:, :, None] for x in (angle, speed, load)]
    share = (width[:, None] / mass[:-1])[:, :, None]
    link = angle[0][:, None] - load[0][:, None] / stiffness
    moves = np.zeros_like(link)
    place[0], rate[0] = link - angle[0][:, None], 0.0
    for i, dt in enumerate(width):
        if dt > PAUSE:
            link, moves = angle[i + 1][:, None] - load[i + 1][:, None] / stiffness, speed[i + 1][:, None]
        else:
            force = stiffness * (middle[0][i] - link) + damping * middle[1][i] - middle[2][i]
            twice = (2 * moves + share[i] * force) / (1 + share[i] * (stiffness * dt / 4 + damping / 2))
            link, moves = link + 0.5 * dt * twice, twice - moves
        if (i + 1) % steps == 0:
            k = (i + 1) // steps
            place[k], rate[k] = link - angle[i + 1][:, None], moves - speed[i + 1][:, None]
    return place, rate
