"""From what happened to what the controller reports: delay, noise, resolution.

Blocks of any length come in and go out; a run measured row by row gives the same numbers as in one block,
because every channel draws from its own stream and delays remember the rows before.
"""

from dataclasses import dataclass, fields
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from .controller import TICK
from .plant import Plant

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Rows:
    """What happened at the starts of T control cycles. time (T,) s; the rest (T, N), but flange (T, 6).

    q, qd: motor side (where the encoder is), rad and rad/s. current: A. temperature: deg C. flange: force
    and moment on the last link at the flange, base frame (N, Nm). target_*: the controller's own.
    link_q, link_qd: link side. motor: torque of the motor; friction: what friction takes of it; gear: what
    the gear transmits to the link; external: of contacts and obstacles (Nm).
    """

    time: Array
    q: Array
    qd: Array
    current: Array
    temperature: Array
    target_q: Array
    target_qd: Array
    target_qdd: Array
    target_current: Array
    target_moment: Array
    link_q: Array
    link_qd: Array
    motor: Array
    friction: Array
    gear: Array
    external: Array
    flange: Array

    @staticmethod
    def of(table: Array, joints: int) -> "Rows":
        """Cut a table (T, 1 + 15 N + 6) into its columns, in the order of the fields."""
        names = [field.name for field in fields(Rows)]
        edges = 1 + joints * np.arange(len(names) - 1)
        columns = [table[:, 0], *(table[:, a:b] for a, b in pairwise(edges)), table[:, edges[-1] :]]
        return Rows(**dict(zip(names, columns, strict=True)))


class Sensors:
    """The sensors of one arm with N joints. seed: of all noise."""

    def __init__(self, plant: Plant, joints: int, seed: int) -> None:
        self._plant, self._joints = plant, joints
        names = ("current", "q", "qd", "force", "moment")
        self._streams = {name: np.random.default_rng([seed, k]) for k, name in enumerate(names)}
        self._offset = {"q": np.zeros(joints), "current": np.zeros(joints)}
        for encoder in plant.encoder_offset:
            self._offset["q"][encoder.joint - 1] += encoder.offset
        for current in plant.current_offset:
            self._offset["current"][current.joint - 1] += current.offset
        self._delays = {name: self._delay(name) for name in ("q", "qd", "current")}
        self._keep = int(np.ceil(max(d.max() for d in self._delays.values()) / TICK)) + 1
        self._past: dict[str, Array] = {}

    def measure(self, rows: Rows) -> dict[str, Array]:
        """Return the RTDE fields of a block: name -> (T, N); actual_TCP_force (T, 6), timestamp (T,)."""
        s, n = self._plant.sensing, self._joints
        q, qd, current = (self._late(name, getattr(rows, name)) for name in ("q", "qd", "current"))
        still = np.abs(qd) < s.standstill
        noisy = np.array(s.current_noise[:n]) * (1.0 + s.current_growth * np.abs(qd))
        current = current + self._offset["current"] + noisy * self._noise("current", qd.shape)
        q = q + self._offset["q"] + s.position_noise * self._noise("q", qd.shape)
        moved = qd + (s.speed_noise + s.speed_growth * np.abs(qd)) * self._noise("qd", qd.shape)
        wrench = rows.flange + np.array(s.force_bias)
        size = (len(q), 3)
        wrench[:, :3] += s.force_noise * self._noise("force", size)
        wrench[:, 3:] += s.moment_noise * self._noise("moment", size)
        return {
            "timestamp": rows.time,
            "actual_q": _steps(q, s.position_resolution),
            "actual_qd": np.where(still, 0.0, moved),
            "actual_current": _steps(current, s.current_resolution),
            "target_q": rows.target_q,
            "target_qd": rows.target_qd,
            "target_qdd": rows.target_qdd,
            "target_current": rows.target_current,
            "target_moment": rows.target_moment,
            "joint_temperatures": _steps(rows.temperature, s.temperature_resolution),
            "actual_TCP_force": wrench,
        }

    def _delay(self, name: str) -> Array:
        delay = np.zeros(self._joints)
        for effect in self._plant.time_delay:
            if name == "current" or effect.channels == "all":
                chosen = [j - 1 for j in effect.joints if j <= self._joints] or list(range(self._joints))
                delay[chosen] += effect.delay
        return delay

    def _late(self, name: str, values: Array) -> Array:
        """Return values (T, N) as they were `delay` s ago, interpolated between cycles."""
        shift = self._delays[name] / TICK
        if not shift.any():
            return values
        before = self._past.get(name, np.repeat(values[:1], self._keep, axis=0))
        joined = np.concatenate([before, values])
        self._past[name] = joined[-self._keep :]
        index = np.arange(len(joined))
        now = index[self._keep :]
        columns = [np.interp(now - shift[k], index, joined[:, k]) for k in range(self._joints)]
        return np.stack(columns, axis=1)

    def _noise(self, name: str, shape: tuple[int, ...]) -> Array:
        return self._streams[name].standard_normal(shape)


def _steps(values: Array, resolution: float) -> Array:
    return np.round(values / resolution) * resolution if resolution else values
