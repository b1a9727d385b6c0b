"""What is hidden in foreign robots: each effect drawn at random, within the plausible sizes of the catalogue."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from residuum.robots import Robot
from residuum.virtual.model import RigidBody, link_body, tilted_gravity

from .arm import Change, Gear, Healthy, State

Array = NDArray[np.float64]

#: Nm; a torque that matters on each joint.
LARGE = np.array([1.0, 1.0, 1.0, 0.25, 0.25, 0.25])


@dataclass(frozen=True)
class Scene:
    """What an effect is drawn for; joint: 0-based."""

    rng: np.random.Generator
    robot: Robot
    healthy: Healthy
    joint: int

    @property
    def sign(self) -> float:
        """Plus or minus one."""
        return float(self.rng.choice([-1.0, 1.0]))

    def only(self, value: float, else_: float = 0.0) -> Array:
        """Return a value for the joint alone, (6,)."""
        return np.where(np.arange(6) == self.joint, value, else_)

    def on_joint(self, effect: str, parameters: dict[str, float], **parts: object) -> Change:
        """Return a change of this joint."""
        return Change(effect, (self.joint + 1,), parameters, **parts)


def payload(s: Scene) -> Change:
    """A load, held all the time or twice."""
    mass, centre = s.rng.uniform(0.3, 3.0), s.rng.uniform([-0.05, -0.05, 0.01], [0.05, 0.05, 0.11])
    held = ((0.15, 0.35), (0.5, 0.8)) if s.rng.random() < 0.5 else None
    load = RigidBody(mass, centre, np.diag([1.0, 1.1, 1.2]) * 0.002 * mass)
    return Change(
        "payload", parameters={"mass": mass, "centre_of_mass": centre.tolist()}, load=load, held=held
    )


def link_inertial(s: Scene) -> Change:
    """Something that was bolted on a link."""
    link, mass, at = int(s.rng.integers(2, 6)), s.rng.uniform(0.2, 0.8), s.rng.uniform(-0.1, 0.1, 3)
    body = link_body(s.robot, link)
    whole = body.mass + mass
    centre = (body.mass * body.centre_of_mass + mass * at) / whole
    new = RigidBody(whole, centre, body.inertia + 0.003 * mass * np.eye(3))
    return Change("link_inertial", (link,), {"mass": mass}, links={link: new})


def base_tilt(s: Scene) -> Change:
    """A base that is not level."""
    way, size = s.rng.uniform(0, 2 * np.pi), np.radians(s.rng.uniform(0.7, 4.0))
    tilt = {"roll": size * np.cos(way), "pitch": size * np.sin(way)}
    return Change("base_tilt", (), tilt, gravity=tilted_gravity(s.robot.gravity, **tilt))


def rotor_inertia(s: Scene) -> Change:
    """A heavier rotor, or a brake's disc."""
    share = s.rng.uniform(0.15, 0.5)
    return s.on_joint("rotor_inertia", {"share": share}, rotor=1 + s.only(share))


def offset(s: Scene) -> Change:
    """A current's offset, at rest and in motion."""
    torque = s.sign * s.rng.uniform(0.2, 1.0) * LARGE[s.joint]
    return s.on_joint("current_offset", {"torque": torque}, drag=lambda *_: s.only(torque))


def cable_spring(s: Scene) -> Change:
    """A cable that pulls."""
    k, rest = s.rng.uniform(0.2, 1.5) * LARGE[s.joint], s.rng.uniform(-1, 1)
    return s.on_joint("cable_spring", {"stiffness": k}, drag=lambda q, *_: s.only(k) * (q - rest))


def encoder_offset(s: Scene) -> Change:
    """A wrong zero, of a joint that gravity acts on."""
    s = replace(s, joint=int(s.rng.integers(1, 4)))
    angle = s.sign * np.radians(s.rng.uniform(0.4, 2.0))
    return s.on_joint("encoder_offset", {"offset": angle}, encoder=s.only(angle))


