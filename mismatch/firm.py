"""Left-out gains beside a model whose narrow priors hold.

Without a reference masses may be off a little, and so may friction around zero speed. Enough rows bend both
as far as a finding asks for, whatever their priors say: the evidence counts that, but left-out blocks are
then predicted as well without the finding as with it. Beside a model that does not bend they tell.
"""

from dataclasses import replace

import numpy as np

from .acceptance import EVIDENCE
from .evidence import Evidence
from .naming import Scored, scored
from .selection import Directions

#: Of its wide prior, a direction that is narrower than this may not bend.
_NARROW, _HELD = 0.5, 0.02
#: Left-out blocks tell little where they hold less than this share of the evidence.
_LITTLE = 0.3


def beside_firm(weighed: Evidence, model: Directions, test: Scored) -> Scored:
    """Return a test with its gains beside a firm model, where blocks tell little of much evidence.

    With a reference priors are the reference's, and all is as it is.
    """
    if weighed.has_reference or test.evidence < 2 * EVIDENCE or test.total >= _LITTLE * test.evidence:
        return test
    return replace(test, gain=scored(weighed, _firm(weighed, model), [test.candidate])[0].gain)


def _firm(evidence: Evidence, model: Directions) -> Directions:
    """Return a model in which what is free by little is held; it shares single parameters."""
    columns = np.concatenate([evidence.base_std, evidence.own_std.ravel()])
    wide = np.zeros(evidence.setup.space.size)  # common columns are never fitted by little
    wide[: len(columns)] = columns
    narrow = model.shared & (model.std < _NARROW * (model.vectors.T @ wide))
    return replace(model, std=np.where(narrow, _HELD * model.std, model.std))
