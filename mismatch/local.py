"""Whether a hypothesis explains the whole motion or only what one place of the joint does.

A damaged tooth acts within a few degrees. What is smooth over the angle takes some of it, and so gains at
that place alone; physics gains wherever it acts.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from .evidence import Evidence, residual
from .grams import Root, roots
from .masses import BODIES
from .naming import Scored, chosen
from .plausibility import NEAR_ZERO
from .refit import observed_runs, parameters
from .rows import Rows
from .selection import Directions

Array = NDArray[np.float64]

#: rad; width of a place. Places overlap by half.
WIDTH = 0.2
#: What turns links or weighs on them shows in the torque of all joints.
_OF_THE_ARM = ("joint_elasticity", "encoder_offset", "link_inertial")
#: One has more of the gain than all others, and more than it should by so many standard deviations.
MOST, SURE = 0.5, 4.0


def at_one_place(weighed: Evidence, model: Directions, test: Scored) -> str:
    """Return in words that a joint's hypothesis, as an addition to a model, gains at one place; or nothing.

    weighed: by what it leaves. Left out are ripple, which is seen in the fast band, what acts around zero
    speed, since joints turn round where their paths do, and slack: a load changes its sign at one angle, too.
    """
    c = test.candidate
    if c.joint is None or c.effect in ("torque_ripple", "backlash", *NEAR_ZERO):
        return ""
    joints = range(weighed.setup.space.dof) if c.effect in _OF_THE_ARM else (c.joint,)
    q, gain, acts = np.concatenate(
        [np.stack([rows.q[:, c.joint], *both]) for rows, *both in _gains(weighed, model, test, joints)],
        axis=1,
    )
    if c.effect in BODIES and gain.sum() <= 0:
        return ""  # masses bend to imitate a body: its evidence is how far they would have to
    return concentrated(q, gain, acts)


def _gains(
    weighed: Evidence, model: Directions, test: Scored, joints: Sequence[int]
) -> Iterator[tuple[Rows, Array, Array]]:
    """Give the rows of each observed run, what each gains on some joints, and should (n,), nats.

    Should: if all rows did what the hypothesis says. weighed: by what it leaves, as an addition to a model.
    """
    fits = [parameters(weighed, m) for m in (model, chosen(model, weighed, test.candidate))]
    for run in observed_runs(weighed):
        rows = weighed.runs[run]
        whiten = roots(rows, weighed.noise)
        left = [residual(rows, weighed.setup.space, theta) for theta in fits]
        first, last = (_whitened(whiten, e, joints) for e in left)
        yield rows, 0.5 * (first**2 - last**2).sum(axis=1), 0.5 * ((first - last) ** 2).sum(axis=1)


def _whitened(whiten: Sequence[Root], left: Array, joints: Sequence[int]) -> Array:
    return np.stack([whiten[j] @ left[:, j] for j in joints], axis=1)


def concentrated(q: Array, gain: Array, acts: Array) -> str:
    """Return in words that gains (n,) are none, or come from one place of the angle q (n,), rad; or nothing.

    acts (n,): half the squared change of the fit over the noise's variance. Where a hypothesis holds, it is
    the gain's mean, and half the gain's variance.
    """
    if (whole := float(gain.sum())) <= 0:
        return "explains nothing of the torque that it acts on"
    for start in (0.0, 0.5 * WIDTH):
        place = np.floor((q - start) / WIDTH).astype(int)
        first = int(place.min(initial=0))
        here, there = (np.bincount(place - first, x) for x in (gain, acts))
        k = int(np.argmax(here))
        usual = whole * float(there[k] / max(there.sum(), 1e-300))
        if here[k] > MOST * whole and here[k] - usual > SURE * np.sqrt(2 * max(usual, 0.0) + 1):
            at = start + (first + k + 0.5) * WIDTH
            return f"{100 * here[k] / whole:.0f} % of what it explains is at {at:.1f} rad alone"
    return ""
