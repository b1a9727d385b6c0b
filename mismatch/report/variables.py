"""The variables that unexplained torque is located along: their names, and where a trace holds them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..result import Trace

Array = NDArray[np.float64]

#: rad/s; below it a joint has no direction worth speaking of.
MOVING = 0.01
#: A variable's name ends so where the torque turns round with the direction of motion.
_TURNS = " sign"


@dataclass(frozen=True)
class Variable:
    """A variable in words, its unit, and its samples (n,) from a trace (none: traces do not hold it)."""

    text: str
    unit: str
    of: Callable[[Trace], Array] | None


@dataclass(frozen=True)
class Readings:
    """Samples (n,) of a variable, the residual before (Nm), and what the findings add (Nm)."""

    x: Array
    before: Array
    effect: Array


VARIABLES: Mapping[str, Variable] = {
    "q": Variable("joint angle", "rad", lambda t: t.q),
    "qd": Variable("joint speed", "rad/s", lambda t: t.qd),
    "speed": Variable("joint speed without its sign", "rad/s", lambda t: np.abs(t.qd)),
    "load": Variable("torque that the joint carries", "Nm", lambda t: t.load),
    "temperature": Variable("joint temperature", "°C", lambda t: t.temperature),
    "since": Variable("time since the joint reversed", "s", lambda t: t.since),
    "motor": Variable("angle of the motor within its turn", "rad", None),
    "t": Variable("time", "s", None),
}
_OTHER_NAMES = {"since reversal": "since", "|qd|": "speed", "|tau|": "load", "T": "temperature", "time": "t"}


def by_direction(name: str) -> bool:
    """Return whether the torque along a variable turns round with the direction of motion."""
    return name.endswith(_TURNS)


def words(name: str) -> str:
    """Return a variable in words: 'load sign' is the torque that the joint carries, by direction."""
    text = _variable(name).text
    return f"{text}, by direction of motion" if by_direction(name) else text


def in_time(name: str) -> bool:
    """Return whether a variable is the time itself."""
    return _OTHER_NAMES.get(name, name) == "t"


def label(name: str) -> str:
    """Return the label of a variable's axis."""
    found = _variable(name)
    return f"{found.text} / {found.unit}" if found.unit else found.text


def readings(trace: Trace, name: str) -> Readings | None:
    """Return a trace along a variable, or None where the trace does not hold it.

    Where it turns with the direction, torques count along the motion, and samples at rest are left out.
    """
    of = _variable(name).of
    if of is None or not len(trace.time):
        return None
    x = of(trace)
    if not np.isfinite(x).any():
        return None
    if not by_direction(name):
        return Readings(x, trace.before, trace.effect)
    moves = np.abs(trace.qd) > MOVING
    sign = np.sign(trace.qd[moves])
    return Readings(x[moves], sign * trace.before[moves], sign * trace.effect[moves])


def _variable(name: str) -> Variable:
    bare = name.removesuffix(_TURNS)
    bare = _OTHER_NAMES.get(bare, bare)
    return VARIABLES.get(bare, Variable(bare.replace("_", " "), "", None))
