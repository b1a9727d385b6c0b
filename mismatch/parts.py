"""What explain has found out, before it is put into words."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..robots import Robot
from ..robots.model import Model
from .carried import Carried
from .episodes import Episode
from .evidence import Evidence
from .judging import Judged
from .pushes import Pushed
from .refit import LeftOut
from .result import NextMotion, Proof, Region, Source
from .rows import Rows
from .sharpen import Sharp
from .unknown import Unknown

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Parts:
    """Everything that was found out.

    evidence: of the rows without pushes; runs, left, before, after: of all rows of the observed runs. left:
    what all names leave (n, N), Nm. unloaded (N,): the error before, once the carried load is off, Nm.
    """

    robot: Robot
    nominal: Model
    sources: tuple[Source, ...]
    evidence: Evidence
    judged: Judged
    sharp: Mapping[int, Sharp]
    episodes: Sequence[Episode]
    runs: Sequence[Rows]
    left: Sequence[Array]
    pushed: Pushed | None
    unknowns: Sequence[Unknown]
    proof: Proof
    before: LeftOut
    after: LeftOut
    placebos: float | None
    regions: tuple[Region, ...]
    names: Sequence[str]
    lacks: tuple[str, ...]
    model: Model
    next_motion: NextMotion | None = None
    carried: Carried | None = None
    unloaded: Array | None = None
