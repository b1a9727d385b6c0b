"""What recordings cannot show, said before anything is named."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..recordings import Recording
from .evidence import Evidence
from .repeats import share

#: s of motion below which nothing is named; rad of travel below which a joint stands.
_SHORTEST, _TRAVEL = 5.0, 0.05
#: Hz; below it reversals, delay and elasticity are out of sight.
SLOW = 60.0
#: Share of the motion that has to be the reference's as well, for all that a reference can show.
_SAME = 0.5


@dataclass(frozen=True)
class Lacks:
    """Sentences; hopeless: nothing can be named from these recordings."""

    texts: tuple[str, ...]
    hopeless: bool


def cannot_show(evidence: Evidence, recordings: Sequence[Recording]) -> Lacks:
    """Say what these recordings leave open, and whether they show anything at all."""
    runs = [r for r, o in zip(evidence.runs, evidence.observed, strict=True) if o and len(r)]
    if not runs:
        return Lacks(("nothing: no recording is long enough for the filter (5 s without a gap)",), True)
    q = np.concatenate([r.q for r in runs])
    moving = sum(float(r.arm_moves.sum()) * r.step for r in runs)
    texts = []
    standing = [j + 1 for j in range(q.shape[1]) if float(np.ptp(q[:, j])) < _TRAVEL]
    if len(standing) == q.shape[1]:
        texts.append("anything: no joint moves, and at rest friction hides every torque below its own level")
    elif standing:
        numbers = ", ".join(map(str, standing))
        texts.append(f"friction and inertia of joint {numbers}: it stands still here")
    for x in (x for x in evidence.setup.lacking if x.joints):
        numbers, fewer, all_of = ", ".join(map(str, x.joints)), q.shape[1], x.whole.dof
        texts.append(
            f"joint {numbers}: a model of {fewer} joints holds it still, but it moves; give --dof {all_of}"
        )
    texts += _of_rate([r.rate for r in recordings])
    if any(r.qd is None for r in recordings):
        texts.append(
            "friction next to standstill to better than a sample: speeds were not recorded, only derived"
        )
    heat = np.concatenate([r.temperature for r in runs])
    if any(r.joint_temperatures is None for r in recordings):
        texts.append("friction by temperature: joint_temperatures were not recorded")
    elif float(np.ptp(heat, axis=0).max()) < 3.0:
        texts.append("friction by temperature: no joint warms by more than 3 K")
    if not evidence.has_reference:
        texts.append(
            "a drive gain or a load apart from the links' own masses, to better than the published masses"
        )
    elif moving and (same := share(runs, evidence.setup.space)) < _SAME:
        texts.append(
            f"changes as small as a reference on the same path would show: it holds {100 * same:.0f} % of"
            " this motion"
        )
    if moving < _SHORTEST:
        texts.insert(0, f"{moving:.1f} s of motion are too few to name anything; record a minute or more")
    return Lacks(tuple(texts), moving < _SHORTEST)


def _of_rate(rates: Sequence[float]) -> list[str]:
    slowest = min(rates)
    if slowest >= SLOW:
        return []
    return [
        f"delay, elasticity, backlash and what happens at reversals: {slowest:.0f} Hz is too slow for them"
    ]
