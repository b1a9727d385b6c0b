"""From a plant to the drives of one arm: every effect that is on becomes a term at its place."""

from collections.abc import Callable, Iterable
from math import cos, exp, pi, sin, sqrt
from random import Random
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from ..errors import InputError
from ..robots import Robot
from .drive import Amplify, Disturbance, ElasticDrive, Motor, RigidDrive
from .effects import (
    Amplifier,
    LoadDependentFriction,
    LoadedCogging,
    LooseCable,
    NonlinearViscous,
    OnJoint,
    Payload,
    PositionDependentFriction,
    SlippingBrake,
    Stribeck,
    TemperatureDependentFriction,
    ToothDefect,
    TorqueRipple,
)
from .friction import Bristle, Curve, Dahl, Drag, Friction, Level, Stick, within
from .model import Build, RigidBody, impossible, link_body, symmetric, tilted_gravity
from .plant import Plant

Array = npt.NDArray[np.float64]
Drive = RigidDrive | ElasticDrive
Clock = Callable[[], float]
Effect = TypeVar("Effect", bound=OnJoint)

# Four elements of one Maxwell-slip bristle: (share of the level, share of the travel at which it slides).
MAXWELL = ((0.35, 0.08), (0.3, 0.25), (0.2, 0.55), (0.15, 1.0))
SMALLEST_LEVEL = 0.5  # Nm; gives the bristle a stiffness where the healthy joint has no friction
STIFF = 0.5  # (natural frequency x step) above which a gear is taken by implicit Euler


def check_joints(robot: Robot, plant: Plant) -> None:
    """Raise InputError when the plant names a joint or link that the robot does not have."""
    n = len(robot.joint)
    for group in (plant, plant.outside):
        for name in type(group).model_fields:
            entries = getattr(group, name)
            for entry in entries if isinstance(entries, tuple) else ():
                number = getattr(entry, "joint", getattr(entry, "link", None)) or 1
                if number > n:
                    raise InputError(
                        f"plant: {name}: joint or link {number}, but {robot.name} has {n}; give 1..{n}"
                    )


def build_of(robot: Robot, plant: Plant, loaded: bool) -> Build:
    """Return the rigid body as it is, with or without the payload."""
    links: dict[int, RigidBody] = {}
    for change in plant.link_inertial:
        old = links.get(change.link) or link_body(robot, change.link)
        mass, inertia = old.mass + change.mass, old.inertia + symmetric(change.inertia)
        if mass <= 0.0 or (problem := impossible(inertia)):
            why = f"its mass becomes {mass:.4g} kg" if mass <= 0.0 else problem
            raise InputError(f"plant: link_inertial: link {change.link}: {why}; give a smaller change")
        links[change.link] = RigidBody(mass, old.centre_of_mass + np.array(change.centre_of_mass), inertia)
    tilt = plant.base_tilt
    gravity = tilted_gravity(robot.gravity, tilt.roll, tilt.pitch) if tilt else None
    return Build(links, load_body(plant.payload) if loaded and plant.payload else None, gravity)


def load_body(payload: Payload) -> RigidBody:
    """Return the payload as a rigid body in the frame of the flange."""
    return RigidBody(payload.mass, np.array(payload.centre_of_mass), symmetric(payload.inertia))


def make_drives(
    robot: Robot, plant: Plant, curves: list[Curve], links: Array, dt: float, seed: int, clock: Clock
) -> list[Drive]:
    """Return the N drives.

    links: least inertia (N,) that a gear may have to turn (kg m^2). dt: substep (s). clock: returns
    simulated time (s).
    """
    drives: list[Drive] = []
    for k, joint in enumerate(robot.joint):
        number, random = k + 1, Random(f"{seed} {k}")
        gain, rotor = joint.drive_gain, joint.reflected_inertia
        for error in _on(plant.drive_gain, number):
            gain *= 1.0 + error.error
        for rotor_change in _on(plant.rotor_inertia, number):
            rotor *= 1.0 + rotor_change.share
        friction = _friction(plant, number, curves[k], dt, clock)
        friction.start(random.uniform(-0.6, 0.6))  # where it came to rest before
        disturbances = _disturbances(plant, number, joint.gear, dt, random)
        amplify = _amplify(_on(plant.outside.amplifier, number))
        motor, gear = Motor(gain, rotor, friction, disturbances, amplify), _gear(plant, number)
        if gear is None:
            drives.append(RigidDrive(motor))
        else:
            fast = dt * sqrt(gear[0] * (1.0 / rotor + 1.0 / float(links[k]))) > STIFF
            drives.append(ElasticDrive(motor, gear, dt, float(fast)))
    return drives


def springs(plant: Plant) -> list[tuple[int, float, float, float]]:
    """Return cable springs as (joint 0.., stiffness, rest, constant)."""
    return [(c.joint - 1, c.stiffness, c.rest, c.constant) for c in plant.cable_spring]


def heat_factors(plant: Plant) -> list[tuple[int, Callable[[float], tuple[float, float]]]]:
    """Return (joint 0.., deg C -> factors on Coulomb and viscous friction) where temperature matters."""
    return [(effect.joint - 1, _factors(effect)) for effect in plant.temperature_dependent_friction]


def _factors(e: TemperatureDependentFriction) -> Callable[[float], tuple[float, float]]:
    if e.shape == "exponential":
        return lambda t: (exp(e.coulomb * (t - e.reference)), exp(e.viscous * (t - e.reference)))
    return lambda t: (
        max(1.0 + e.coulomb * (t - e.reference), 0.0),
        max(1.0 + e.viscous * (t - e.reference), 0.0),
    )


