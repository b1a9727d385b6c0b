"""Which terms a fit has: the default ones and those that the user asks for by name."""

from collections.abc import Sequence
from dataclasses import dataclass

from ..codegen.regressors import TermColumn, linear_columns
from ..errors import InputError
from ..robots.toml import nearest
from ..symbolic.terms import CATALOGUE

#: Fitted unless told otherwise.
DEFAULT_TERMS = ("coulomb", "viscous", "offset")
#: Parameters that must not be negative: friction that dissipates.
DISSIPATING = (("coulomb", "Fc"), ("viscous", "Fv"), ("power", "Fp"), ("load_dependent", "mu"))
#: Nonlinear parameters that are searched for, and where; every other one keeps its default or given value.
SEARCHED = {("stribeck", "vs"): (0.01, 0.6), ("power", "n"): (0.2, 2.0)}


@dataclass(frozen=True)
class TermRequest:
    """A catalogue term on some joints (1..N), with values for nonlinear parameters that are not searched."""

    name: str
    joints: tuple[int, ...]
    values: tuple[tuple[str, float], ...] = ()

    @property
    def searched(self) -> tuple[str, tuple[float, float]] | None:
        """The nonlinear parameter that is searched for, and its bounds."""
        given = dict(self.values)
        for (term, parameter), bounds in SEARCHED.items():
            if term == self.name and parameter not in given:
                return parameter, bounds
        return None

    def columns(self, joint: int, extra: tuple[tuple[str, float], ...] = ()) -> list[TermColumn]:
        """Return the term's columns on one joint."""
        return linear_columns(self.name, joint, dict(self.values) | dict(extra))


def default_requests(dof: int) -> list[TermRequest]:
    """Return the default terms on all joints."""
    return [TermRequest(name, tuple(range(1, dof + 1))) for name in DEFAULT_TERMS]


def parse_request(text: str, dof: int) -> TermRequest:
    """Read NAME[:JOINT,..][:PARAMETER=VALUE,..], such as stribeck:2,3 or ripple:1:n=2.

    Raises InputError for what does not exist.
    """
    name, *rest = text.split(":")
    where = f"--term {text}"
    if name not in CATALOGUE:
        raise InputError(f"{where}: no such term; {nearest(name, list(CATALOGUE))}")
    joints, values = tuple(range(1, dof + 1)), []
    for part in rest:
        if "=" in part:
            values += [_value(x, name, where) for x in part.split(",")]
        else:
            joints = tuple(_joint(x, dof, where) for x in part.split(","))
    return TermRequest(name, joints, tuple(values))


def _joint(text: str, dof: int, where: str) -> int:
    if not text.isdigit() or not 1 <= int(text) <= dof:
        raise InputError(f"{where}: joint {text or '(none)'}: give numbers from 1 to {dof}, as in NAME:2,3")
    return int(text)


def _value(text: str, name: str, where: str) -> tuple[str, float]:
    parameter, _, number = text.partition("=")
    entry = CATALOGUE[name]
    known = [n for n in entry.parameters if n not in entry.linear_in]
    if parameter not in known:
        raise InputError(
            f"{where}: {parameter} cannot be set; "
            + (f"known: {', '.join(known)}" if known else "this term has no such parameter")
        )
    try:
        value = float(number)
    except ValueError:
        raise InputError(f"{where}: {parameter}={number}: give a number") from None
    if not abs(value) < 1e6:
        raise InputError(f"{where}: {parameter}={number}: give a finite number")
    return parameter, value


def merged(requests: Sequence[TermRequest]) -> list[TermRequest]:
    """Drop repetitions: a later request for the same term and joint replaces the earlier one."""
    chosen: dict[tuple[str, int], TermRequest] = {}
    for request in requests:
        for joint in request.joints:
            chosen[request.name, joint] = TermRequest(request.name, (joint,), request.values)
    return list(chosen.values())
