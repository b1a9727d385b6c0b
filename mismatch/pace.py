"""Whether a hypothesis is as large in slow torques as in all of them: else the model is wrong elsewhere.

Weights that count slow and fast alike and whitened ones both find the true size of what is there; they part
where something else is (Hausman 1978). Noise of speeds and angles is such a thing: it is in the torque's
error and, differentiated once more, in columns that are made of accelerations (errors in variables).
"""

from .evidence import Evidence, evenly_weighed
from .naming import Scored, reweighed, scored
from .selection import Directions

#: Effects whose columns are made of accelerations, or of their changes.
DERIVED = ("joint_elasticity", "time_delay", "rotor_inertia")
#: Sizes may differ by this share, or by so many standard deviations of the slow one.
_APART, _SURE = 0.3, 3.0


def paceless(evidence: Evidence, model: Directions, test: Scored) -> str:
    """Return in words that a hypothesis beside a model has another size in slow torques, or nothing."""
    c = test.candidate
    if c.effect not in DERIVED:
        return ""
    beside = evidence.found.directions.take(c.columns) + model
    slow = scored(reweighed(evenly_weighed(evidence), beside, even=True), model, [c])[0]
    # of a mixture all counts; the second coefficient of a delay is that of friction at reversals
    part = slice(None if c.whole else 1)
    size, whole, spread = (float(x[part].sum()) for x in (slow.size, test.size, slow.std))
    if abs(size - whole) < max(_APART * abs(whole), _SURE * spread):
        return ""
    return f"has {100 * size / whole:.0f} % of its size in slow torques"
