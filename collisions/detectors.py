"""The detectors, all on the same samples; a score of 1 and more on any joint is a collision.

thesis: external torque over the thesis' thresholds while the joint moves, over the fitted limit else.
static, speed: external torque over the fitted limit, constant or growing with speed.
cusum, velocity, vote: the guard's (docs/guard.md). current: low-passed difference of actual and target
current, as torque, over its own fitted limit: it needs no model but the controller's.
"""

from dataclasses import dataclass, field
from functools import cache
from types import ModuleType

import numpy as np
import numpy.typing as npt
from scipy.signal import lfilter

from ..codegen.guard import CUSUM_DRIFT, CUSUM_TIME, SPEED_DEVIATION, VOTES
from ..codegen.load import load_text
from ..virtual import TICK
from .published import THRESHOLDS

Array = npt.NDArray[np.float64]

DETECTORS = ("thesis", "thesis-25", "static", "speed", "cusum", "velocity", "vote", "current")
#: A joint moves when it has been faster than this (rad/s) in one direction for so many time constants.
MOVING, SETTLED = 0.05, 5.0
GENERATED_GAIN = 25.0


@dataclass(frozen=True)
class Samples:
    """T samples of N joints at 500 Hz: rad, rad/s, A, deg C, each (T, N)."""

    q: Array
    qd: Array
    current: Array
    heat: Array
    target_qd: Array
    target_current: Array

    @staticmethod
    def of(fields: dict[str, Array]) -> "Samples":
        """Take them from RTDE fields, (T, N) or (N,) each."""
        names = ("actual_q", "actual_qd", "actual_current", "joint_temperatures", "target_qd")
        columns = [np.atleast_2d(fields[name]) for name in (*names, "target_current")]
        return Samples(*columns)


@dataclass(frozen=True)
class Eyes:
    """What a detector sees with. static, speed, per_speed, current: limits (N,) in Nm (Nm s/rad).

    text: of a generated observer.py; name: of the model that it is from. gain: of the thesis' detector, 1/s.
    """

    name: str
    text: str
    static: Array
    speed: Array
    per_speed: Array
    current: Array
    gain: float

    @property
    def observer(self) -> ModuleType:
        """The generated module."""
        return _module(self.text)


@cache
def _module(text: str) -> ModuleType:
    return load_text(text)


@dataclass
class Watch:
    """Runs chosen detectors over samples, piece by piece; remembers where it was.

    residual (N,): external torque after the last sample, Nm, of the observer that was used.
    """

    eyes: Eyes
    names: tuple[str, ...] = DETECTORS
    residual: Array = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        n = len(self.eyes.static)
        observers = {"thesis": self.eyes.gain, "thesis-25": GENERATED_GAIN}
        modelled = {"static", "speed", "cusum", "vote"} & set(self.names)
        self._observers = {
            name: self.eyes.observer.Observer(gain=gain)
            for name, gain in observers.items()
            if name in self.names or (modelled and name == "thesis-25")
        }
        self._length = np.zeros(n)
        self._side = np.zeros(n)
        self._sums = np.zeros((2, n))
        self._low = np.zeros((1, n))

    def run(self, x: Samples) -> dict[str, Array]:
        """Return name -> score (T, N)."""
        eyes, out = self.eyes, dict[str, Array]()
        external = {k: o.run(x.q, x.qd, x.current, x.heat) for k, o in self._observers.items()}
        if external:
            self.residual = next(iter(external.values()))[-1]
        runs = self._same_direction(x.qd)
        limit = eyes.speed + eyes.per_speed * np.abs(x.qd)
        for name in self.names:
            if name in ("thesis", "thesis-25"):
                out[name] = np.abs(external[name]) / self._thesis_limit(runs, name)
            elif name == "static":
                out[name] = np.abs(external["thesis-25"]) / eyes.static
            elif name == "current":
                out[name] = self._by_current(x)
        out |= self._of_guard(x, external.get("thesis-25"), limit)
        return {name: out[name] for name in self.names}

    def _of_guard(self, x: Samples, external: Array | None, limit: Array) -> dict[str, Array]:
        """Return what the guard's detectors score."""
        out = {"velocity": np.abs(x.target_qd - x.qd) / SPEED_DEVIATION}
        if external is None:
            return out
        out["speed"] = np.abs(external) / limit
        if {"cusum", "vote"} & set(self.names):
            out["cusum"] = self._page(external / limit)
        if "vote" in self.names:
            agree = [out[name] >= 1.0 for name in ("speed", "cusum", "velocity")]
            out["vote"] = np.sum(agree, axis=0) / VOTES
        return out

    def _thesis_limit(self, runs: Array, name: str) -> Array:
        gain = self.eyes.gain if name == "thesis" else GENERATED_GAIN
        limit = np.tile(self.eyes.static, (len(runs), 1))
        low = np.minimum(THRESHOLDS, self.eyes.static[:3])
        moving = runs[:, :3] >= SETTLED / gain / TICK
        limit[:, :3] = np.where(moving, low, limit[:, :3])
        return limit

    def _same_direction(self, qd: Array) -> Array:
        """Return for how many samples (T, N) each joint has moved in its present direction; 0 at rest."""
        side = np.sign(qd) * (np.abs(qd) > MOVING)
        before = np.vstack([self._side, side[:-1]])
        at = np.arange(len(qd))[:, None]
        begun = np.where(side != before, at, -self._length[None])
        length = (at - np.maximum.accumulate(begun, axis=0) + 1.0) * (side != 0.0)
        self._side, self._length = side[-1], length[-1]
        return np.asarray(length)

    def _page(self, share: Array) -> Array:
        """Return Page's sum over its limit, the larger of both sides (T, N)."""
        sums = []
        for k, sign in enumerate((1.0, -1.0)):
            total = self._sums[k] + np.cumsum((sign * share - CUSUM_DRIFT) * TICK, axis=0)
            sums.append(total - np.minimum(np.minimum.accumulate(total, axis=0), 0.0))
            self._sums[k] = sums[-1][-1]
        return np.asarray(np.maximum(*sums) / CUSUM_TIME)

    def _by_current(self, x: Samples) -> Array:
        return np.abs(self.current_torque(x)) / self.eyes.current

    def current_torque(self, x: Samples) -> Array:
        """Return drive gain times actual less target current behind the observer's low-pass, (T, N) Nm."""
        torque = self.eyes.observer.GAINS * (x.current - x.target_current)
        share = GENERATED_GAIN * TICK
        out, self._low = lfilter([share], [1.0, share - 1.0], torque, axis=0, zi=self._low)
        return np.asarray(out)


def first(score: Array, since: int) -> tuple[int, int] | None:
    """Return (sample, joint 1..N) of the first collision from a sample on, None without one."""
    hit = np.flatnonzero(score[since:].max(axis=1) >= 1.0)
    if not len(hit):
        return None
    at = since + int(hit[0])
    return at, int(score[at].argmax()) + 1
