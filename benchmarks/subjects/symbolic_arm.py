"""Kinetic and potential energy of an arm as its user would write them for a symbolic code generator.

Twists run from base to tip in link frames that stand on the joint axes; numbers are put in, and what is
exactly 0 or 1 stays so, which lets the generators fold it. A body's energy is written about the origin of
its link's frame or about its centre of mass, whichever gives the generator less to compute. Nothing of
residuum's own reduction is used: no base parameters, no composite bodies, no common frames of parallel
joints, no algebra on the result.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import sympy as sp

from residuum.robots import Robot
from residuum.symbolic.arm import exact_cos_sin
from residuum.symbolic.inertia import Inertia
from residuum.symbolic.nominal import with_wrist_locked

Vector = tuple[Any, Any, Any]
About = Literal["origin", "centre"]
ABOUT: tuple[About, ...] = ("origin", "centre")


@dataclass(frozen=True)
class Body:
    """Mass (kg), centre of mass (m) and inertia (kg m^2) about the point that is named."""

    mass: float
    centre: Vector
    tensor: tuple[Vector, Vector, Vector]


@dataclass(frozen=True)
class Link:
    """Where the joint's axis is in the frame of the one before, the body that moves, and its rotor."""

    a: float
    d: float
    cos_alpha: float
    sin_alpha: float
    offset: float
    body: Body
    rotor: float


class Symbols(NamedTuple):
    """What a generator brings: its variables and its functions."""

    q: Sequence[Any]
    qd: Sequence[Any]
    sin: Callable[[Any], Any]
    cos: Callable[[Any], Any]


def links(robot: Robot, dof: int, about: About) -> list[Link]:
    """Return the moving links; those beyond are rigid at zero angle, with their mass."""
    found = []
    a, d, c, s = 0, 0, 1, 0
    inertias = with_wrist_locked(robot, dof, (0.0,) * (len(robot.joint) - dof))
    for joint, inertia in zip(robot.joint[:dof], inertias, strict=True):
        found.append(Link(a, d, c, s, number(joint.offset), _body(inertia, about), joint.reflected_inertia))
        a, d = number(joint.a), number(joint.d)
        c, s = map(number, exact_cos_sin(joint.alpha))
    return found


def _body(inertia: Inertia, about: About) -> Body:
    mass, centre = inertia.mass, inertia.first_moment / inertia.mass
    tensor = inertia.tensor
    if about == "centre":
        tensor = tensor - mass * (centre.dot(centre) * sp.eye(3) - centre * centre.T)
    rows = tuple(tuple(number(tensor[i, j]) for j in range(3)) for i in range(3))
    return Body(number(mass), tuple(map(number, centre)), rows)


def number(value: Any) -> float:
    """Return an int where the value is one, so that 0 and 1 are folded."""
    value = float(value)
    return int(value) if value == int(value) else value


def energies(
    arm: Sequence[Link], about: About, gravity: Sequence[float], symbols: Symbols
) -> tuple[Any, Any]:
    """Return kinetic and potential energy, J, in the symbols of a code generator."""
    spin: Vector = (0, 0, 0)
    velocity: Vector = (0, 0, 0)
    fall: Vector = tuple(map(number, gravity))
    lost = 0  # potential energy of 1 kg at the frame's origin, negative
    kinetic, potential = 0, 0
    for link, angle, speed in zip(arm, symbols.q, symbols.qd, strict=True):
        shift = (link.a, 0, link.d)
        c, s = symbols.cos(angle + link.offset), symbols.sin(angle + link.offset)
        velocity, lost = plus(velocity, cross(spin, shift)), lost + dot(fall, shift)
        spin, velocity, fall = (into(link, c, s, x) for x in (spin, velocity, fall))
        spin = (spin[0], spin[1], spin[2] + speed)
        kinetic += kinetic_energy(link.body, about, spin, velocity) + number(link.rotor / 2) * speed * speed
        potential -= link.body.mass * lost + dot(moment(link.body), fall)
    return kinetic, potential


def kinetic_energy(body: Body, about: About, spin: Vector, velocity: Vector) -> Any:
    """Return the energy of a body whose frame moves so."""
    turning = sum(number(body.tensor[i][i] / 2) * spin[i] * spin[i] for i in range(3))
    turning += sum(body.tensor[i][j] * spin[i] * spin[j] for i, j in ((0, 1), (0, 2), (1, 2)))
    if about == "centre":
        velocity = plus(velocity, cross(spin, body.centre))
    else:
        turning += dot(moment(body), cross(velocity, spin))
    return number(body.mass / 2) * dot(velocity, velocity) + turning


def moment(body: Body) -> Vector:
    """Return mass times centre of mass, kg m."""
    return tuple(number(body.mass * x) for x in body.centre)


def into(link: Link, c: Any, s: Any, x: Vector) -> Vector:
    """Turn a vector into a link's axes: by alpha about x, then by the joint's angle about z."""
    y = link.cos_alpha * x[1] + link.sin_alpha * x[2]
    z = link.cos_alpha * x[2] - link.sin_alpha * x[1]
    return c * x[0] + s * y, c * y - s * x[0], z


def plus(a: Vector, b: Vector) -> Vector:
    """Return a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """Return a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def dot(a: Vector, b: Vector) -> Any:
    """Return a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