def stribeck(s: Scene) -> Change:
    """More friction at low speed."""
    more, speed = s.rng.uniform(0.15, 0.5) * s.healthy.dry[s.joint], s.rng.uniform(0.04, 0.2)
    bump: State = lambda _q, qd, *_: s.only(more) * np.exp(-((qd / speed) ** 2))  # noqa: E731
    return s.on_joint("stribeck", {"torque": more, "speed": speed}, dry=bump)


def nonlinear_viscous(s: Scene) -> Change:
    """Drag that grows faster than speed."""
    size, power = s.rng.uniform(1.0, 3.0) * LARGE[s.joint], int(s.rng.integers(2, 4))
    bent: State = lambda _q, qd, *_: s.only(size) * np.sign(qd) * np.abs(qd) ** power  # noqa: E731
    return s.on_joint("nonlinear_viscous", {"size": size, "power": power}, drag=bent)


def load_dependent_friction(s: Scene) -> Change:
    """Friction that grows with what the shoulder or the elbow carries."""
    s = replace(s, joint=int(s.rng.integers(1, 3)))
    mu = s.rng.uniform(0.03, 0.12)
    return s.on_joint(
        "load_dependent_friction", {"mu": mu}, dry=lambda _q, _qd, load, _hot: s.only(mu) * np.abs(load)
    )


def temperature_dependent_friction(s: Scene) -> Change:
    """Friction that falls as the gear warms."""
    fall, j = s.rng.uniform(0.01, 0.025), s.joint
    part: State = lambda _q, _qd, _load, hot: -fall * (hot - 30.0)  # noqa: E731
    return s.on_joint(
        "temperature_dependent_friction", {"coefficient": -fall},
        dry=lambda *x: s.only(s.healthy.dry[j]) * part(*x),
        drag=lambda q, qd, *x: s.only(s.healthy.damping[j]) * part(q, qd, *x) * qd,
    )  # fmt: skip


def position_dependent_friction(s: Scene) -> Change:
    """Friction that waves over the angle."""
    size, waves = s.rng.uniform(0.15, 0.4) * s.healthy.dry[s.joint], int(s.rng.integers(1, 3))
    phase = s.rng.uniform(0, 2 * np.pi)
    wave: State = lambda q, *_: s.only(size) * np.sin(waves * q + phase)  # noqa: E731
    return s.on_joint("position_dependent_friction", {"amplitude": size, "waves": waves}, dry=wave)


def torque_ripple(s: Scene) -> Change:
    """One, two or four waves a turn of the motor."""
    size, order = s.rng.uniform(0.15, 0.5) * LARGE[s.joint], int(s.rng.choice([1, 2, 4]))
    phase, gear = s.rng.uniform(0, 2 * np.pi), s.robot.joint[s.joint].gear
    wave: State = lambda q, *_: s.only(size) * np.cos(order * gear * q + phase)  # noqa: E731
    return s.on_joint("torque_ripple", {"amplitude": size, "order": order}, drag=wave)


def time_delay(s: Scene) -> Change:
    """Currents that are recorded late."""
    delay = 0.002 * int(s.rng.integers(3, 11))
    return Change("time_delay", (), {"delay": delay}, delay=delay)


def external_contact(s: Scene) -> Change:
    """Three pushes at one place on a link beyond the elbow."""
    force = s.rng.standard_normal(3)
    force *= s.rng.uniform(5, 60) / np.linalg.norm(force)
    starts, lasts = np.sort(s.rng.uniform(0.1, 0.85, 3)), s.rng.uniform(0.01, 0.06)

    def at(share: float) -> Array | None:
        inside = [(share - t) / lasts for t in starts if 0 <= share - t < lasts]
        return force * min(1.0, 6 * min(inside[0], 1 - inside[0])) if inside else None

    place = int(s.rng.integers(3, 7)), s.rng.uniform(-0.1, 0.1, 3)
    return Change("external_contact", (), {"force": float(np.linalg.norm(force))}, push=place, force=at)


