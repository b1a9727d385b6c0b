"""Terms that depend on the sample alone."""

import sympy as sp

from .term import LOAD, QD, TEMPERATURE, WIDTH, Parameter, Q, Term, smooth_sign

_s = sp.Symbol
_sign = smooth_sign(QD, _s("width"))
_TORQUE, _PER_SPEED = "Nm", "Nm s/rad"
_ARMSTRONG = "Armstrong-Helouvry, Dupont, Canudas de Wit 1994"
_BITTENCOURT = "Bittencourt and Gunnarsson 2012"
_T0 = Parameter("deg C", "temperature of the other terms", 30.0)


def _tanh(x: sp.Expr) -> sp.Expr:
    """Write tanh with the one function that every language has, which must not overflow."""
    most = 20  # tanh is one from here, in double precision
    return 1 - 2 / (sp.exp(x + most - sp.Abs(x - most)) + 1)


_PLAIN = (
    Term(
        "coulomb",
        "coulomb_friction",
        _s("Fc") * _sign,
        {"Fc": Parameter(_TORQUE, "Coulomb level", None, (0.2, 20.0)), "width": WIDTH},
        _ARMSTRONG,
        ("Fc",),
    ),
    Term(
        "viscous",
        "viscous_friction",
        _s("Fv") * QD,
        {"Fv": Parameter(_PER_SPEED, "viscous coefficient", None, (0.2, 30.0))},
        _ARMSTRONG,
        ("Fv",),
    ),
    Term(
        "asymmetric",
        "friction_asymmetry",
        _s("Fa") * sp.Abs(_sign),
        {
            "Fa": Parameter(
                _TORQUE, "half the difference of the levels in both directions", None, (-3.0, 3.0)
            ),
            "width": WIDTH,
        },
        _ARMSTRONG,
        ("Fa",),
    ),
    Term(
        "offset",
        "current_offset",
        _s("c"),
        {"c": Parameter(_TORQUE, "constant torque, at rest too", None, (-3.0, 3.0))},
        "zero error of the current sensor",
        ("c",),
    ),
    Term(
        "stribeck",
        "stribeck",
        _s("Fs") * sp.exp(-((sp.Abs(QD) / _s("vs")) ** _s("delta"))) * _sign,
        {
            "Fs": Parameter(_TORQUE, "static minus Coulomb level", None, (0.1, 10.0)),
            "vs": Parameter("rad/s", "Stribeck speed", 0.1, (0.02, 0.3)),
            "delta": Parameter("1", "exponent: 1 Tustin's, 2 a bell", 2.0, (0.5, 2.0)),
            "width": WIDTH,
        },
        _ARMSTRONG,
        ("Fs",),
    ),
)

_OF_SPEED = (
    Term(
        "quadratic",
        "nonlinear_viscous",
        _s("F2") * QD * sp.Abs(QD),
        {"F2": Parameter("Nm s^2/rad^2", "quadratic coefficient", None, (-8.0, 8.0))},
        _ARMSTRONG,
        ("F2",),
    ),
    Term(
        "cubic",
        "nonlinear_viscous",
        _s("F3") * QD**3,
        {"F3": Parameter("Nm s^3/rad^3", "cubic coefficient", None, (-4.0, 4.0))},
        "Gylling 2019, eq. 2.3.1",
        ("F3",),
    ),
    Term(
        "power",
        "nonlinear_viscous",
        _s("Fp") * sp.Abs(QD) ** _s("n") * _sign,
        {
            "Fp": Parameter("Nm (s/rad)^n", "coefficient", None, (-15.0, 15.0)),
            "n": Parameter("1", "exponent", 0.65, (0.3, 0.9)),
            "width": WIDTH,
        },
        "shape of UR's factory friction sheets",
        ("Fp",),
    ),
    Term(
        "tanh",
        "nonlinear_viscous",
        _s("Ft") * _tanh(QD / _s("vt")),
        {
            "Ft": Parameter(_TORQUE, "level at which the drag saturates", None, (-15.0, 15.0)),
            "vt": Parameter("rad/s", "speed of three quarters of it", 0.5, (0.1, 2.0)),
        },
        "Makkar, Dixon, Sawyer, Hu 2005",
        ("Ft",),
    ),
)

_OF_TEMPERATURE = (
    Term(
        "temperature_dependent",
        "temperature_dependent_friction",
        (_s("kc") * _sign + _s("kv") * QD) * (TEMPERATURE - _s("T0")),
        {
            "kc": Parameter("Nm/K", "change of the Coulomb level", None, (-0.3, 0.05)),
            "kv": Parameter("Nm s/(rad K)", "change of the viscous coefficient", None, (-0.5, 0.05)),
            "T0": _T0,
            "width": WIDTH,
        },
        _BITTENCOURT,
        ("kc", "kv"),
    ),
    Term(
        "temperature_exponential",
        "temperature_dependent_friction",
        (_s("Ec") * _sign + _s("Ev") * QD) * (sp.exp((_s("T0") - TEMPERATURE) / _s("Te")) - 1),
        {
            "Ec": Parameter(_TORQUE, "part of the Coulomb level that decays", None, (-2.0, 10.0)),
            "Ev": Parameter(_PER_SPEED, "part of the viscous coefficient that decays", None, (-2.0, 20.0)),
            "Te": Parameter("K", "warming after which 37 % of it are left", 40.0, (15.0, 200.0)),
            "T0": _T0,
            "width": WIDTH,
        },
        _BITTENCOURT,
        ("Ec", "Ev"),
    ),
)

_OF_PLACE = (
    Term(
        "load_dependent",
        "load_dependent_friction",
        _s("mu") * sp.Abs(LOAD) * _sign,
        {"mu": Parameter("Nm/Nm", "friction per carried torque", None, (0.02, 0.15)), "width": WIDTH},
        "Hamon, Gautier, Garrec 2010",
        ("mu",),
    ),
    Term(
        "position_dependent",
        "position_dependent_friction",
        _sign * (_s("A") * sp.sin(_s("n") * Q) + _s("B") * sp.cos(_s("n") * Q)),
        {
            "A": Parameter(_TORQUE, "sine part", None, (-3.0, 3.0)),
            "B": Parameter(_TORQUE, "cosine part", None, (-3.0, 3.0)),
            "n": Parameter("1/turn", "periods a joint turn", 1.0, (1.0, 4.0)),
            "width": WIDTH,
        },
        _ARMSTRONG,
        ("A", "B"),
    ),
    Term(
        "spring",
        "cable_spring",
        _s("k") * (Q - _s("q0")),
        {
            "k": Parameter("Nm/rad", "stiffness", None, (0.02, 2.0)),
            "q0": Parameter("rad", "position without torque", 0.0, (-3.2, 3.2)),
        },
        "linear cable or hose",
        ("k",),
    ),
    Term(
        "ripple",
        "torque_ripple",
        _s("A") * sp.cos(_s("n") * Q) + _s("B") * sp.sin(_s("n") * Q),
        {
            "A": Parameter(_TORQUE, "cosine part", None, (-0.6, 0.6)),
            "B": Parameter(_TORQUE, "sine part", None, (-0.6, 0.6)),
            "n": Parameter("1/turn", "periods a joint turn: order times gear ratio", 101.0, (50.0, 404.0)),
        },
        "Holtz and Springob 1996; wave generators turn with the motor",
        ("A", "B"),
    ),
)

#: All of them.
POINTWISE = _PLAIN + _OF_SPEED + _OF_TEMPERATURE + _OF_PLACE
