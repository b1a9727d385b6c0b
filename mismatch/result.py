"""What `explain` hands over: findings as the contract has them, the refined model, what to look at."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..robots.model import Model

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Source:
    """A recording that was used. notes: what the audit dropped or remarked, in words."""

    name: str
    seconds: float
    rate: float
    reference: bool
    notes: tuple[str, ...]


@dataclass(frozen=True)
class Trace:
    """Residuals of one joint (1..N) over one observed recording, filtered: time (n,) s, the rest (n,) Nm.

    before: torque less the model without the findings; after: with them; effect: what the findings add.
    q (rad), qd (rad/s), load (Nm), temperature (deg C), since (s since the joint reversed).
    """

    recording: str
    joint: int
    time: Array
    before: Array
    after: Array
    effect: Array
    q: Array
    qd: Array
    load: Array
    temperature: Array
    since: Array


@dataclass(frozen=True)
class Region:
    """Where a joint's unexplained torque sits: left-out variance explained by one variable, and its range."""

    joint: int
    variable: str
    share: float
    low: float
    high: float
    unit: str
    recording: str | None = None
    intervals: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True)
class RuledOut:
    """A name that was considered and is not the answer. joint None: all joints."""

    effect: str
    joint: int | None
    reason: str


@dataclass(frozen=True)
class Proof:
    """Left-out error by joint (N,), Nm: before, after with its 95 % interval (N, 2), the flexible ceiling.

    reached (N,): share of what the flexible curve explains that the named physics does (nan: nothing).
    threshold_before, threshold_after (N,): Nm at `false_alarms` an hour, from the same left-out residuals.
    """

    scheme: str
    before: Array
    after: Array
    interval: Array
    ceiling: Array
    reached: Array
    threshold_before: Array
    threshold_after: Array
    false_alarms: float


@dataclass(frozen=True)
class NextMotion:
    """The motion that would settle what these recordings cannot: text, rad waypoints (K, N), URScript."""

    text: str
    waypoints: Array
    speed: float  # rad/s
    script: str
    separation: Mapping[str, float]


@dataclass(frozen=True)
class Explanation:
    """The whole answer.

    findings: the dictionary of findings.json. sentence: the answer in one sentence. curves: for "unknown", by
    joint (variable, grid (G,), value (G,) Nm): a flexible curve that is not physics. cannot: what these data
    cannot show, in words.
    """

    robot: str
    sources: tuple[Source, ...]
    findings: Mapping[str, Any]
    sentence: str
    model: Model
    proof: Proof
    regions: tuple[Region, ...]
    traces: tuple[Trace, ...]
    ruled_out: tuple[RuledOut, ...]
    curves: Mapping[int, tuple[str, Array, Array]]
    cannot: tuple[str, ...]
    next_motion: NextMotion | None