def _on(effects: Iterable[Effect], number: int) -> list[Effect]:
    return [effect for effect in effects if effect.joint == number]


def _friction(plant: Plant, number: int, curve: Curve, dt: float, clock: Clock) -> Friction:
    up, down = curve.high, -curve.low
    for coulomb in _on(plant.coulomb_friction, number):
        up, down = up + coulomb.torque, down + coulomb.torque
    for asymmetry in _on(plant.friction_asymmetry, number):
        up, down = up + asymmetry.torque, down - asymmetry.torque
    level = max(0.5 * (up + down), SMALLEST_LEVEL)
    bristle: Bristle | Stick | Dahl = Stick(level, plant.friction.travel)
    for presliding in _on(plant.presliding_hysteresis, number):
        if presliding.law == "dahl":
            bristle = Dahl(presliding.travel)
        else:
            bristle = Bristle(level, tuple((share, part * presliding.travel) for share, part in MAXWELL))
    lag = sum(effect.lag for effect in _on(plant.velocity_lag, number))
    viscous = sum(effect.damping for effect in _on(plant.viscous_friction, number))
    shapes = _on(plant.nonlinear_viscous, number)

    def extra(speed: Array) -> Array:
        return viscous * speed + sum((_shape(shape, speed) for shape in shapes), np.zeros(len(speed)))

    friction = Friction(Drag(curve, extra), up, down, bristle, dt, lag)
    friction.levels.extend(_levels(plant, number, clock))
    return friction


def _shape(effect: NonlinearViscous, speed: Array) -> Array:
    c, size = effect.coefficient, np.abs(speed)
    if effect.shape == "quadratic":
        return c * speed * size
    if effect.shape == "cubic":
        return c * speed**3
    if effect.shape == "power":
        return c * np.sign(speed) * size**effect.exponent
    return c * np.tanh(speed / effect.speed)


def _levels(plant: Plant, number: int, clock: Clock) -> list[Level]:
    """Return what adds to the Coulomb level of a joint, as functions of (q, qd, gear torque)."""
    outside = plant.outside
    levels = [_stribeck(effect) for effect in _on(plant.stribeck, number)]
    levels += [_loaded(effect) for effect in _on(plant.load_dependent_friction, number)]
    levels += [_placed(effect) for effect in _on(plant.position_dependent_friction, number)]
    levels += [_tooth(effect) for effect in _on(outside.tooth_defect, number)]
    levels += [_brake(effect, clock) for effect in _on(outside.slipping_brake, number)]
    return levels


def _stribeck(e: Stribeck) -> Level:
    return lambda _q, qd, _load: e.torque * exp(-((abs(qd) / e.speed) ** e.exponent))


def _loaded(e: LoadDependentFriction) -> Level:
    return lambda _q, _qd, load: e.coefficient * abs(load)


def _placed(e: PositionDependentFriction) -> Level:
    return lambda q, _qd, _load: e.sine * sin(e.order * q) + e.cosine * cos(e.order * q)


def _tooth(e: ToothDefect) -> Level:
    return lambda q, _qd, _load: e.torque * exp(-((_wrapped(q - e.at) / e.width) ** 2))


def _brake(e: SlippingBrake, clock: Clock) -> Level:
    drags, judder = within(e.intervals), 2.0 * pi * e.judder

    def level(_q: float, _qd: float, _load: float) -> float:
        time = clock()
        return e.torque * (0.75 + 0.25 * sin(judder * time)) if drags(time) else 0.0

    return level


def _wrapped(angle: float) -> float:
    return (angle + pi) % (2.0 * pi) - pi


def _disturbances(plant: Plant, number: int, gear: float, dt: float, random: Random) -> list[Disturbance]:
    """Return torques on the motor that are not friction."""
    outside = plant.outside
    terms = [_ripple(effect, gear) for effect in _on(plant.torque_ripple, number)]
    terms += [_cogging(effect, gear) for effect in _on(outside.loaded_cogging, number)]
    terms += [_crackle(effect, dt, random) for effect in _on(outside.loose_cable, number)]
    return terms


def _ripple(e: TorqueRipple, gear: float) -> Disturbance:
    order = e.order * gear
    return lambda q, _qd, _load: e.torque * cos(order * q + e.phase)


def _cogging(e: LoadedCogging, gear: float) -> Disturbance:
    order = e.order * gear
    return lambda q, _qd, load: e.coefficient * abs(load) * cos(order * q + e.phase)


def _crackle(e: LooseCable, dt: float, random: Random) -> Disturbance:
    """Return noise of some rms, low-passed at about 30 Hz, that is there near one angle only."""
    keep = exp(-2.0 * pi * 30.0 * dt)
    fresh, state = e.torque * sqrt(1.0 - keep * keep), [0.0]

    def term(q: float, _qd: float, _load: float) -> float:
        state[0] = keep * state[0] + fresh * random.gauss(0.0, 1.0)
        return state[0] if abs(_wrapped(q - e.at)) < e.width else 0.0

    return term


def _amplify(effects: list[Amplifier]) -> Amplify | None:
    if not effects:
        return None
    dead = sum(effect.deadband for effect in effects)
    return lambda i: i - dead if i > dead else (i + dead if i < -dead else 0.0)


def _gear(plant: Plant, number: int) -> tuple[float, float, float] | None:
    """Return (stiffness, damping, gap) of a gear that yields."""
    for e in _on(plant.joint_elasticity, number):
        return e.stiffness, e.damping, 0.0
    for b in _on(plant.backlash, number):
        return b.stiffness, b.damping, b.gap
    return None
