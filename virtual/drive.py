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
from math import copysign

from .friction import Friction

Disturbance = Callable[[float, float, float], float]  # (motor angle rad, speed rad/s, gear torque Nm) -> Nm
Amplify = Callable[[float], float]  # measured current A -> current that makes torque A


OIL = 0.1  # part of a gear's damping that is left while its flanks are apart


class RigidDrive:
    """A drive whose gear does not yield; motor and link move together (joint units throughout)."""

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

    def __init__(
        self,
        gain: float,
        inertia: float,
        friction: Friction,
        disturbances: list[Disturbance],
        amplify: Amplify | None,
    ) -> None:
        self._gain, self._friction, self._disturbances, self._amplify = gain, friction, disturbances, amplify
        self.armature = inertia
        self.load = 0.0  # what the gear transmits to the link, Nm
        self.motor = 0.0  # what the motor gives, Nm
        self.friction = 0.0  # what friction takes, Nm
        self.drive = 0.0  # motor less friction and with disturbances, Nm

    def torque(self, current: float, q: float, qd: float) -> float:
        """Advance friction by one substep and return A (Nm)."""
        self.motor = motor = self._gain * (self._amplify(current) if self._amplify else current)
        self.friction = friction = self._friction.torque(q, qd, self.load)
        torque = motor - friction
        for disturbance in self._disturbances:
            torque += disturbance(q, qd, self.load)
        self.drive = torque
        return torque

    def heat(self, coulomb: float, viscous: float) -> None:
        """Set the factors of temperature on Coulomb and viscous friction."""
        self._friction.coulomb_factor, self._friction.viscous_factor = coulomb, viscous

    def advance(self, qdd: float) -> None:
        """Take note of the link's acceleration (rad/s^2) in this substep."""
        self.load = self.drive - self.armature * qdd


class ElasticDrive:
    """A drive whose gear winds up, with a dead zone of +-gap (rad) if there is backlash.

    angle, speed: of the motor in joint units (the encoder sits there).
    """

    __slots__ = (
        "_amplify", "_coupling", "_disturbances", "_dt", "_friction", "_gain", "_gap", "_inertia",
        "_oil", "_stiffness", "_torque", "angle", "armature", "drive", "friction", "load", "motor", "speed",
    )  # fmt: skip

    def __init__(
        self,
        gain: float,
        inertia: float,
        friction: Friction,
        disturbances: list[Disturbance],
        amplify: Amplify | None,
        gear: tuple[float, float, float],
        dt: float,
        implicit: float,
    ) -> None:
        self._gain, self._friction, self._disturbances, self._amplify = gain, friction, disturbances, amplify
        self._inertia, self._dt = inertia, dt
        self._stiffness, damping, self._gap = gear
        self._coupling = damping + implicit * self._stiffness * dt
        self._oil = OIL * damping
        self.angle = self.speed = 0.0
        self.load = self.motor = self.friction = self.drive = 0.0
        c = self._coupling * dt
        self.armature = c / (1.0 + c / inertia)

    def place(self, angle: float, load: float) -> float:
        """Start at rest, the motor at an angle (rad), carrying `load` (Nm); return the link's angle (rad)."""
        self.angle, self.speed, self.load = angle, 0.0, load
        return angle - load / self._stiffness - (copysign(self._gap, load) if self._gap else 0.0)

    def torque(self, current: float, q: float, qd: float) -> float:
        """Advance friction by one substep, set `armature`, and return A (Nm)."""
        self.motor = motor = self._gain * (self._amplify(current) if self._amplify else current)
        self.friction = friction = self._friction.torque(self.angle, self.speed, self.load)
        drive = motor - friction
        for disturbance in self._disturbances:
            drive += disturbance(self.angle, self.speed, self.load)
        self.drive = drive
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

    def heat(self, coulomb: float, viscous: float) -> None:
        """Set the factors of temperature on Coulomb and viscous friction."""
        self._friction.coulomb_factor, self._friction.viscous_factor = coulomb, viscous

    def advance(self, qdd: float) -> None:
        """Move the rotor on, given the link's acceleration (rad/s^2) in this substep."""
        self.load = self._torque - self.armature * qdd
        self.speed += self._dt * (self.drive - self.load) / self._inertia
        self.angle += self._dt * self.speed
