"""Effects on masses, gravity, sensors and by the surroundings, as they are drawn for a case."""

from math import cos, radians, sin
from typing import Any

import numpy as np

from ..virtual.effects import (
    BaseTilt,
    CableSpring,
    CurrentOffset,
    DriveGain,
    EncoderOffset,
    LinkInertial,
    Payload,
    RotorInertia,
    TimeDelay,
)
from ..virtual.model import impossible, symmetric
from ..virtual.surroundings import Contact
from .healthy import LINK_SPREAD
from .scene import Drawn, Fields, Scene

LUMPS = (0.02, 0.04, 0.08, 0.12, 0.16, 0.2, 0.25)  # shares of a link's mass


def payload(scene: Scene) -> Drawn:
    """Draw a load at the flange; where a motion grips, half of the time only while it grips."""
    x, y = scene.rng.uniform(-0.06, 0.06, 2)
    centre = (float(x), float(y), float(scene.rng.uniform(0.0, 0.12)))
    radius = scene.rng.uniform(0.02, 0.07)
    gripping = any(m.grips for m in scene.motions) and bool(scene.rng.random() < 0.5)

    def build(mass: float, k: int) -> Fields:
        own = 0.4 * mass * radius**2
        load = Payload(mass=mass, centre_of_mass=centre, inertia=(own, own, own, 0.0, 0.0, 0.0))
        if not gripping:
            return {"payload": load}
        grips = scene.motions[k].grips
        return {"payload": load.model_copy(update={"intervals": grips})} if grips else {}

    intervals = [list(m.grips) for m in scene.motions] if gripping else []
    return Drawn(
        "payload", (), 1.0, 0.1, 5.0, build,
        lambda mass: {"mass": mass, "centre_of_mass": list(centre), "intervals": intervals},
        episodic=gripping,
    )  # fmt: skip


def link_inertial(scene: Scene) -> Drawn:
    """Draw a lump of a share of a link's mass, at a point near the link (taken away if negative)."""
    number, sign = int(scene.rng.integers(2, len(scene.robot.joint) + 1)), scene.sign()
    joint = scene.robot.joint[number - 1]
    centre = np.array(joint.centre_of_mass)
    way = scene.rng.uniform(-1.0, 1.0, 3) * (0.03 + 0.5 * np.abs(centre))

    def lump(share: float) -> tuple[float, Any, Any]:
        mass = sign * share * joint.mass
        together = joint.mass + mass
        reduced = joint.mass * mass / together
        tensor = reduced * (way @ way * np.eye(3) - np.outer(way, way))
        return mass, mass / together * way, tensor

    def build(share: float, _k: int) -> Fields:
        mass, shift, t = lump(share)
        x, y, z = (float(v) for v in shift)
        xx, yy, zz, xy, xz, yz = (float(t[i, j]) for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))
        added = LinkInertial(
            link=number, mass=mass, centre_of_mass=(x, y, z), inertia=(xx, yy, zz, xy, xz, yz)
        )
        return {"link_inertial": (added,)}

    def truth(share: float) -> dict[str, Any]:
        return {"link": number, "mass": lump(share)[0], "at": [float(v) for v in centre + way]}

    own = (1.0 - 2.0 * LINK_SPREAD) * symmetric(joint.inertia)
    shares = [s for s in LUMPS if impossible(own + lump(s)[2]) is None]
    if not shares:  # no such mass can be taken away there
        sign, shares = 1.0, list(LUMPS)
    return Drawn("link_inertial", (), min(0.08, shares[-1]), LUMPS[0], shares[-1], build, truth)


def base_tilt(scene: Scene) -> Drawn:
    """Draw a turn of the base about a level axis."""
    axis = scene.rng.uniform(0.0, 2.0 * np.pi)

    def truth(angle: float) -> dict[str, float]:
        return {"roll": angle * cos(axis), "pitch": angle * sin(axis), "angle": angle}

    def build(angle: float, _k: int) -> Fields:
        return {"base_tilt": BaseTilt(roll=angle * cos(axis), pitch=angle * sin(axis))}

    return Drawn("base_tilt", (), radians(2.0), radians(0.1), radians(10.0), build, truth)


