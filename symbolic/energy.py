"""Kinetic and potential energy of an arm, written recursively in frames that move with its links.

Each body is described in its *turned* frame: origin on the joint axis, z along it, turned by the
joint. Twists run from base to tip (Featherstone, *Rigid Body Dynamics Algorithms*, ch. 2 and 5).
Joints with parallel axes share one frame, the one before the first of them turns: linear velocities
and first moments are written there, with the absolute angles, so that nothing is rotated twice.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp

from .arm import Arm
from .chain import Chain
from .inertia import Inertia


@dataclass(frozen=True)
class Motion:
    """How a frame moves, in its own axes: spin (rad/s), velocity and position of its origin (m/s, m).

    Gravity (m/s^2) is turned along, so that no rotation to the base is needed.
    """

    spin: sp.Matrix
    velocity: sp.Matrix
    gravity: sp.Matrix
    position: sp.Matrix


@dataclass(frozen=True)
class Energies:
    """Kinetic and potential energy (J), a term a body or rotor, in the symbols of the chain."""

    arm: Arm
    chain: Chain
    kinetic: tuple[sp.Expr, ...]
    potential: tuple[sp.Expr, ...]

    @property
    def lagrangian(self) -> tuple[sp.Expr, ...]:
        """Terms of L = T - V."""
        return (*self.kinetic, *(-v for v in self.potential))


def kinetic_energy(body: Inertia, moment: sp.Matrix, spin: sp.Matrix, motion: Motion) -> sp.Expr:
    """Return T = m v.v/2 + s.(v x w) + w.J w/2 in J.

    moment: the body's first moment s in the axes of `motion`; spin: w in the axes of `body`.
    """
    v, w = motion.velocity, motion.spin
    quadratic = (spin.T * body.tensor * spin)[0]
    return sp.expand(body.mass * v.dot(v) + quadratic) / 2 + _dot(moment, v.cross(w))


def potential_energy(body: Inertia, moment: sp.Matrix, motion: Motion) -> sp.Expr:
    """Return V = -g.(m r + s) in J; zero when the base's origin carries the mass."""
    return -(body.mass * motion.gravity.dot(motion.position) + _dot(moment, motion.gravity))


def rotor_energy(reflected: sp.Expr, speed: sp.Expr) -> sp.Expr:
    """Return the energy in J of a rotor that turns with its gear; reflected inertia in kg m^2."""
    return reflected * speed**2 / 2


def energies(arm: Arm, bodies: Sequence[Inertia], rotors: Sequence[sp.Expr]) -> Energies:
    """Write the energies of the arm.

    bodies: one inertia a joint in its turned frame (see `turned_frame`), N of them; rotors: N
    reflected rotor inertias (kg m^2).
    """
    chain = Chain()
    zero = sp.zeros(3, 1)
    motion = Motion(zero, zero, arm.gravity, zero)
    kinetic: list[sp.Expr] = []
    potential: list[sp.Expr] = []
    for group in arm.parallel_groups():
        motion, terms = _group(arm, chain, group, motion, bodies)
        kinetic += [t for t, _ in terms]
        potential += [v for _, v in terms]
    kinetic += [rotor_energy(r, qd) for r, qd in zip(rotors, arm.qd, strict=True)]
    return Energies(arm, chain, tuple(kinetic), tuple(potential))


def turned_frame(arm: Arm, joint: int, in_dh_frame: Inertia) -> Inertia:
    """Move a link's inertia (joint: 0-based) from its DH frame to its turned frame."""
    link = arm.links[joint]
    return in_dh_frame.moved(link.twist, link.translation)


def _group(
    arm: Arm, chain: Chain, group: Sequence[int], motion: Motion, bodies: Sequence[Inertia]
) -> tuple[Motion, list[tuple[sp.Expr, sp.Expr]]]:
    """Write the energies of joints with parallel axes; return them and the motion of the next frame."""
    terms = []
    angle, name = sp.Integer(0), ""
    for i in group:
        link, body, name = arm.links[i], bodies[i], f"{name}{i + 1}"
        angle = chain.define(f"th{name}", angle + arm.q[i] + link.offset)
        rate = chain.define(f"wz{name}", motion.spin[2] + arm.qd[i])
        motion = Motion(sp.Matrix([*motion.spin[:2], rate]), motion.velocity, motion.gravity, motion.position)
        c, s = chain.rotation(name, angle)
        spin = _into_turned(chain, "w", name, c, s, motion.spin)
        moment = _out_of_turned(chain, "S", name, c, s, body.first_moment)
        terms.append((kinetic_energy(body, moment, spin, motion), potential_energy(body, moment, motion)))
        if i + 1 < arm.dof:
            motion = _along(chain, name, motion, _out_of_turned(chain, "P", name, c, s, link.translation))
    if group[-1] + 1 == arm.dof:
        return motion, terms
    turned = (
        _into_turned(chain, letter, name, c, s, vector)
        for letter, vector in zip(
            "wvgr", (motion.spin, motion.velocity, motion.gravity, motion.position), strict=True
        )
    )
    twist = arm.links[group[-1]].twist.T
    return Motion(
        *(_define(chain, f"{letter}t", name, twist * x) for letter, x in zip("wvgr", turned, strict=True))
    ), terms


def _along(chain: Chain, name: str, motion: Motion, offset: sp.Matrix) -> Motion:
    """Move the reference point of a motion by an offset in the same axes: v + w x offset."""
    velocity = _define(chain, "v", name, motion.velocity + motion.spin.cross(offset))
    position = _define(chain, "r", name, motion.position + offset)
    return Motion(motion.spin, velocity, motion.gravity, position)


def _into_turned(chain: Chain, letter: str, name: str, c: sp.Expr, s: sp.Expr, x: sp.Matrix) -> sp.Matrix:
    return _define(chain, f"{letter}b", name, sp.Matrix([c * x[0] + s * x[1], c * x[1] - s * x[0], x[2]]))


def _out_of_turned(chain: Chain, letter: str, name: str, c: sp.Expr, s: sp.Expr, x: sp.Matrix) -> sp.Matrix:
    return _define(chain, letter, name, sp.Matrix([c * x[0] - s * x[1], s * x[0] + c * x[1], x[2]]))


def _define(chain: Chain, letter: str, name: str, vector: sp.Matrix) -> sp.Matrix:
    return sp.Matrix(
        [chain.define(f"{letter}{axis}{name}", e) for axis, e in zip("xyz", vector, strict=True)]
    )


def _dot(a: sp.Matrix, b: sp.Matrix) -> sp.Expr:
    return sp.Add(*(x * y for x, y in zip(a, b, strict=True)))
