"""Effects of gears, and those outside the catalogue, as they are drawn for a case."""

import numpy as np

from ..virtual.effects import (
    Amplifier,
    Backlash,
    JointElasticity,
    LoadedCogging,
    LooseCable,
    SlippingBrake,
    ToothDefect,
    TorqueRipple,
)
from .scene import Drawn, Fields, Scene


def joint_elasticity(scene: Scene) -> Drawn:
    """Draw a gear that winds up; its size is the compliance in rad/Nm."""
    joint, damping = scene.joint(), float(scene.rng.uniform(5.0, 20.0))
    return Drawn(
        "joint_elasticity", (joint,), 1.0 / 12e3, 1.0 / 80e3, 1.0 / 1.5e3,
        lambda c, _k: {
            "joint_elasticity": (JointElasticity(joint=joint, stiffness=1.0 / c, damping=damping),)
        },
        lambda c: {"stiffness": 1.0 / c, "damping": damping},
    )  # fmt: skip


def backlash(scene: Scene) -> Drawn:
    """Draw a dead zone; its size is half its width in rad.

    The gear winds up behind the gap, so that its elasticity is there as well.
    """
    joint, stiffness = scene.joint(), float(scene.rng.uniform(1.0e4, 3.0e4))
    return Drawn(
        "backlash", (joint,), 1.0e-3, 5.0e-5, 1.0e-2,
        lambda gap, _k: {"backlash": (Backlash(joint=joint, gap=gap, stiffness=stiffness),)},
        lambda gap: {"gap": gap, "stiffness": stiffness},
        notes={"also": ["joint_elasticity"]},
    )  # fmt: skip


def torque_ripple(scene: Scene) -> Drawn:
    """Draw one or two harmonics of the motor's turn."""
    joint, rng = scene.joint(), scene.rng
    count = int(rng.integers(1, 3))
    orders = [float(k) for k in rng.choice([1.0, 2.0, 4.0], count, replace=False)]
    parts, phases = [1.0, float(rng.uniform(0.3, 0.8))][:count], rng.uniform(-np.pi, np.pi, count)

    def build(torque: float, _k: int) -> Fields:
        waves = zip(parts, orders, phases, strict=True)
        return {
            "torque_ripple": tuple(
                TorqueRipple(joint=joint, torque=torque * a, order=n, phase=float(p)) for a, n, p in waves
            )
        }

    return Drawn(
        "torque_ripple", (joint,), 0.3, 0.01, 1.2, build,
        lambda torque: {"torque": [torque * a for a in parts], "order": orders},
    )  # fmt: skip


def tooth_defect(scene: Scene) -> Drawn:
    """Draw a bad tooth where the joint passes."""
    return _near_an_angle(scene, "tooth_defect", ToothDefect, (0.02, 0.06), (0.7, 0.02, 4.0))


def loose_cable(scene: Scene) -> Drawn:
    """Draw noise over a part of the joint's way."""
    return _near_an_angle(scene, "loose_cable", LooseCable, (0.2, 0.5), (0.3, 0.01, 2.0))


def _near_an_angle(
    scene: Scene,
    name: str,
    effect: type[ToothDefect] | type[LooseCable],
    widths: tuple[float, float],
    sizes: tuple[float, float, float],
) -> Drawn:
    """Draw what acts near an angle only.

    widths: least and greatest, rad. sizes: start, low and high, in the joint's usual Coulomb levels.
    """
    joint = scene.joint()
    at, width = scene.passed(joint), float(scene.rng.uniform(*widths))
    start, low, high = (size * scene.level(joint) for size in sizes)
    return Drawn(
        f"outside.{name}", (joint,), start, low, high,
        lambda torque, _k: {"outside": {name: (effect(joint=joint, torque=torque, at=at, width=width),)}},
        lambda torque: {"torque": torque, "at": at, "width": width},
    )  # fmt: skip


def amplifier(scene: Scene) -> Drawn:
    """Draw a dead band of the amplifier."""
    joint = scene.joint()
    gain = scene.robot.joint[joint - 1].drive_gain
    level = scene.level(joint)
    return Drawn(
        "outside.amplifier", (joint,), 0.1 * level / gain, 0.005 * level / gain, level / gain,
        lambda band, _k: {"outside": {"amplifier": (Amplifier(joint=joint, deadband=band),)}},
        lambda band: {"deadband": band},
    )  # fmt: skip


def loaded_cogging(scene: Scene) -> Drawn:
    """Draw cogging that grows with load, a few to the motor's turn or less."""
    joint, rng = scene.joint(), scene.rng
    order, phase = float(rng.choice([0.3, 0.5, 1.5, 3.0])), float(rng.uniform(-np.pi, np.pi))
    return Drawn(
        "outside.loaded_cogging", (joint,), 0.05, 0.002, 0.4,
        lambda c, _k: {
            "outside": {
                "loaded_cogging": (LoadedCogging(joint=joint, coefficient=c, order=order, phase=phase),)
            }
        },
        lambda c: {"coefficient": c, "order": order},
    )  # fmt: skip


def slipping_brake(scene: Scene) -> Drawn:
    """Draw a brake that drags now and then in one recording."""
    joint, rng = scene.joint(), scene.rng
    chosen = int(rng.integers(len(scene.motions)))
    count = int(rng.integers(1, 4))
    starts = np.sort(rng.uniform(0.5, scene.motions[chosen].duration - 5.0, count))
    spans = tuple((float(a), float(a + rng.uniform(1.5, 6.0))) for a in starts)
    judder, level = float(rng.uniform(3.0, 9.0)), scene.level(joint)

    def build(torque: float, k: int) -> Fields:
        brake = SlippingBrake(joint=joint, torque=torque, intervals=spans, judder=judder)
        return {"outside": {"slipping_brake": (brake,)}} if k == chosen else {}

    return Drawn(
        "outside.slipping_brake", (joint,), 0.3 * level, 0.01 * level, 3.0 * level, build,
        lambda torque: {"torque": torque, "recording": chosen + 1, "intervals": [list(s) for s in spans]},
        episodic=True,
    )  # fmt: skip
