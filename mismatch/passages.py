"""Whether what acts at reversals acts at nearly all of them, or makes its size of a few.

A joint that bounces at a stop, or goes on where it was to turn, leaves a few strange passages through zero
speed. A late sign is late at each of them.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation

from .evidence import Evidence
from .grams import regime
from .local import gains
from .naming import Scored
from .plausibility import AT_REVERSALS
from .segments import stretches
from .selection import Directions

Array = NDArray[np.float64]

#: Rows beside a passage that belong to it: what it changes is seen there as well.
_BESIDE = 3
#: Nats from which on a passage tells anything, of how many that do a part is known, and that part.
TELLS, ENOUGH, IMPROVED = 0.5, 5, 0.8


def at_few_passages(weighed: Evidence, model: Directions, test: Scored) -> str:
    """Return in words that too many passages of its joint speak against a hypothesis, or nothing.

    weighed: by what it leaves, as an addition to a model.
    """
    c = test.candidate
    if c.joint is None or c.effect not in AT_REVERSALS:
        return ""
    each = list[float]()
    for rows, gain, _ in gains(weighed, model, test, c.joint):
        which = regime(rows)[:, c.joint]
        near = binary_dilation(which == 1, np.ones(2 * _BESIDE + 1, np.bool_)) & (which < 2)
        each += [float(gain[part].sum()) for part in stretches(near)]
    return few(np.array(each))


def few(gain: Array) -> str:
    """Return in words that too few passages, which gain (n,) nats, are improved, or nothing."""
    telling = gain[np.abs(gain) > TELLS]
    if len(telling) < ENOUGH or (part := float(np.mean(telling > 0))) >= IMPROVED:
        return ""
    return f"improves only {100 * part:.0f} % of {len(telling)} passages through zero speed"
