"""What a fitted model's observer shows on the recordings, for thresholds; run where the pieces are."""

from collections.abc import Sequence
from itertools import pairwise
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..codegen.generate import observer_text
from ..codegen.load import load_text
from ..recordings import Recording, speeds
from ..robots.model import Model, Thresholds
from .estimate import HeldOut
from .observation import observe
from .pieces import Piece
from .schedule import Scheduler
from .thresholds import Residual, fit_thresholds

Array = NDArray[np.float64]

#: s; of each such stretch only the largest residual is kept, with the speed at that instant.
_BIN = 0.1


def free_motion_thresholds(
    model: Model, handles: Sequence[Any], per_hour: float, held_out: HeldOut, scheduler: Scheduler
) -> Thresholds | None:
    """Run the model's generated observer over placed pieces without contact and fit thresholds.

    held_out: how much larger errors are on runs that were not fitted; the thresholds grow by that. None
    when no piece is long enough for the observer to settle.
    """
    text = observer_text(model)
    found = [x for x in scheduler.map(residual, handles, text) if len(x.time) > 1]
    if not found:
        return None
    in_sample = np.sqrt(held_out.fitted / np.maximum(held_out.count_own.sum(axis=0), 1.0))
    inflate = np.maximum(1.0, held_out.rms("own") / np.maximum(in_sample, 1e-12))
    return fit_thresholds(
        found, per_hour, inflate, f"held-out over fitted error, {inflate.min():.3g} to {inflate.max():.3g}"
    )


def residual(piece: Piece, observer_text: str) -> Residual:
    """Return the largest external torque of each 0.1 s of a piece, once the observer has settled."""
    return largest(piece.recording, load_text(observer_text))


def largest(recording: Recording, module: ModuleType) -> Residual:
    """Return the largest external torque that an observer sees in each 0.1 s, once it has settled."""
    seen, n = observe(recording, module), module.DOF
    size, speed = np.abs(seen.external_torque), np.abs(speeds(recording)[:, :n])
    time = seen.timestamp[seen.settled]
    size, speed = size[seen.settled], speed[seen.settled]
    if not len(time):
        return Residual(np.empty(0), np.empty((0, n)), np.empty((0, n)))
    first = np.flatnonzero(np.diff(np.floor(time / _BIN), prepend=-np.inf))
    edges = [*first.tolist(), len(time)]
    best = np.array([a + np.argmax(size[a:b], axis=0) for a, b in pairwise(edges)])
    return Residual(time[first], np.take_along_axis(size, best, 0), np.take_along_axis(speed, best, 0))
