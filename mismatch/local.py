"""Whether a hypothesis explains all that it acts on, or what one place, joint, time or its noise does.

A damaged tooth acts within a few degrees. What is smooth over the angle takes some of it, and so gains at
that place alone; what moves all joints may take some of it, and so gains on that joint alone. A cable that
crackles is loud within a range of angles, and a sum over loud rows is large by chance; what jumps within a
recording was not there before. Physics gains wherever it acts, and more than the noise that is there.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .acceptance import EVIDENCE
from .evidence import Evidence, residual
from .grams import Root, roots
from .masses import BODIES
from .naming import Scored, chosen
from .plausibility import NEAR_ZERO
from .refit import observed_runs, parameters
from .selection import Directions

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

#: rad; width of a place. Places overlap by half.
WIDTH = 0.2
#: Left out are ripple, which is seen in the fast band, and slack, whose blows are rare and mistimed, and come
#: at one angle where a load changes its sign.
_EXEMPT = ("torque_ripple", "backlash")
#: What turns links or weighs on them shows in the torque of all joints.
_OF_THE_ARM = ("joint_elasticity", "encoder_offset", "link_inertial")
#: One place has more of the gain than all others, and more than it should by so many standard deviations.
MOST, SURE = 0.5, 4.0
#: Of what acts in all recordings at least this part is before some time, or after it, where less than this
#: part of it is there.
_PART, _THERE = 0.2, 0.2
#: Of what a clock's delay should gain on the other joints: with less, theirs is less than 0.7 times as late.
_OTHERS = 0.4


@dataclass(frozen=True)
class Rowwise:
    """What a hypothesis does in each row of the observed recordings, by joint; arrays (n, N).

    starts (R,): each recording's first row; q: rad; gain: nats; acts: half the squared change of the fit
    over the noise's variance, which is the gain that is due; left: squared residual with it, over the noise's
    variance.
    """

    starts: Indices
    q: Array
    gain: Array
    acts: Array
    left: Array

    @property
    def loudness(self) -> float:
        """The noise's variance where the hypothesis acts, over what it was taken for.

        It is by how much its size is less certain (White 1980, heteroskedasticity-consistent covariance).
        """
        return float(np.sum(self.acts * self.left) / max(float(self.acts.sum()), 1e-300))


def uneven(made: Callable[[], Rowwise], test: Scored) -> str:
    """Return in words that a hypothesis is only some of its rows', or nothing. made: gives what it does."""
    if test.candidate.effect in _EXEMPT:
        return ""
    rows = made()
    return loud(rows, test.evidence) or at_one_place(rows, test) or of_one_joint(rows, test)


def passing(made: Callable[[], Rowwise], test: Scored) -> str:
    """Return in words that a hypothesis begins or ends within recordings, or nothing; made: see `uneven`."""
    return "" if test.candidate.effect in _EXEMPT else for_a_time(made())


def loud(rows: Rowwise, nats: float) -> str:
    """Return in words that nats are fewer than asked, by the noise where the hypothesis acts; or nothing."""
    if (there := nats / max(rows.loudness, 1.0)) >= EVIDENCE:
        return ""
    return f"evidence {there:.1f} nats by the noise where it acts, {EVIDENCE:g} asked"


def at_one_place(rows: Rowwise, test: Scored) -> str:
    """Return in words that a joint's hypothesis gains at one place, or nothing.

    Left out is what acts around zero speed, since joints turn round where their paths do.
    """
    c = test.candidate
    if c.joint is None or c.effect in NEAR_ZERO:
        return ""
    joints = slice(None) if c.effect in _OF_THE_ARM else slice(c.joint, c.joint + 1)
    gain, acts = (x[:, joints].sum(axis=1) for x in (rows.gain, rows.acts))
    if c.effect in BODIES and gain.sum() <= 0:
        return ""  # masses bend to imitate a body: its evidence is how far they would have to
    return concentrated(rows.q[:, c.joint], gain, acts)


def of_one_joint(rows: Rowwise, test: Scored) -> str:
    """Return in words that a clock's delay is not that of all joints, or nothing.

    A clock is as late for one joint as for the next.
    """
    if test.candidate.effect != "time_delay" or test.candidate.joint is not None:
        return ""
    gain, acts = rows.gain.sum(axis=0), rows.acts.sum(axis=0)
    first = int(np.argmax(gain))
    theirs, due = (float(x.sum() - x[first]) for x in (gain, acts))
    if theirs < _OTHERS * due and due - theirs > SURE * np.sqrt(2 * due + 1):
        return f"joints other than {first + 1} gain {100 * theirs / due:.0f} % of what such a delay would"
    return ""


def for_a_time(rows: Rowwise) -> str:
    """Return in words that a hypothesis begins or ends within recordings, or nothing.

    Where a part r of it is there, it gains 2 r - 1 times what is due: where nothing is, it loses as much. All
    recordings with such a time count together.
    """
    gain, acts = rows.gain.sum(axis=1), rows.acts.sum(axis=1)
    lost = absent = 0.0
    for g, a in zip(*(np.split(x, rows.starts[1:]) for x in (gain, acts)), strict=True):
        for own, due in ((g.cumsum(), a.cumsum()), (g[::-1].cumsum(), a[::-1].cumsum())):
            k = int(np.argmin(own))
            if own[k] < (2 * _THERE - 1) * due[k] and due[k] < (1 - _PART) * due[-1]:
                lost, absent = lost - float(own[k]), absent + float(due[k])
    if absent < _PART * float(acts.sum()) or lost < EVIDENCE:
        return ""
    return f"is not there in {100 * absent / acts.sum():.0f} % of the time in which it would show"


def rowwise(weighed: Evidence, model: Directions, test: Scored) -> Rowwise:
    """Return what a hypothesis does as an addition to a model, row by row; weighed: by what it leaves."""
    fits = [parameters(weighed, m) for m in (model, chosen(model, weighed, test.candidate))]
    found = []
    for run in observed_runs(weighed):
        rows = weighed.runs[run]
        whiten = roots(rows, weighed.noise)
        first, last = (_whitened(whiten, residual(rows, weighed.setup.space, theta)) for theta in fits)
        found.append((rows.q, 0.5 * (first**2 - last**2), 0.5 * (first - last) ** 2, last**2))
    lengths = [len(q) for q, *_ in found]
    return Rowwise(np.cumsum([0, *lengths[:-1]]), *(np.concatenate(x) for x in zip(*found, strict=True)))


def _whitened(whiten: Sequence[Root], left: Array) -> Array:
    return np.stack([w @ left[:, j] for j, w in enumerate(whiten)], axis=1)


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