def rotor_inertia(scene: Scene) -> Drawn:
    """Draw a rotor that is heavier or lighter by a share."""
    joint, sign = scene.joint(), scene.sign()
    own = scene.robot.joint[joint - 1].reflected_inertia
    return Drawn(
        "rotor_inertia", (joint,), 0.2, 0.02, 1.0 if sign > 0 else 0.8,
        lambda share, _k: {"rotor_inertia": (RotorInertia(joint=joint, share=sign * share),)},
        lambda share: {"share": sign * share, "inertia": sign * share * own},
    )  # fmt: skip


def drive_gain(scene: Scene) -> Drawn:
    """Draw an error of the drive gain."""
    joint, sign = scene.joint(), scene.sign()
    return Drawn(
        "drive_gain", (joint,), 0.1, 0.01, 0.5,
        lambda error, _k: {"drive_gain": (DriveGain(joint=joint, error=sign * error),)},
        lambda error: {"error": sign * error},
    )  # fmt: skip


def current_offset(scene: Scene) -> Drawn:
    """Draw an offset of the measured current."""
    joint, sign = scene.joint(), scene.sign()
    gain = scene.robot.joint[joint - 1].drive_gain
    return Drawn(
        "current_offset", (joint,), 0.1 * scene.level(joint), 0.003, 2.0,
        lambda torque, _k: {"current_offset": (CurrentOffset(joint=joint, offset=sign * torque / gain),)},
        lambda torque: {"torque": sign * torque, "offset": sign * torque / gain},
    )  # fmt: skip


def cable_spring(scene: Scene) -> Drawn:
    """Draw a spring on a link, at rest near the middle of the motion."""
    joint = scene.joint()
    middle = float(np.mean([m.q[:, joint - 1].mean() for m in scene.motions]))
    rest = middle + float(scene.rng.uniform(-0.7, 0.7))
    return Drawn(
        "cable_spring", (joint,), 0.3, 0.005, 4.0,
        lambda k, _k: {"cable_spring": (CableSpring(joint=joint, stiffness=k, rest=rest),)},
        lambda k: {"stiffness": k, "rest": rest},
    )  # fmt: skip


def encoder_offset(scene: Scene) -> Drawn:
    """Draw an offset of an encoder."""
    joint, sign = scene.joint(), scene.sign()
    return Drawn(
        "encoder_offset", (joint,), radians(0.7), radians(0.05), radians(4.0),
        lambda angle, _k: {"encoder_offset": (EncoderOffset(joint=joint, offset=sign * angle),)},
        lambda angle: {"offset": sign * angle},
    )  # fmt: skip


def time_delay(scene: Scene) -> Drawn:
    """Draw a delay of the current's channel: on all joints, one time in five on one."""
    joints = (scene.joint(),) if scene.rng.random() < 0.2 else ()
    return Drawn(
        "time_delay", joints, 0.01, 0.001, 0.04,
        lambda delay, _k: {"time_delay": (TimeDelay(delay=delay, joints=joints),)},
        lambda delay: {"delay": delay},
    )  # fmt: skip


def external_contact(scene: Scene) -> Drawn:
    """Draw one to four pushes of 0.3-3 s in one recording, each with its own place and direction."""
    rng, chosen = scene.rng, int(scene.rng.integers(len(scene.motions)))
    count, duration = int(rng.integers(1, 5)), scene.motions[chosen].duration
    lengths, starts = rng.uniform(0.3, 3.0, count), np.sort(rng.uniform(1.0, duration - 4.0, count))
    ways, sizes = rng.standard_normal((count, 3)), rng.uniform(0.7, 1.3, count)
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    links = [int(rng.integers(3, len(scene.robot.joint) + 1)) for _ in range(count)]
    profiles = [("smooth", "hold")[int(rng.integers(2))] for _ in range(count)]

    def pushes(force: float) -> tuple[Contact, ...]:
        return tuple(
            Contact.model_validate(
                {
                    "start": float(start),
                    "end": float(start + length),
                    "force": tuple(float(v) for v in force * size * way),
                    "link": link,
                    "profile": profile,
                }
            )
            for start, length, size, way, link, profile in zip(
                starts, lengths, sizes, ways, links, profiles, strict=True
            )
        )

    spans = [[float(a), float(a + b)] for a, b in zip(starts, lengths, strict=True)]
    return Drawn(
        "external_contact", (), 20.0, 0.5, 200.0,
        lambda force, k: {"external_contact": pushes(force)} if k == chosen else {},
        lambda force: {"force": force, "recording": chosen + 1, "intervals": spans, "links": links},
        episodic=True,
    )  # fmt: skip
