"""What a controller may ask of the arm for the next 2 ms."""

from dataclasses import dataclass

Joints = tuple[float, ...]


@dataclass(frozen=True)
class Position:
    """Follow: angles q (rad), speeds qd (rad/s), accelerations qdd (rad/s^2), each (N,), as servoj would."""

    q: Joints
    qd: Joints
    qdd: Joints


@dataclass(frozen=True)
class Speed:
    """Ramp every joint to speed qd (N,) (rad/s) at `acceleration` (rad/s^2), as speedj.

    torque: (N,) Nm beside the feed-forward that the drive may use at most; None: all it has.
    """

    qd: Joints
    acceleration: float
    torque: Joints | None = None


@dataclass(frozen=True)
class Stop:
    """Ramp every joint to rest at `deceleration` (rad/s^2) and hold it there, as stopj."""

    deceleration: float = 10.0


@dataclass(frozen=True)
class Freedrive:
    """Carry gravity and most of friction, and leave the rest to whoever pushes.

    coulomb, viscous: parts of the nominal friction that are compensated (the defaults of UR's direct_torque);
    damping: drag per rotor inertia that brakes free motion (1/s).
    """

    coulomb: float = 0.8
    viscous: float = 0.9
    damping: float = 4.0


@dataclass(frozen=True)
class Torque:
    """Give these joint torques (N,) (Nm, with nominal drive gains) and nothing else. No compensation."""

    torque: Joints


Command = Position | Speed | Stop | Freedrive | Torque
