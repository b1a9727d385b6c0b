"""Effects of friction, as they are drawn for a case. Sizes are bound by twice what is plausible."""

from typing import Literal

import numpy as np

from ..virtual.effects import (
    CoulombFriction,
    FrictionAsymmetry,
    LoadDependentFriction,
    NonlinearViscous,
    PositionDependentFriction,
    PreslidingHysteresis,
    Stribeck,
    TemperatureDependentFriction,
    VelocityLag,
    ViscousFriction,
)
from .scene import Drawn, Fields, Scene


def coulomb_friction(scene: Scene) -> Drawn:
    """Draw a change of the Coulomb level."""
    joint, sign = scene.joint(), scene.sign()
    level = scene.level(joint)
    return Drawn(
        "coulomb_friction", (joint,), 0.1 * level, 0.0, (1.0 if sign > 0 else 0.5) * level,
        lambda torque, _k: {"coulomb_friction": (CoulombFriction(joint=joint, torque=sign * torque),)},
        lambda torque: {"torque": sign * torque},
    )  # fmt: skip


def viscous_friction(scene: Scene) -> Drawn:
    """Draw a change of linear drag."""
    joint, sign = scene.joint(), scene.sign()
    slope = float(scene.usual.slope[joint - 1])
    return Drawn(
        "viscous_friction", (joint,), 0.2 * slope, 0.0, (1.5 if sign > 0 else 0.6) * slope,
        lambda damping, _k: {"viscous_friction": (ViscousFriction(joint=joint, damping=sign * damping),)},
        lambda damping: {"damping": sign * damping},
    )  # fmt: skip


def friction_asymmetry(scene: Scene) -> Drawn:
    """Draw a difference between the two directions' levels."""
    joint, sign = scene.joint(), scene.sign()
    level = scene.level(joint)
    return Drawn(
        "friction_asymmetry", (joint,), 0.1 * level, 0.003, min(2.0, 0.8 * level),
        lambda torque, _k: {"friction_asymmetry": (FrictionAsymmetry(joint=joint, torque=sign * torque),)},
        lambda torque: {"torque": sign * torque},
    )  # fmt: skip


def stribeck(scene: Scene) -> Drawn:
    """Draw stiction above the Coulomb level that fades with speed."""
    joint = scene.joint()
    speed = float(np.exp(scene.rng.uniform(np.log(0.02), np.log(0.3))))
    exponent = float(scene.rng.choice([1.0, 2.0]))
    level = scene.level(joint)
    return Drawn(
        "stribeck", (joint,), 0.3 * level, 0.0, 1.5 * level,
        lambda torque, _k: {
            "stribeck": (Stribeck(joint=joint, torque=torque, speed=speed, exponent=exponent),)
        },
        lambda torque: {"torque": torque, "speed": speed, "exponent": exponent},
    )  # fmt: skip


def nonlinear_viscous(scene: Scene) -> Drawn:
    """Draw drag of one of four shapes."""
    joint, sign, rng = scene.joint(), scene.sign(), scene.rng
    shapes: tuple[Literal["quadratic", "cubic", "power", "tanh"], ...] = (
        "quadratic", "cubic", "power", "tanh",
    )  # fmt: skip
    shape = shapes[int(rng.integers(4))]
    exponent, speed = float(rng.uniform(0.4, 0.75)), float(rng.uniform(0.3, 0.8))
    level = scene.level(joint)

    def build(c: float, _k: int) -> Fields:
        drag = NonlinearViscous(
            joint=joint, shape=shape, coefficient=sign * c, exponent=exponent, speed=speed
        )
        return {"nonlinear_viscous": (drag,)}

    return Drawn(
        "nonlinear_viscous", (joint,), 0.15 * level, 0.0, (1.2 if sign > 0 else 0.4) * level, build,
        lambda c: {"coefficient": sign * c, "exponent": exponent, "speed": speed},
        notes={"shape": shape},
    )  # fmt: skip


def load_dependent_friction(scene: Scene) -> Drawn:
    """Draw a Coulomb level that grows with load."""
    joint = scene.joint()
    return Drawn(
        "load_dependent_friction", (joint,), 0.05, 0.005, 0.3,
        lambda mu, _k: {"load_dependent_friction": (LoadDependentFriction(joint=joint, coefficient=mu),)},
        lambda mu: {"mu": mu},
    )  # fmt: skip


def temperature_dependent_friction(scene: Scene) -> Drawn:
    """Draw friction that falls as the joint warms, about a temperature of the recordings' range."""
    joint, rng = scene.joint(), scene.rng
    coulomb, viscous = float(rng.uniform(0.3, 1.0)), float(rng.uniform(0.3, 1.0))
    reference = float(rng.uniform(32.0, 40.0))
    shape: Literal["linear", "exponential"] = "linear" if rng.random() < 0.5 else "exponential"

    def build(rate: float, _k: int) -> Fields:
        heat = TemperatureDependentFriction(
            joint=joint, coulomb=-rate * coulomb, viscous=-rate * viscous, reference=reference, shape=shape
        )
        return {"temperature_dependent_friction": (heat,)}

    return Drawn(
        "temperature_dependent_friction", (joint,), 0.012, 0.002, 0.05, build,
        lambda rate: {"coulomb": -rate * coulomb, "viscous": -rate * viscous, "reference": reference},
        notes={"shape": shape},
    )  # fmt: skip


def presliding_hysteresis(scene: Scene) -> Drawn:
    """Draw a long way before friction has built up after a reversal."""
    joint = scene.joint()
    law: Literal["dahl", "maxwell"] = "dahl" if scene.rng.random() < 0.5 else "maxwell"
    return Drawn(
        "presliding_hysteresis", (joint,), 0.012, 0.002, 0.06,
        lambda travel, _k: {
            "presliding_hysteresis": (PreslidingHysteresis(joint=joint, travel=travel, law=law),)
        },
        lambda travel: {"travel": travel},
        notes={"law": law},
    )  # fmt: skip


def position_dependent_friction(scene: Scene) -> Drawn:
    """Draw a Coulomb level that goes up and down along the joint."""
    joint, phase = scene.joint(), scene.rng.uniform(0.0, 2.0 * np.pi)
    order = float(scene.rng.choice([1.0, 1.0, 2.0, 3.0]))
    sine, cosine = float(np.sin(phase)), float(np.cos(phase))
    level = scene.level(joint)

    def build(a: float, _k: int) -> Fields:
        wave = PositionDependentFriction(joint=joint, sine=a * sine, cosine=a * cosine, order=order)
        return {"position_dependent_friction": (wave,)}

    return Drawn(
        "position_dependent_friction", (joint,), 0.2 * level, 0.0, 0.8 * level, build,
        lambda a: {"sine": a * sine, "cosine": a * cosine, "order": order},
    )  # fmt: skip


def velocity_lag(scene: Scene) -> Drawn:
    """Draw friction that changes its direction late."""
    joint = scene.joint()
    return Drawn(
        "velocity_lag", (joint,), 0.01, 0.001, 0.04,
        lambda lag, _k: {"velocity_lag": (VelocityLag(joint=joint, lag=lag),)},
        lambda lag: {"lag": lag},
    )  # fmt: skip
