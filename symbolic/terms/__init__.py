"""The catalogue of friction and drive terms, each a SymPy expression written once.

A term is the torque (Nm, joint side) that the drive has to spend on it: motor torque = rigid body +
terms - external torque. Adding an entry adds the term: regressor, generated code and report follow.
"""

from collections.abc import Mapping

from .pointwise import POINTWISE
from .stateful import STATEFUL
from .term import (
    CLOCK,
    DT,
    INPUTS,
    LOAD,
    QD,
    STARTED,
    TEMPERATURE,
    WIDTH,
    Parameter,
    Q,
    Term,
    smooth_sign,
)

__all__ = [
    "CATALOGUE",
    "CLOCK",
    "DT",
    "INPUTS",
    "LOAD",
    "QD",
    "STARTED",
    "TEMPERATURE",
    "WIDTH",
    "Parameter",
    "Q",
    "Term",
    "smooth_sign",
]

#: Every term by name.
CATALOGUE: Mapping[str, Term] = {term.name: term for term in (*POINTWISE, *STATEFUL)}
