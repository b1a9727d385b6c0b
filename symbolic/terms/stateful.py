"""Terms that remember: what they are worth depends on the samples before.

Low-passes x' = (u - x) / tau are stepped backward (implicit Euler): stable at any step, behind a ramp by
tau exactly at any rate, and (u - x) / tau is the slope of x from the sample before to this one. They
start settled (`STARTED`), so that nothing jumps at the first sample.
"""

import sympy as sp

from .term import DT, LOAD, QD, STARTED, WIDTH, Parameter, Term, smooth_sign

_s = sp.Symbol
_sign = smooth_sign(QD, _s("width"))


def _low_pass(value: sp.Expr, before: sp.Symbol, constant: str = "tau0") -> sp.Expr:
    """Return a low-pass with that time constant after a sample; on the first one what it follows."""
    return value + STARTED * (before - value) * (_s(constant) / (_s(constant) + DT))


def _tau0(seconds: float) -> Parameter:
    return Parameter("s", "time constant of the filter that differentiates", seconds)


def _built_up(direction: sp.Expr, before: sp.Symbol) -> sp.Expr:
    """Return the part of a Coulomb level that pushes after a sample, -1..1, on its way to a direction.

    dz/dt = |qd| (direction - z) / zs, over a sample in which the speed keeps its value (Dahl 1976).
    """
    return direction + (before - direction) * sp.exp(-sp.Abs(QD) * DT / _s("zs"))


def _dahl() -> Term:
    """Take from a Coulomb level A what has not built up since the last reversal.

    With coulomb's Fc = A the sum is A z.
    """
    z = _s("z")
    return Term(
        "presliding",
        "presliding_hysteresis",
        _s("A") * (z - _sign),
        {
            "A": Parameter("Nm", "Coulomb level that builds up with travel", None, (0.2, 20.0)),
            "zs": Parameter("rad", "travel after which 63 % of it are back", 0.01, (5e-4, 3e-2)),
            "width": WIDTH,
        },
        "Dahl 1976",
        ("A",),
        {"z": _built_up(_sign, z)},
    )


def _lag() -> Term:
    """Coulomb friction of a speed that lags behind: what it differs by from the one without lag.

    Late or not, a gear's friction builds up over a short travel: a late jump would be of no gear.
    """
    v, late, prompt = _s("v"), _s("late"), _s("prompt")
    slow = _low_pass(QD, v, "lag")
    return Term(
        "lag",
        "velocity_lag",
        _s("A") * (late - prompt),
        {
            "A": Parameter("Nm", "Coulomb level that changes sign late", None, (0.2, 20.0)),
            "lag": Parameter("s", "time constant of the lag", 8e-3, (2e-3, 2e-2)),
            "zs": Parameter("rad", "travel after which 63 % of the level are back", 3e-4, (1e-4, 1e-3)),
            "width": WIDTH,
        },
        "Hess and Soom 1990; Dahl 1976",
        ("A",),
        {
            "v": slow,
            "late": _built_up(smooth_sign(slow, _s("width")), late),
            "prompt": _built_up(_sign, prompt),
        },
    )


def _delay() -> Term:
    """First order of tau(t - d) = tau - d tau'."""
    x = _s("x")
    return Term(
        "delay",
        "time_delay",
        -_s("d") * (LOAD - x) / _s("tau0"),
        {
            "d": Parameter("s", "delay of the torque behind the motion", None, (2e-3, 2e-2)),
            "tau0": _tau0(0.02),
        },
        "Taylor series of the delayed torque",
        ("d",),
        {"x": _low_pass(LOAD, x)},
    )


def _elasticity() -> Term:
    """Torque that a spring in the gear costs while it stays quasi-static: c tau''.

    The gear is wound up by tau / K, so motor and link differ by tau'' / K in acceleration. With the
    encoder on the link, the rotor (J, kg m^2 at the joint) does more work and c = J / K; with the encoder
    on the motor, the link (M_ii) moves less than it seems to and c = -M_ii / K. Two low-passes in a row;
    what changes faster than 1 / (2 pi tau0) is not seen.
    """
    x1, x2 = _s("x1"), _s("x2")
    first = _low_pass(LOAD, x1)
    return Term(
        "elasticity",
        "joint_elasticity",
        _s("c") * (LOAD - 2 * x1 + x2) / _s("tau0") ** 2,
        {
            "c": Parameter("s^2", "inertia behind the spring over its stiffness", None, (-1e-3, 1e-3)),
            "tau0": _tau0(0.01),
        },
        "Spong 1987, quasi-static",
        ("c",),
        {"x1": first, "x2": _low_pass(first, x2)},
    )


def _clamped(x: sp.Expr) -> sp.Expr:
    """Return x, but -1 below -1 and 1 above 1."""
    return (sp.Abs(x + 1) - sp.Abs(x - 1)) / 2


def _backlash() -> Term:
    """Blow with which the gear meets its other flank: b ds/dt, s = -1 or 1 the flank that carries.

    s is a generalized play (Visintin 1994): the load takes it along to 1 between band and 2 band above
    zero, to -1 as far below, and in between it keeps its value, however fast the load changes. The
    shift of the link by the gap itself is far too small to be seen in torque.
    """
    s, y = _s("s"), _s("y")
    share = LOAD / _s("band")
    flank = sp.Max(_clamped(share - 1), sp.Min(_clamped(share + 1), s))
    return Term(
        "backlash",
        "backlash",
        _s("b") * (s - y) / _s("tau0"),
        {
            "b": Parameter("Nm s", "half the angular momentum of the blow", None, (-0.3, 0.3)),
            "band": Parameter("Nm", "load at which the other flank begins to carry", 0.5, (0.1, 5.0)),
            "tau0": _tau0(0.02),
        },
        "Nordin and Gutman 2002; Visintin 1994",
        ("b",),
        {"s": flank, "y": _low_pass(flank, y)},
    )


#: All of them.
STATEFUL = (_dahl(), _lag(), _delay(), _elasticity(), _backlash())
