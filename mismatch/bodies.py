"""Whether a change of masses is one that a body makes, or only a combination of columns that fits."""

import numpy as np

from ..identify.physical import unlike_a_body
from .acceptance import EVIDENCE
from .evidence import Evidence
from .naming import Scored
from .selection import Directions, eliminate

#: The nearest change that a body makes has to explain this share of what the columns do.
_MOST = 0.5
#: A link that is this many times as heavy as published is another link; kg of the heaviest payload.
_TIMES, _LOAD = 3.0, 30.0


def bodiless(weighed: Evidence, model: Directions, test: Scored) -> str:
    """Return in words that no body makes a link's or a payload's change, or nothing.

    A link has to be a body after it (positive mass, principal moments that obey the triangle inequality), and
    so has a payload; one that was put down since a reference is the same with the other sign.
    """
    c, physics = test.candidate, weighed.setup.physics
    if c.effect not in ("link_inertial", "payload"):
        return ""
    link = physics.dof - 1 if c.joint is None else c.joint
    addition = weighed.found.directions.take(c.columns)
    found = eliminate(weighed.sums, model, addition, None)
    size, covariance = found.solve(range(len(c.columns)))
    base = len(weighed.setup.space.base)
    mapping = (
        np.linalg.pinv(addition.vectors[:base].toarray()) @ physics.map.links[:, 10 * link : 10 * link + 10]
    )
    before = physics.links[link] if c.joint is not None else np.zeros(10)
    heaviest = _TIMES * float(before[0]) if c.joint is not None else _LOAD
    information = np.asarray(np.linalg.inv(covariance), np.float64)
    signs = (1.0, -1.0) if c.joint is None and weighed.has_reference else (1.0,)
    lost = min(unlike_a_body(sign * size, information, mapping, before, heaviest) for sign in signs)
    if test.evidence - lost >= max(EVIDENCE, _MOST * test.evidence):
        return ""
    return f"no body makes it: {lost:.0f} of its {test.evidence:.0f} nats"
