"""What a term of the catalogue is: an expression, its parameters, and its state where it has one."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import sympy as sp

#: What a term may depend on: joint position (rad), joint speed (rad/s), torque that the joint carries
#: (Nm), joint temperature (deg C).
Q, QD, LOAD, TEMPERATURE = sp.symbols("q qd load temperature")
INPUTS = (Q, QD, LOAD, TEMPERATURE)
#: What an update of a state may depend on besides: seconds since the sample before, and whether there was
#: one (0 on the first sample, 1 after). They are the same for all joints.
DT, STARTED = sp.symbols("dt started")
CLOCK = (DT, STARTED)


@dataclass(frozen=True)
class Parameter:
    """A term's parameter: unit, meaning, and the value that it has when none is given (else None).

    plausible: (lowest, highest) value on an arm of the UR5e's size, in the parameter's unit; the prior of
    what looks for it. None: not a property of the robot, so nobody looks for it.
    """

    unit: str
    meaning: str
    default: float | None = None
    plausible: tuple[float, float] | None = None


@dataclass(frozen=True)
class Term:
    """One effect as an expression in `INPUTS`, its states and its parameters' symbols.

    effect: its name in findings. source: where the form is from. linear_in: parameters that the
    expression is linear in; no update of a state depends on them.

    state: name of each state -> its value after a sample, in `INPUTS`, `CLOCK`, the nonlinear parameters
    and the states before the sample (symbols of those names); all change at once. In `expression` the
    same symbols are the states after the sample. States are 0 before the first sample.
    """

    name: str
    effect: str
    expression: sp.Expr
    parameters: Mapping[str, Parameter]
    source: str
    linear_in: tuple[str, ...] = ()
    state: Mapping[str, sp.Expr] = field(default_factory=dict)

    def on_joint(self, joint: int, number: int = 1) -> tuple[sp.Expr, dict[str, sp.Symbol]]:
        """Return the expression for a joint (1..6) and its parameters' symbols there.

        Inputs become q3, qd3, load3, temperature3; a parameter Fc becomes coulomb3_Fc and a state z
        presliding3_z. number: 2 for the second term of that name on the joint, and so on: ripple3_2_A.
        """
        renamed = self.renamed(joint, number)
        return self.expression.xreplace(renamed), {n: renamed[sp.Symbol(n)] for n in self.parameters}

    def renamed(self, joint: int, number: int = 1) -> dict[sp.Symbol, sp.Symbol]:
        """Return what inputs, parameters and states are called on a joint; see `on_joint`."""
        prefix = f"{self.name}{joint}" if number == 1 else f"{self.name}{joint}_{number}"
        own = {sp.Symbol(n): sp.Symbol(f"{prefix}_{n}") for n in (*self.parameters, *self.state)}
        return own | {x: sp.Symbol(f"{x.name}{joint}") for x in INPUTS}


def smooth_sign(speed: sp.Expr, width: sp.Expr) -> sp.Expr:
    """Return v / (|v| + width): odd, monotonic, one half at v = width; it costs a division, not a tanh."""
    return speed / (sp.Abs(speed) + width)


#: The smooth sign's parameter in every term that has one.
WIDTH = Parameter("rad/s", "speed at which the smooth sign reaches one half", 0.005)
