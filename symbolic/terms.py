"""The catalogue of friction and drive terms, each a SymPy expression written once.

A term is the torque (Nm, joint side) that the drive has to spend on it: motor torque = rigid body +
terms - external torque. Later work adds a term by adding an entry here; regressor, generated code
and report follow from it.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import sympy as sp

#: What a term may depend on: joint position (rad), joint speed (rad/s), torque that the joint carries
#: (Nm), joint temperature (deg C).
Q, QD, LOAD, TEMPERATURE = sp.symbols("q qd load temperature")
INPUTS = (Q, QD, LOAD, TEMPERATURE)


@dataclass(frozen=True)
class Parameter:
    """A term's parameter: unit, meaning, and the value that it has when none is given (else None)."""

    unit: str
    meaning: str
    default: float | None = None


@dataclass(frozen=True)
class Term:
    """One effect as an expression in `INPUTS` and its parameters' symbols.

    effect: its name in findings. source: where the form is from.
    """

    name: str
    effect: str
    expression: sp.Expr
    parameters: Mapping[str, Parameter]
    source: str
    linear_in: tuple[str, ...] = field(default=())

    def on_joint(self, joint: int) -> tuple[sp.Expr, dict[str, sp.Symbol]]:
        """Return the expression for a joint (1..6) and its parameters' symbols there.

        Inputs become q3, qd3, load3, temperature3; a parameter Fc becomes coulomb3_Fc.
        """
        symbols = {name: sp.Symbol(f"{self.name}{joint}_{name}") for name in self.parameters}
        inputs = {x: sp.Symbol(f"{x.name}{joint}") for x in INPUTS}
        renamed = {sp.Symbol(name): symbol for name, symbol in symbols.items()}
        return self.expression.xreplace(inputs | renamed), symbols


_WIDTH = Parameter("rad/s", "speed at which the smooth sign reaches one half", 0.005)


def smooth_sign(speed: sp.Expr, width: sp.Expr) -> sp.Expr:
    """Return v / (|v| + width): odd, monotonic, one half at v = width; it costs a division, not a tanh."""
    return speed / (sp.Abs(speed) + width)


_s = sp.Symbol
_sign = smooth_sign(QD, _s("width"))
_TORQUE, _PER_SPEED = "Nm", "Nm s/rad"
_ARMSTRONG = "Armstrong-Helouvry, Dupont, Canudas de Wit 1994"

_TERMS = [
    Term(
        "coulomb",
        "coulomb_friction",
        _s("Fc") * _sign,
        {"Fc": Parameter(_TORQUE, "Coulomb level"), "width": _WIDTH},
        _ARMSTRONG,
        ("Fc",),
    ),
    Term(
        "viscous",
        "viscous_friction",
        _s("Fv") * QD,
        {"Fv": Parameter(_PER_SPEED, "viscous coefficient")},
        _ARMSTRONG,
        ("Fv",),
    ),
    Term(
        "cubic",
        "nonlinear_viscous",
        _s("F3") * QD**3,
        {"F3": Parameter("Nm s^3/rad^3", "cubic coefficient")},
        "Gylling 2019, eq. 2.3.1",
        ("F3",),
    ),
    Term(
        "power",
        "nonlinear_viscous",
        _s("Fp") * sp.Abs(QD) ** _s("n") * _sign,
        {
            "Fp": Parameter("Nm (s/rad)^n", "coefficient"),
            "n": Parameter("1", "exponent", 0.65),
            "width": _WIDTH,
        },
        "shape of UR's factory friction sheets",
        ("Fp",),
    ),
    Term(
        "stribeck",
        "stribeck",
        _s("Fs") * sp.exp(-((QD / _s("vs")) ** 2)) * _sign,
        {
            "Fs": Parameter(_TORQUE, "static minus Coulomb level"),
            "vs": Parameter("rad/s", "Stribeck speed", 0.1),
            "width": _WIDTH,
        },
        _ARMSTRONG,
        ("Fs",),
    ),
    Term(
        "load_dependent",
        "load_dependent_friction",
        _s("mu") * sp.Abs(LOAD) * _sign,
        {"mu": Parameter("Nm/Nm", "friction per carried torque"), "width": _WIDTH},
        "Hamon, Gautier, Garrec 2010",
        ("mu",),
    ),
    Term(
        "asymmetric",
        "friction_asymmetry",
        _s("Fa") * sp.Abs(_sign),
        {
            "Fa": Parameter(_TORQUE, "half the difference of the levels in both directions"),
            "width": _WIDTH,
        },
        _ARMSTRONG,
        ("Fa",),
    ),
    Term(
        "temperature_dependent",
        "temperature_dependent_friction",
        (_s("kc") * _sign + _s("kv") * QD) * (TEMPERATURE - _s("T0")),
        {
            "kc": Parameter("Nm/K", "change of the Coulomb level"),
            "kv": Parameter("Nm s/(rad K)", "change of the viscous coefficient"),
            "T0": Parameter("deg C", "temperature of the other terms", 30.0),
            "width": _WIDTH,
        },
        "Bittencourt and Gunnarsson 2012",
        ("kc", "kv"),
    ),
    Term(
        "position_dependent",
        "position_dependent_friction",
        _sign * (_s("A") * sp.sin(_s("n") * Q) + _s("B") * sp.cos(_s("n") * Q)),
        {
            "A": Parameter(_TORQUE, "sine part"),
            "B": Parameter(_TORQUE, "cosine part"),
            "n": Parameter("1/turn", "periods a joint turn", 1.0),
            "width": _WIDTH,
        },
        _ARMSTRONG,
        ("A", "B"),
    ),
    Term(
        "spring",
        "cable_spring",
        _s("k") * (Q - _s("q0")),
        {"k": Parameter("Nm/rad", "stiffness"), "q0": Parameter("rad", "position without torque", 0.0)},
        "linear cable or hose",
        ("k",),
    ),
    Term(
        "ripple",
        "torque_ripple",
        _s("A") * sp.cos(_s("n") * Q) + _s("B") * sp.sin(_s("n") * Q),
        {
            "A": Parameter(_TORQUE, "cosine part"),
            "B": Parameter(_TORQUE, "sine part"),
            "n": Parameter("1/turn", "periods a joint turn: order times gear ratio", 101.0),
        },
        "Holtz and Springob 1996; wave generators turn with the motor",
        ("A", "B"),
    ),
    Term(
        "offset",
        "current_offset",
        _s("c"),
        {"c": Parameter(_TORQUE, "constant torque, at rest too")},
        "zero error of the current sensor",
        ("c",),
    ),
]

#: Every term by name.
CATALOGUE: Mapping[str, Term] = {term.name: term for term in _TERMS}
