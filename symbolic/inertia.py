"""The ten inertial parameters of a rigid body and how they change with the frame."""

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp

#: Khalil and Dombre's names, in the order of `Inertia.parameters`.
PARAMETER_NAMES = ("M", "MX", "MY", "MZ", "XX", "YY", "ZZ", "XY", "XZ", "YZ")
PARAMETER_UNITS = dict.fromkeys(PARAMETER_NAMES, "kg m^2") | {
    "M": "kg",
    "MX": "kg m",
    "MY": "kg m",
    "MZ": "kg m",
}


@dataclass(frozen=True)
class Inertia:
    """Mass (kg), first moment (3, kg m) and inertia about the frame's origin (3x3, kg m^2)."""

    mass: sp.Expr
    first_moment: sp.Matrix
    tensor: sp.Matrix

    @classmethod
    def from_parameters(cls, parameters: Sequence[sp.Expr]) -> "Inertia":
        """Build from ten values in the order of `PARAMETER_NAMES`."""
        m, mx, my, mz, xx, yy, zz, xy, xz, yz = (sp.sympify(x) for x in parameters)
        return cls(m, sp.Matrix([mx, my, mz]), sp.Matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))

    @classmethod
    def about_centre_of_mass(cls, mass: sp.Expr, centre: sp.Matrix, tensor: sp.Matrix) -> "Inertia":
        """Build from mass (kg), centre of mass (m) and inertia about it (kg m^2): Steiner's theorem."""
        return cls(mass, sp.zeros(3, 1), tensor).moved(sp.eye(3), centre)

    @property
    def parameters(self) -> tuple[sp.Expr, ...]:
        """The ten parameters in the order of `PARAMETER_NAMES`."""
        J = self.tensor
        return (self.mass, *self.first_moment, J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2])

    def moved(self, rotation: sp.Matrix, translation: sp.Matrix) -> "Inertia":
        """Return the same body seen from a frame in which a point x stands at rotation @ x + translation."""
        R, p = rotation, translation
        h = R * self.first_moment
        shift = 2 * h.dot(p) * sp.eye(3) - h * p.T - p * h.T
        steiner = self.mass * (p.dot(p) * sp.eye(3) - p * p.T)
        return Inertia(self.mass, h + self.mass * p, R * self.tensor * R.T + shift + steiner)

    def __add__(self, other: "Inertia") -> "Inertia":
        return Inertia(
            self.mass + other.mass, self.first_moment + other.first_moment, self.tensor + other.tensor
        )
