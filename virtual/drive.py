"""One joint's drive: current -> motor -> friction -> gear -> what MuJoCo gets.

MuJoCo integrates the links by semi-implicit Euler, M a = torque - h. A drive gives it torque = A and an
armature B such that the gear transmits A - B a. Rigid gear: A = motor torque, B = reflected rotor inertia.
Elastic gear: rotor and link are two degrees of freedom coupled by K and D; the coupling is taken implicitly
and the rotor eliminated, so that stiff gears with light links stay stable at any step:
    rotor   J w' = t - g,   g = K (theta - q) + (D + alpha K dt) (w_next - v_next)
    c = (D + alpha K dt) dt,   g = A - B a,   A = (g0 + c t / J) / (1 + c / J),   B = c / (1 + c / J)
alpha = 0 is symplectic (no numerical damping), alpha = 1 is implicit Euler.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import copysign

from .friction import Friction

Disturbance = Callable[[float, float, float], float]  # (motor angle rad, speed rad/s, gear torque Nm) -> Nm
Amplify = Callable[[float], float]  # measured current A -> current that makes torque A


OIL = 0.1  # part of a gear's damping that is left while its flanks are apart


@dataclass(frozen=True)
class Motor:
    """A joint's motor and what acts on it, in joint units.

    gain: Nm/A. inertia: of the rotor, kg m^2. amplify: None for an amplifier that gives what it measures.
    """

    gain: float
    inertia: float
    friction: Friction
    disturbances: list[Disturbance]
    amplify: Amplify | None


class _Drive:
    """What drives share: the motor's torque (joint units throughout), and what they show of it."""

    __slots__ = (
        "_amplify",
        "_disturbances",
        "_friction",
        "_gain",
        "armature",
        "drive",
        "friction",
        "load",
        "motor",
    )

    def __init__(self, motor: Motor, armature: float) -> None:
        self._gain, self._amplify = motor.gain, motor.amplify
        self._friction, self._disturbances = motor.friction, motor.disturbances
        self.armature = armature  # what the link's own inertia grows by, kg m^2
        self.load = 0.0  # what the gear transmits to the link, Nm
        self.motor = 0.0  # what the motor gives, Nm
        self.friction = 0.0  # what friction takes, Nm
        self.drive = 0.0  # motor less friction and with disturbances, Nm

    def heat(self, coulomb: float, viscous: float) -> None:
        """Set the factors of temperature on Coulomb and viscous friction."""
        self._friction.coulomb_factor, self._friction.viscous_factor = coulomb, viscous

    def _driven(self, current: float, angle: float, speed: float) -> float:
        """Advance friction by one substep, at the motor's angle and speed, and return `drive` (Nm)."""
        self.motor = motor = self._gain * (self._amplify(current) if self._amplify else current)
        self.friction = friction = self._friction.torque(angle, speed, self.load)
        torque = motor - friction
        for disturbance in self._disturbances:
            torque += disturbance(angle, speed, self.load)
        self.drive = torque
        return torque


class RigidDrive(_Drive):
    """A drive whose gear does not yield; motor and link move together."""

    __slots__ = ()

    def __init__(self, motor: Motor) -> None:
        super().__init__(motor, motor.inertia)

    def torque(self, current: float, q: float, qd: float) -> float:
        """Advance friction by one substep and return A (Nm)."""
        return self._driven(current, q, qd)

    def advance(self, qdd: float) -> None:
        """Take note of the link's acceleration (rad/s^2) in this substep."""
        self.load = self.drive - self.armature * qdd


class ElasticDrive(_Drive):
    """A drive whose gear winds up, with a dead zone of +-gap (rad) if there is backlash.

    angle, speed: of the motor, where the encoder sits. gear: stiffness (Nm/rad), damping (Nm s/rad), gap.
    dt: substep (s). implicit: alpha.
    """

    __slots__ = ("_coupling", "_dt", "_gap", "_inertia", "_oil", "_stiffness", "_torque", "angle", "speed")

    def __init__(self, motor: Motor, gear: tuple[float, float, float], dt: float, implicit: float) -> None:
        self._inertia, self._dt = motor.inertia, dt
        self._stiffness, damping, self._gap = gear
        self._coupling = damping + implicit * self._stiffness * dt
        self._oil = OIL * damping
        self.angle = self.speed = 0.0
        c = self._coupling * dt
        super().__init__(motor, c / (1.0 + c / motor.inertia))

    def place(self, angle: float, load: float) -> float:
        """Start at rest, the motor at an angle (rad), carrying `load` (Nm); return the link's angle (rad)."""
        self.angle, self.speed, self.load = angle, 0.0, load
        return angle - load / self._stiffness - (copysign(self._gap, load) if self._gap else 0.0)

    def torque(self, current: float, q: float, qd: float) -> float:
        """Advance friction by one substep, set `armature`, and return A (Nm)."""
        drive = self._driven(current, self.angle, self.speed)
        wound, slip = self.angle - q, self.speed - qd
        if self._gap:
            wound = 0.0 if abs(wound) <= self._gap else wound - copysign(self._gap, wound)
        coupling, start = self._coupling, self._stiffness * wound + self._coupling * slip
        if self._gap and start * wound <= 0.0:  # flanks apart, or coming apart: teeth push, they do not pull
            coupling, start = self._oil, self._oil * slip
        c = coupling * self._dt
        yielding = 1.0 + c / self._inertia
        self.armature = c / yielding
        self._torque = (start + c * drive / self._inertia) / yielding
        return self._torque

    def advance(self, qdd: float) -> None:
        """Move the rotor on, given the link's acceleration (rad/s^2) in this substep."""
        self.load = self._torque - self.armature * qdd
        self.speed += self._dt * (self.drive - self.load) / self._inertia
        self.angle += self._dt * self.speed
