"""The model of Gylling (KTH 2019, ch. 3.1), as it stands there, omissions included.

Two Lagrangians that do not see each other: joint 1 through the total centre of mass of links 1-3
(eq. 3.1.1, 3.1.7), joints 2 and 3 as a planar pair (eq. 3.1.3-3.1.8). docs/thesis_variant.md says
term by term what that leaves out.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import sympy as sp

from .chain import Chain
from .equations import Dynamics

#: Names, units and meaning of what the model needs.
PARAMETERS: Mapping[str, tuple[str, str]] = {
    "m1": ("kg", "mass of link 1"),
    "m2": ("kg", "mass of link 2"),
    "m3": ("kg", "mass of link 3"),
    "d1": ("m", "offset of link 1's centre of mass along the shoulder axis"),
    "d2": ("m", "offset of link 2's centre of mass along the shoulder axis"),
    "d3": ("m", "offset of link 3's centre of mass along the shoulder axis"),
    "L2": ("m", "length of link 2"),
    "l2": ("m", "shoulder axis to link 2's centre of mass"),
    "l3": ("m", "elbow axis to link 3's centre of mass"),
    "I1": ("kg m^2", "link 1 about the base axis, through its centre of mass"),
    "I2": ("kg m^2", "link 2 about the shoulder axis, through its centre of mass"),
    "I3": ("kg m^2", "link 3 about the elbow axis, through its centre of mass"),
    "Im": ("kg m^2", "rotor inertia, motor side"),
    "rho": ("1", "gear ratio"),
    "g": ("m/s^2", "acceleration of free fall"),
}


@dataclass(frozen=True)
class _Symbols:
    """Attribute access to the parameters' symbols."""

    def __getattr__(self, name: str) -> sp.Symbol:
        return sp.Symbol(name)


def thesis_dynamics() -> Dynamics:
    """Return momentum, beta and energies of the thesis' 3-joint model."""
    q, qd = sp.symbols("q1:4"), sp.symbols("qd1:4")
    base, planar_kinetic, planar_potential = _base_energy(q, qd), *_planar_energies(q, qd)
    planar = planar_kinetic - planar_potential
    beta = (base.diff(q[0]), planar.diff(q[1]), planar.diff(q[2]))
    momentum = (base.diff(qd[0]), planar.diff(qd[1]), planar.diff(qd[2]))
    turning = sp.Matrix(momentum[1:]).jacobian(q[1:]) * sp.Matrix(qd[1:])
    bias = (sp.Integer(0), *(turning - sp.Matrix(beta[1:])))  # tau1 = M11 q1'', eq. 3.1.9
    return Dynamics(
        q,
        qd,
        Chain(),
        momentum,
        beta,
        base + planar_kinetic,
        planar_potential,
        tuple(bias),
    )


def _base_energy(q: tuple[sp.Symbol, ...], qd: tuple[sp.Symbol, ...]) -> sp.Expr:
    """Kinetic energy of joint 1 (eq. 3.1.7): all mass moves with the total centre of mass (eq. 3.1.1)."""
    k = _Symbols()
    reach2 = k.l2 * sp.cos(q[1])  # B
    reach3 = k.L2 * sp.cos(q[1]) + k.l3 * sp.cos(q[1] + q[2])  # A
    total = k.m1 + k.m2 + k.m3
    along = k.m1 * k.d1 + k.m2 * k.d2 + k.m3 * k.d3
    across = k.m2 * reach2 + k.m3 * reach3
    centre = sp.Matrix(
        [along * sp.sin(q[0]) - across * sp.cos(q[0]), -along * sp.cos(q[0]) - across * sp.sin(q[0])]
    )
    impulse = (centre.diff(q[0]) * qd[0]).subs(q[0], 0)  # total * velocity; its square does not depend on q1
    return impulse.dot(impulse) / (2 * total) + (k.I1 + k.Im * k.rho**2) * qd[0] ** 2 / 2


def _planar_energies(q: tuple[sp.Symbol, ...], qd: tuple[sp.Symbol, ...]) -> tuple[sp.Expr, sp.Expr]:
    """Energies of joints 2 and 3 (eq. 3.1.8) from the centres of mass of eq. 3.1.3 and 3.1.4."""
    k = _Symbols()
    link2 = -k.l2 * sp.Matrix([sp.cos(q[1]), sp.sin(q[1])])
    elbow = -k.L2 * sp.Matrix([sp.cos(q[1]), sp.sin(q[1])])
    link3 = elbow - k.l3 * sp.Matrix([sp.cos(q[1] + q[2]), sp.sin(q[1] + q[2])])
    rates = sp.Matrix(qd[1:])
    kinetic = sp.Integer(0)
    for mass, point in ((k.m2, link2), (k.m3, link3)):
        velocity = (point.jacobian(q[1:]) * rates).subs(q[1], 0)  # its square does not depend on q2
        kinetic += mass * velocity.dot(velocity) / 2
    for inertia, rate in ((k.I2, qd[1]), (k.I3, qd[2])):
        kinetic += (inertia + k.Im * k.rho**2) * rate**2 / 2
    kinetic = sp.expand(sp.expand(kinetic).subs(sp.sin(q[2]) ** 2, 1 - sp.cos(q[2]) ** 2))
    return kinetic, k.g * (k.m2 * link2[1] + k.m3 * link3[1])
