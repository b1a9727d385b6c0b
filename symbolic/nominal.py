"""From a robot's data to the numbers of a model: base parameters of the published links."""

from collections.abc import Sequence

import numpy as np
import sympy as sp

from ..errors import InputError
from ..robots import Robot
from ..robots.model import Input, Model, ModelJoint, Value
from .arm import Arm, exact, exact_cos_sin, symbolic_arm
from .base_parameters import base_parameters, evaluate
from .energy import turned_frame
from .inertia import PARAMETER_UNITS, Inertia
from .thesis import PARAMETERS as THESIS_PARAMETERS


def robot_arm(robot: Robot | Model) -> Arm:
    """Return the symbolic arm of all joints that the data holds."""
    return symbolic_arm([(j.a, j.d, j.alpha, j.offset) for j in robot.joint], robot.gravity)


def link_inertias(robot: Robot) -> list[Inertia]:
    """Return the links' inertias in their turned frames, as exact numbers."""
    arm = robot_arm(robot)
    bodies = []
    for i, joint in enumerate(robot.joint):
        xx, yy, zz, xy, xz, yz = map(exact, joint.inertia)
        tensor = sp.Matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        centre = sp.Matrix([exact(x) for x in joint.centre_of_mass])
        turned = turned_frame(arm, i, Inertia.about_centre_of_mass(exact(joint.mass), centre, tensor))
        bodies.append(_numbers(turned, arm))
    return bodies


def with_wrist_locked(robot: Robot, dof: int, angles: Sequence[float]) -> list[Inertia]:
    """Return `dof` inertias: the links beyond are rigid at the given angles (rad), with their mass."""
    arm = robot_arm(robot)
    bodies = link_inertias(robot)
    for i in reversed(range(dof, len(bodies))):
        c, s = exact_cos_sin(angles[i - dof] + robot.joint[i].offset)
        turn = sp.Matrix([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        link = arm.links[i - 1]
        moved = bodies[i].moved(turn, sp.zeros(3, 1)).moved(link.twist, link.translation)
        bodies[i - 1] = _numbers(bodies[i - 1] + moved, arm)
    return bodies[:dof]


def nominal_model(
    robot: Robot,
    robot_hash: str,
    dof: int,
    locked_angles: Sequence[float] = (),
    variant: str = "full",
    wrist: str = "locked",
) -> Model:
    """Return the model of the published robot, no friction assumed.

    dof: 1..number of joints. locked_angles: rad, one a joint that is left out (default 0).
    wrist: "locked" keeps the mass of what is left out, "absent" drops it.
    Raises InputError when dof or the number of angles does not fit the robot.
    """
    if not 1 <= dof <= len(robot.joint):
        raise InputError(
            f"--dof {dof}: {robot.name} has {len(robot.joint)} joints; give 1 to {len(robot.joint)}"
        )
    left_out = len(robot.joint) - dof
    angles = tuple(locked_angles) or (0.0,) * left_out
    if len(angles) != left_out:
        raise InputError(f"--locked-angles: {left_out} joints are left out, {len(angles)} angles given")
    base = _thesis_values(robot, dof) if variant == "thesis" else _base_values(robot, dof, angles, wrist)
    joints = tuple(
        ModelJoint(
            a=j.a, d=j.d, alpha=j.alpha, offset=j.offset,
            drive_gain=j.drive_gain, max_torque=j.max_torque, max_speed=j.max_speed,
        )
        for j in robot.joint[:dof]
    )  # fmt: skip
    return Model(
        robot=robot.name,
        title=robot.title,
        variant="thesis" if variant == "thesis" else "full",
        gravity=robot.gravity,
        locked_angles=angles,
        joint=joints,
        base=base,
        source=robot.source,
        inputs=(Input(name=f"{robot.name}.toml", sha256=robot_hash),),
    )


def _base_values(robot: Robot, dof: int, angles: Sequence[float], wrist: str) -> dict[str, Value]:
    arm = robot_arm(robot.model_copy(update={"joint": robot.joint[:dof]}))
    bodies = with_wrist_locked(robot, dof, angles) if wrist == "locked" else link_inertias(robot)[:dof]
    rotors = [exact(j.gear) ** 2 * exact(j.rotor_inertia) for j in robot.joint[:dof]]
    numbers = evaluate(base_parameters(arm), arm, bodies, rotors)
    source = "published links" + (", the rest rigid" if wrist == "locked" and dof < len(robot.joint) else "")
    return {
        symbol.name: Value(value=float(number), unit=unit_of(symbol.name), source=source)
        for symbol, number in numbers.items()
    }


def unit_of(name: str) -> str:
    """Return the unit of a base parameter by its name."""
    return PARAMETER_UNITS.get(name.rstrip("0123456789"), "kg m^2")


def _thesis_values(robot: Robot, dof: int) -> dict[str, Value]:
    if dof != 3:
        raise InputError("--variant thesis: the thesis' model has three joints; give --dof 3")
    one, two, three = robot.joint[:3]
    values = {
        "m1": one.mass, "m2": two.mass, "m3": three.mass,
        "d1": one.centre_of_mass[2], "d2": two.centre_of_mass[2], "d3": three.centre_of_mass[2],
        "L2": abs(two.a),
        "l2": abs(two.a + two.centre_of_mass[0]), "l3": abs(three.a + three.centre_of_mass[0]),
        "I1": one.inertia[1], "I2": two.inertia[2], "I3": three.inertia[2],
        "Im": two.rotor_inertia, "rho": two.gear, "g": float(np.linalg.norm(robot.gravity)),
    }  # fmt: skip
    return {
        name: Value(value=float(repr(values[name])), unit=unit, source=meaning)
        for name, (unit, meaning) in THESIS_PARAMETERS.items()
    }


def _numbers(body: Inertia, arm: Arm) -> Inertia:
    return Inertia.from_parameters([sp.sympify(x).xreplace(dict(arm.values)) for x in body.parameters])
