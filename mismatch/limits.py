"""Detection thresholds for the refined model: what its own observer sees in the recordings it is from."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..codegen.generate import observer_text
from ..codegen.load import load_text
from ..identify.free_motion import largest
from ..identify.thresholds import Residual, fit_thresholds
from ..recordings import Recording
from ..robots.model import Model
from .proof import FALSE_ALARMS

Array = NDArray[np.float64]

#: s that a touch goes on in the observer's low-pass; s of free motion below which there is nothing to fit.
_AFTER, _SHORTEST = 1.0, 30.0
#: Samples that the observer is run over at most: it works one at a time, at 1 ms each.
_MOST = 30_000


def with_thresholds(
    model: Model, recordings: Sequence[Recording], inflate: Array, touched: Sequence[tuple[float, float]]
) -> Model:
    """Return a model with thresholds at FALSE_ALARMS an hour; as it is where too little motion is free.

    inflate (N,): held-out over fitted error. touched: stretches (s) that are no free motion.
    """
    module = load_text(observer_text(model))
    each = _MOST // max(len(recordings), 1)
    free = [_untouched(largest(_middle(r, each), module), touched) for r in recordings]
    free = [r for r in free if len(r.time) > 1]
    if sum(float(r.time[-1] - r.time[0]) for r in free) < _SHORTEST:
        return model
    what = f"held-out over fitted error, {inflate.min():.3g} to {inflate.max():.3g}"
    return model.model_copy(update={"thresholds": fit_thresholds(free, FALSE_ALARMS, inflate, what)})


def _middle(recording: Recording, most: int) -> Recording:
    """Return the recording, or so many samples from its middle."""
    start = max(0, (len(recording) - most) // 2)
    return recording.take(slice(start, start + most)) if start else recording


def _untouched(seen: Residual, touched: Sequence[tuple[float, float]]) -> Residual:
    keep = np.ones(len(seen.time), np.bool_)
    for begin, end in touched:
        keep &= (seen.time < begin) | (seen.time > end + _AFTER)
    return Residual(seen.time[keep], seen.size[keep], seen.speed[keep])
