"""The observer beside a running robot: residual, thresholds and detections as they come."""

from collections.abc import Iterator
from dataclasses import dataclass
from types import ModuleType

import numpy as np
import numpy.typing as npt

from ..errors import InputError
from .rtde import PORT, Rtde

Array = npt.NDArray[np.float64]
FIELDS = ("timestamp", "actual_q", "actual_qd", "actual_current", "joint_temperatures")
RATE = 500.0
SETTLING = 5.0
"""Time constants of the observer before detections count."""


@dataclass(frozen=True)
class Reading:
    """What is so after the latest package. Arrays (N,).

    time: s of the robot. q: rad. external: external torque, Nm. threshold: Nm at the present speed, NaN
    without one. temperature: deg C. over: joints above their threshold now. detections: rises above it so
    far. latest: time of the latest, or None. packages, lost: since the start.
    """

    time: float
    q: Array
    external: Array
    threshold: Array
    temperature: Array
    over: npt.NDArray[np.bool_]
    detections: npt.NDArray[np.int_]
    latest: float | None
    packages: int
    lost: int


class Monitor:
    """A generated observer on a robot's stream.

    observer: a module of gen-model's observer.py. Every package goes through it, in blocks, so that a slow
    terminal costs no sample. Raises InputError as `Rtde` does.
    """

    def __init__(self, host: str, observer: ModuleType, port: int = PORT) -> None:
        self._robot = Rtde(host, FIELDS, RATE, port)
        self._module, self._n = observer, int(observer.DOF)
        self._observer = observer.Observer(dt=1.0 / RATE)
        none = np.full(self._n, np.nan)
        self._threshold = np.asarray(getattr(observer, "THRESHOLDS", none), dtype=float)
        self._per_speed = np.asarray(getattr(observer, "THRESHOLDS_PER_SPEED", 0.0 * none), dtype=float)
        self._longest = 0.5 / float(np.max(observer.GAIN))  # s; after a gap the observer takes no longer step
        self._counts = np.zeros(self._n, dtype=int)
        self._over = np.zeros(self._n, dtype=bool)
        self._latest: float | None = None
        self._last = np.nan
        self._packages = self._lost = 0

    def readings(self) -> Iterator[Reading]:
        """Yield a reading after every block of packages."""
        with self._robot:
            for block in self._robot.rows():
                yield self._take(block)

    def _take(self, block: Array) -> Reading:
        robot, n = self._robot, self._n
        time = robot.part(block, "timestamp")[:, 0]
        steps = np.diff(time, prepend=self._last if self._packages else time[0] - 1.0 / RATE)
        if (steps <= 0.0).any():
            raise InputError("the robot's clock went backwards; it was restarted")
        self._lost += int((np.round(steps * RATE) - 1.0).sum())
        q, qd, current, heat = (
            robot.part(block, name)[:, :n]
            for name in ("actual_q", "actual_qd", "actual_current", "joint_temperatures")
        )
        external = self._observer.run(q, qd, current, temperature=heat, dt=np.minimum(steps, self._longest))
        level = self._threshold + self._per_speed * np.abs(qd)
        self._count(time, np.abs(external) > level)
        self._packages += len(block)
        self._last = float(time[-1])
        return Reading(
            time=self._last,
            q=q[-1],
            external=external[-1],
            threshold=level[-1],
            temperature=heat[-1],
            over=self._over,
            detections=self._counts.copy(),
            latest=self._latest,
            packages=self._packages,
            lost=self._lost,
        )

    def _count(self, time: Array, over: npt.NDArray[np.bool_]) -> None:
        settled = self._packages + np.arange(len(time)) > SETTLING / float(self._module.GAIN) * RATE
        over = over & settled[:, None]
        before = np.vstack([self._over, over[:-1]])
        rises = over & ~before
        self._counts += rises.sum(axis=0)
        if rises.any():
            self._latest = float(time[np.flatnonzero(rises.any(axis=1))[-1]])
        self._over = over[-1]
