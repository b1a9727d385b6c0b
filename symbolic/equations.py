"""Equations of motion from the energies, as SymPy expressions.

Two forms of the same thing. `Dynamics` is straight-line and short: what the generators print.
`mass_matrix`, `coriolis_matrix`, `gravity_vector` are plain expressions in q and qd that one can
print, substitute and differentiate.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp

from .chain import Chain, gradient
from .energy import Energies


@dataclass(frozen=True)
class Dynamics:
    """What the momentum observer needs, in the symbols of a chain.

    momentum: p = dT/dqd (N, kg m^2/s). beta: d(T-V)/dq = C^T qd - g (N, Nm), no Coriolis matrix
    (De Luca et al. 2006; C the Christoffel one). kinetic, potential: energies in J. bias: C qd + g
    where it is not what p and beta imply (only the thesis' model), else None.
    """

    q: tuple[sp.Symbol, ...]
    qd: tuple[sp.Symbol, ...]
    chain: Chain
    momentum: tuple[sp.Expr, ...]
    beta: tuple[sp.Expr, ...]
    kinetic: sp.Expr
    potential: sp.Expr
    bias: tuple[sp.Expr, ...] | None = None


def dynamics(energies: Energies) -> Dynamics:
    """Differentiate the Lagrangian once, in reverse, by all positions and speeds."""
    arm = energies.arm
    chain, slopes = gradient(energies.chain, energies.lagrangian, [*arm.q, *arm.qd])
    return Dynamics(
        q=arm.q,
        qd=arm.qd,
        chain=chain,
        momentum=tuple(slopes[arm.dof :]),
        beta=tuple(slopes[: arm.dof]),
        kinetic=sp.Add(*energies.kinetic),
        potential=sp.Add(*energies.potential),
    )


def mass_matrix(model: Dynamics) -> sp.Matrix:
    """Return M(q) (N x N, kg m^2): column j is the momentum at unit speed of joint j."""
    columns = []
    for moving in model.qd:
        unit = {x: sp.Integer(x == moving) for x in model.qd}
        chain, became = model.chain.substitute(unit)
        columns.append([chain.inline(p.xreplace(became)) for p in model.momentum])
    return sp.Matrix(columns).T


def gravity_vector(model: Dynamics) -> sp.Matrix:
    """Return g(q) = dV/dq (N, Nm): minus beta at rest."""
    chain, became = model.chain.substitute(dict.fromkeys(model.qd, sp.Integer(0)))
    return sp.Matrix([chain.inline(-b.xreplace(became)) for b in model.beta])


def coriolis_matrix(mass: sp.Matrix, q: Sequence[sp.Symbol], qd: Sequence[sp.Symbol]) -> sp.Matrix:
    """Return C(q, qd) (N x N, Nm s/rad) with Christoffel symbols of the first kind.

    c_ijk = (dM_ij/dq_k + dM_ik/dq_j - dM_jk/dq_i) / 2 (Siciliano et al., *Robotics*, eq. 7.45);
    with them dM/dt = C + C^T.
    """
    n = len(q)
    slope = [mass.diff(x) for x in q]

    def christoffel(i: int, j: int, k: int) -> sp.Expr:
        return (slope[k][i, j] + slope[j][i, k] - slope[i][j, k]) / 2

    return sp.Matrix(n, n, lambda i, j: sp.Add(*(christoffel(i, j, k) * qd[k] for k in range(n))))
