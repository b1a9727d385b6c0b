"""Friction of one joint, in joint units: a bristle that carries the Coulomb level, and drag by speed.

The bristle is the generalised Maxwell-slip model (Al-Bender, Lampaert, Swevers 2005): elasto-plastic
elements, with damping as in LuGre, whose torque is cut at the level of that moment. At standstill the
torque is whatever holds the joint, anything within +-level, without creep; a closed path closes its loop.
"""

from bisect import bisect_right
from collections.abc import Callable
from math import exp

import numpy as np
import numpy.typing as npt
from scipy.interpolate import PchipInterpolator

from ..errors import InputError
from ..robots import Robot
from .plant import BaseFriction

Array = npt.NDArray[np.float64]
Level = Callable[[float, float, float], float]  # (q rad, qd rad/s, gear torque Nm) -> Nm of Coulomb level

# Factory calibration sheet of one UR5e, published with the AURT toolbox; motor-side Nm, about 40-46 C.
# Its points at +-0.01 rad/s repeat the stiction with fewer digits, so they are left out.
SHEET_SPEED = (-3.20, -1.50, -0.50, 0.50, 1.50, 3.20)  # rad/s at the joint
SHEET_TORQUE = (
    (-0.181, -0.139, -0.094, 0.095, 0.136, 0.174),
    (-0.219, -0.158, -0.106, 0.107, 0.160, 0.210),
    (-0.180, -0.136, -0.089, 0.089, 0.136, 0.183),
    (-0.044, -0.034, -0.024, 0.023, 0.033, 0.043),
    (-0.038, -0.030, -0.021, 0.020, 0.029, 0.037),
    (-0.040, -0.031, -0.022, 0.020, 0.028, 0.039),
)
SHEET_STICTION = (
    (-0.05894, 0.05545), (-0.06557, 0.06376), (-0.04986, 0.04965),
    (-0.01406, 0.01402), (-0.01208, 0.01237), (-0.01248, 0.01253),
)  # fmt: skip
SHEET_RATING = (150.0, 150.0, 150.0, 28.0, 28.0, 28.0)  # Nm, of those joints

BRISTLE_TIME = 0.005  # s, damping over stiffness of a bristle: 0.25-0.4 of critical at the joints of a UR5e
CELLS_PER_SPEED = 256.0  # table cells per rad/s
TABLE_SPEED = 8.0  # rad/s; beyond it the drag stays


class Curve:
    """Friction against speed of one joint: a stiction pair (Nm) and measured points.

    PCHIP through the points (0, stiction) and those of the sheet on either side: smooth, no overshoot,
    and straight on beyond the last point.
    """

    def __init__(self, speed: Array, torque: Array, stiction: tuple[float, float]) -> None:
        self.low, self.high = stiction
        self._sides = {
            -1: self._side(-speed[speed < 0][::-1], -(torque[speed < 0][::-1]), -self.low),
            +1: self._side(speed[speed > 0], torque[speed > 0], self.high),
        }

    def drag(self, speed: Array) -> Array:
        """Return what the curve adds to the stiction of its side at some speeds, Nm with the speed's sign."""
        negative, positive = (self._sides[s](np.maximum(s * speed, 0.0)) for s in (-1, 1))
        return np.where(speed < 0, -negative, positive)

    @staticmethod
    def _side(speed: Array, torque: Array, level: float) -> Callable[[Array], Array]:
        x, y = np.concatenate([[0.0], speed]), np.concatenate([[0.0], torque - level])
        if len(x) == 2:
            return lambda v: y[1] / x[1] * v
        inside = PchipInterpolator(x, y)
        slope = (y[-1] - y[-2]) / (x[-1] - x[-2])
        return lambda v: inside(np.minimum(v, x[-1])) + slope * np.maximum(v - x[-1], 0.0)


def curves(robot: Robot, base: BaseFriction) -> list[Curve]:
    """Return the friction curve of every joint, joint side.

    For robots other than the UR5e the sheet of the nearest joint size is scaled with the torque rating:
    an assumption, there is no public sheet. Raises InputError when a given curve lacks joints.
    """
    if base.kind == "none":
        return [Curve(np.array([-1.0, 1.0]), np.zeros(2), (0.0, 0.0)) for _ in robot.joint]
    if base.kind == "curve":
        if len(base.torque) < len(robot.joint):
            raise InputError(
                f"plant: friction: {len(base.torque)} rows of torque for {len(robot.joint)} joints"
            )
        return [
            Curve(np.array(base.speed), np.array(row), stiction)
            for row, stiction in zip(base.torque, base.stiction, strict=True)
        ]
    return [_sheet(i, joint.gear, joint.max_torque) for i, joint in enumerate(robot.joint)]


def _sheet(index: int, gear: float, rating: float) -> Curve:
    row = index if index < 6 and SHEET_RATING[index] == rating else (2 if rating > 75.0 else 3)
    scale = gear * rating / SHEET_RATING[row]
    low, high = SHEET_STICTION[row]
    return Curve(np.array(SHEET_SPEED), scale * np.array(SHEET_TORQUE[row]), (scale * low, scale * high))


