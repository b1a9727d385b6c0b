"""The equations of motion once more, by brute force: energies at 70 digits, differentiated numerically.

Nothing here knows about reverse accumulation, base parameters or generated code, so it can check all
three. Central differences of step 1e-20 leave an error near 1e-40.
"""

from collections.abc import Callable, Mapping, Sequence

import mpmath as mp
import sympy as sp

from .chain import Chain
from .energy import Energies

_DIGITS, _STEP = 70, mp.mpf("1e-20")
Vector = Sequence[mp.mpf]


class Reference:
    """Momentum, beta, gravity, mass matrix and inverse dynamics of some energies, exact to 30 digits.

    energies: see energy.py; values: the numbers of all their constants. Arguments are sequences of N
    numbers (rad, rad/s, rad/s^2); results are lists of N mpf (or N x N, row by row).
    """

    def __init__(self, energies: Energies, values: Mapping[sp.Symbol, sp.Expr | float]) -> None:
        arm = energies.arm
        self.dof = arm.dof
        self._values = list(values)
        with mp.workdps(_DIGITS):
            self._numbers = [_exact(v) for v in values.values()]
        arguments = [*arm.q, *arm.qd, *self._values]
        self._lagrangian = lambdify(arguments, sp.Add(*energies.lagrangian), energies.chain)

    def lagrangian(self, q: Vector, qd: Vector) -> mp.mpf:
        """Return T - V in J."""
        return self._lagrangian(*q, *qd, *self._numbers)

    def momentum(self, q: Vector, qd: Vector) -> list[mp.mpf]:
        """Return dT/dqd."""
        return self._gradient(lambda x: self.lagrangian(q, x), qd)

    def beta(self, q: Vector, qd: Vector) -> list[mp.mpf]:
        """Return d(T - V)/dq."""
        return self._gradient(lambda x: self.lagrangian(x, qd), q)

    def gravity(self, q: Vector) -> list[mp.mpf]:
        """Return dV/dq."""
        return [-b for b in self.beta(q, [mp.mpf(0)] * self.dof)]

    def mass_matrix(self, q: Vector) -> list[list[mp.mpf]]:
        """Return M, by columns of unit speed (momentum is linear in speed)."""
        columns = [self.momentum(q, [mp.mpf(i == j) for i in range(self.dof)]) for j in range(self.dof)]
        return [[columns[j][i] for j in range(self.dof)] for i in range(self.dof)]

    def inverse_dynamics(self, q: Vector, qd: Vector, qdd: Vector) -> list[mp.mpf]:
        """Return dp/dt - beta: the Euler-Lagrange equations as they stand."""
        with mp.workdps(_DIGITS):
            ahead, behind = (
                self.momentum(
                    [a + s * _STEP * b for a, b in zip(q, qd, strict=True)],
                    [a + s * _STEP * b for a, b in zip(qd, qdd, strict=True)],
                )
                for s in (1, -1)
            )
            slopes = [(a - b) / (2 * _STEP) for a, b in zip(ahead, behind, strict=True)]
            return [s - b for s, b in zip(slopes, self.beta(q, qd), strict=True)]

    def _gradient(self, function: Callable[[list[mp.mpf]], mp.mpf], at: Vector) -> list[mp.mpf]:
        with mp.workdps(_DIGITS):
            slopes = []
            for i in range(self.dof):
                ahead, behind = (
                    [mp.mpf(x) + (s * _STEP if k == i else 0) for k, x in enumerate(at)] for s in (1, -1)
                )
                slopes.append((function(ahead) - function(behind)) / (2 * _STEP))
            return slopes


def lambdify(arguments: Sequence[sp.Symbol], expression: sp.Expr, chain: Chain) -> Callable[..., mp.mpf]:
    """Return an mpmath function of an expression in a chain's symbols."""
    function: Callable[..., mp.mpf] = sp.lambdify(
        arguments, expression, modules="mpmath", cse=lambda found: (list(chain), found)
    )
    return function


def _exact(value: sp.Expr | float) -> mp.mpf:
    rational = sp.Rational(value)
    return mp.mpf(int(rational.p)) / mp.mpf(int(rational.q))