def drive_gain(s: Scene) -> Change:
    """A current that makes more or less torque than before."""
    error = s.sign * s.rng.uniform(0.05, 0.2)
    return s.on_joint("drive_gain", {"error": error}, gain=1 + s.only(error))


def coulomb_friction(s: Scene) -> Change:
    """More dry friction."""
    more = s.rng.uniform(0.15, 0.5) * s.healthy.dry[s.joint]
    return s.on_joint("coulomb_friction", {"torque": more}, dry=lambda *_: s.only(more))


def viscous_friction(s: Scene) -> Change:
    """More drag."""
    more = s.rng.uniform(0.15, 0.5) * s.healthy.damping[s.joint]
    return s.on_joint("viscous_friction", {"damping": more}, drag=lambda _q, qd, *_: s.only(more) * qd)


def joint_elasticity(s: Scene) -> Change:
    """A gear that winds up."""
    s = replace(s, joint=int(s.rng.integers(0, 4)))
    stiffness = float(np.exp(s.rng.uniform(np.log(3e3), np.log(2e4)))) * (1.0 if s.joint < 3 else 0.15)
    return s.on_joint("joint_elasticity", {"stiffness": stiffness}, gear=Gear(stiffness=stiffness))


def backlash(s: Scene) -> Change:
    """A gear with slack."""
    gap = s.rng.uniform(5e-4, 4e-3)
    return s.on_joint("backlash", {"gap": 2 * gap}, gear=Gear(gap=gap))


def presliding(s: Scene) -> Change:
    """Friction that builds up over a travel."""
    bristle = s.rng.uniform(0.005, 0.03)
    return s.on_joint("presliding_hysteresis", {"zs": bristle}, gear=Gear(bristle=bristle))


def velocity_lag(s: Scene) -> Change:
    """Friction whose sign is late."""
    late = s.rng.uniform(0.006, 0.02)
    return s.on_joint("velocity_lag", {"lag": late}, gear=Gear(late=late))


def step(s: Scene) -> Change:
    """An offset that begins during the recording."""
    torque = s.sign * s.rng.uniform(0.4, 1.0) * LARGE[s.joint]
    return s.on_joint(
        "outside.step", {"torque": torque},
        later=lambda time, *_: np.outer(time > 0.4 * time[-1], s.only(torque)),
    )  # fmt: skip


def neighbour(s: Scene) -> Change:
    """A torque that follows another joint's angle."""
    torque, other = s.sign * s.rng.uniform(0.4, 1.2) * LARGE[s.joint], (s.joint + 1) % 6
    return s.on_joint(
        "outside.neighbour", {"torque": torque},
        later=lambda _time, q, _sign: np.outer(np.sin(6 * q[:, other]), s.only(torque)),
    )  # fmt: skip


def breathing(s: Scene) -> Change:
    """Friction that swells and falls every eleven seconds."""
    torque = s.rng.uniform(0.1, 0.3) * s.healthy.dry[s.joint]
    return s.on_joint(
        "outside.breathing", {"torque": torque},
        later=lambda time, _q, sign: s.only(torque) * sign * np.sin(2 * np.pi * time / 11)[:, None],
    )  # fmt: skip


#: Those that need no reference, and those that do.
ALWAYS: tuple[Callable[[Scene], Change], ...] = (
    payload, link_inertial, base_tilt, rotor_inertia, offset, cable_spring, encoder_offset, stribeck,
    nonlinear_viscous, load_dependent_friction, temperature_dependent_friction, position_dependent_friction,
    torque_ripple, time_delay, external_contact,
)  # fmt: skip
REFERENCE: tuple[Callable[[Scene], Change], ...] = (drive_gain, coulomb_friction, viscous_friction)
#: What only a motion that is given can have (inverse.py), and what no catalogue has.
GIVEN: tuple[Callable[[Scene], Change], ...] = (joint_elasticity, backlash, presliding, velocity_lag)
OUTSIDE: tuple[Callable[[Scene], Change], ...] = (step, neighbour, breathing)