class Drag:
    """The part of a joint's friction that depends on speed alone, Nm, from a fine table.

    extra: effects of speed alone, added to the curve's drag.
    """

    __slots__ = ("_last", "_table")

    def __init__(self, curve: Curve, extra: Callable[[Array], Array] | None = None) -> None:
        cells = int(TABLE_SPEED * CELLS_PER_SPEED)
        speed = np.arange(-cells, cells + 1) / CELLS_PER_SPEED
        drag = curve.drag(speed) + (extra(speed) if extra else 0.0)
        self._table = [float(x) for x in drag]
        self._last = len(drag) - 1

    def __call__(self, qd: float) -> float:
        """Return drag (Nm) at a speed (rad/s)."""
        x = (qd + TABLE_SPEED) * CELLS_PER_SPEED
        table = self._table
        if x < 0.0:
            return table[0]
        if x >= self._last:
            return table[-1]
        k = int(x)
        return table[k] + (table[k + 1] - table[k]) * (x - k)


class Bristle:
    """Elasto-plastic elements in parallel. shares: (part of the level, travel in rad at which it slides)."""

    __slots__ = ("_elements", "_torques")

    def __init__(self, level: float, shares: tuple[tuple[float, float], ...]) -> None:
        self._elements = [(share, share * level / travel) for share, travel in shares]
        self._torques = [0.0] * len(shares)

    def start(self, torque: float) -> None:
        """Begin with some torque (Nm) left over from an earlier motion."""
        self._torques = [share * torque for share, _ in self._elements]

    def torque(self, travel: float, qd: float, up: float, down: float) -> float:
        """Return the torque after some more travel (rad) at a speed (rad/s), between -down and up (Nm)."""
        torques, total = self._torques, 0.0
        for k, (share, stiffness) in enumerate(self._elements):
            z = torques[k] + stiffness * travel
            if z > share * up:
                z = share * up
            elif z < -share * down:
                z = -share * down
            torques[k] = z
            z += BRISTLE_TIME * stiffness * qd
            total += min(max(z, -share * down), share * up)
        return total


class Stick:
    """The bristle with one element, which nearly every joint has: the same, without the loop."""

    __slots__ = ("_damping", "_stiffness", "_torque")

    def __init__(self, level: float, travel: float) -> None:
        self._stiffness = level / travel
        self._damping = BRISTLE_TIME * self._stiffness
        self._torque = 0.0

    def start(self, torque: float) -> None:
        """Begin with some torque (Nm) left over from an earlier motion."""
        self._torque = torque

    def torque(self, travel: float, qd: float, up: float, down: float) -> float:
        """Return the torque after some more travel (rad) at a speed (rad/s), between -down and up (Nm)."""
        z = self._torque + self._stiffness * travel
        if z > up:
            z = up
        elif z < -down:
            z = -down
        self._torque = z
        z += self._damping * qd
        if z > up:
            return up
        return -down if z < -down else z


class Dahl:
    """Dahl 1976 with the level of the moment: dz/dx = (1 - z sgn dx) / travel, stepped exactly."""

    __slots__ = ("_torque", "_travel")

    def __init__(self, travel: float) -> None:
        self._travel = travel
        self._torque = 0.0

    def start(self, torque: float) -> None:
        """Begin with some torque (Nm) left over from an earlier motion."""
        self._torque = torque

    def torque(self, travel: float, qd: float, up: float, down: float) -> float:
        """Return the torque after some more travel (rad), between -down and up (Nm); dissipative as it is."""
        del qd
        end = up if travel > 0.0 else -down
        self._torque = end + (self._torque - end) * exp(-abs(travel) / self._travel)
        return self._torque


class Friction:
    """Friction torque of one joint with its state; all effects that are on meet here.

    levels: functions that add to the Coulomb level. lag: s of frictional memory. coulomb_factor and
    viscous_factor: what temperature does, set from outside now and then. `torque` is positive when it
    resists positive motion (Nm).
    """

    __slots__ = (
        "_bristle", "_drag", "_dt", "_follow", "_slow",
        "coulomb_factor", "down", "levels", "up", "viscous_factor",
    )  # fmt: skip

    def __init__(
        self,
        drag: Drag,
        up: float,
        down: float,
        bristle: "Bristle | Stick | Dahl",
        dt: float,
        lag: float = 0.0,
    ) -> None:
        self.up, self.down, self.levels = up, down, list[Level]()
        self.coulomb_factor = self.viscous_factor = 1.0
        self._drag, self._bristle, self._dt = drag, bristle, dt
        self._follow = dt / (lag + dt) if lag else 0.0
        self._slow = 0.0

    def start(self, part: float) -> None:
        """Begin with a part -1..1 of the Coulomb level in the bristle."""
        self._bristle.start(part * (self.up if part > 0.0 else self.down))

    def torque(self, q: float, qd: float, load: float) -> float:
        """Advance by one substep and return the friction torque (Nm)."""
        drag = self._drag(qd)
        up, down = self.up * self.coulomb_factor, self.down * self.coulomb_factor
        for level in self.levels:
            more = level(q, qd, load)
            up += more
            down += more
        slip = qd
        if self._follow:
            self._slow += self._follow * (qd - self._slow)
            if self._slow * qd < 0.0 and abs(self._slow) > 0.002:  # it slid the other way a moment ago
                slip = 0.0
        return self.viscous_factor * drag + self._bristle.torque(
            slip * self._dt, slip, max(up, 0.0), max(down, 0.0)
        )


def within(intervals: tuple[tuple[float, float], ...]) -> Callable[[float], bool]:
    """Return a quick test whether a time (s) lies in one of some sorted, disjoint intervals."""
    edges = [edge for interval in sorted(intervals) for edge in interval]
    return lambda t: bisect_right(edges, t) % 2 == 1
