"""Regressors as generated NumPy: the energies and the catalogue's terms differentiated by their parameters.

The Lagrangian is linear in the base parameters and every term in its `linear_in`, so the derivatives do
not hold the parameters, and torque = columns @ parameters. CasADi differentiates what equations.py and
terms.py derived; nothing is written a second time.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from types import ModuleType

import casadi as ca
import numpy as np
import sympy as sp
from numpy.typing import NDArray

from ..errors import InputError
from ..symbolic.arm import Arm
from ..symbolic.base_parameters import base_energies, base_parameters
from ..symbolic.equations import dynamics
from ..symbolic.terms import CATALOGUE, INPUTS, LOAD, QD, TEMPERATURE, Q
from .languages import NUMPY, body
from .listing import Listing, shortest
from .load import load_text
from .reduce import convert, convert_chain, numbers, symbols

Array = NDArray[np.float64]
#: Samples worked on at a time, so that the temporaries stay in cache.
_BLOCK = 2048


@dataclass(frozen=True)
class TermColumn:
    """One linear parameter of a catalogue term on a joint (1..N), its nonlinear ones fixed at `values`."""

    term: str
    joint: int
    parameter: str
    values: tuple[tuple[str, float], ...] = ()

    @property
    def name(self) -> str:
        """For example coulomb2_Fc, as the symbol in generated code."""
        return f"{self.term}{self.joint}_{self.parameter}"


@dataclass(frozen=True)
class Part:
    """A matrix with fixed zeros: the (row, column) of each value that the code of that name returns."""

    places: tuple[tuple[int, int], ...]
    arguments: tuple[tuple[str, int], ...]


@dataclass(frozen=True)
class Regressor:
    """Generated columns of an arm with N joints, B base parameters and K term columns.

    base: names of the B parameters. terms: the K columns. text: a NumPy module. parts: `momentum` dp/dtheta
    (N, B), `beta` d(beta)/dtheta (N, B), `torque` d(M qdd + C qd + g)/dtheta (N, B), `terms` (N, K).
    A picklable value; the module is built where it is used.
    """

    dof: int
    base: tuple[str, ...]
    terms: tuple[TermColumn, ...]
    text: str
    parts: Mapping[str, Part]

    def values(self, part: str, **inputs: Array) -> Array:
        """Return the values that are not fixed zeros, (T, len(parts[part].places)).

        inputs: q, qd, qdd, load, temperature, each (T, N) in rad, rad/s, rad/s^2, Nm, deg C; only those that
        the part needs.
        """
        found = self.parts[part]
        function = getattr(_module(self.text), part)
        rows = len(next(iter(inputs.values())))
        out = np.empty((len(found.places), rows))
        for start in range(0, rows, _BLOCK):
            block = slice(start, start + _BLOCK)
            columns = [np.ascontiguousarray(inputs[name][block, j]) for name, j in found.arguments]
            for k, value in enumerate(function(*columns)):
                out[k, block] = value
        return out.T

    def matrix(self, part: str, **inputs: Array) -> Array:
        """Return the full matrices (T, N, B or K), zeros included."""
        values = self.values(part, **inputs)
        width = len(self.terms) if part == "terms" else len(self.base)
        full = np.zeros((len(values), self.dof, width))
        for k, (row, column) in enumerate(self.parts[part].places):
            full[:, row, column] = values[:, k]
        return full

    def combined(self, part: str, parameters: Array, **inputs: Array) -> Array:
        """Return a part at some parameters (B or K,): its columns times them, summed up, (T, N)."""
        values = self.values(part, **inputs)
        found = np.zeros((len(values), self.dof))
        for k, (row, column) in enumerate(self.parts[part].places):
            found[:, row] += values[:, k] * parameters[column]
        return found


def regressor(arm: Arm, terms: Sequence[TermColumn] = ()) -> Regressor:
    """Differentiate the arm's energies by their base parameters and the terms by their linear ones."""
    names = tuple(base_parameters(arm))
    model = dynamics(base_energies(arm, names))
    q, qd = symbols(model.q), symbols(model.qd)
    qdd, load, temperature = (ca.SX.sym(x, arm.dof) for x in ("qdd", "load", "temperature"))
    theta = ca.vertcat(*(ca.SX.sym(x.name) for x in names))
    environment = numbers(arm.values) | {x: theta[i] for i, x in enumerate(names)}
    environment |= {x: q[i] for i, x in enumerate(model.q)} | {x: qd[i] for i, x in enumerate(model.qd)}
    environment = convert_chain(model.chain, environment)
    momentum, beta = (
        ca.vertcat(*(convert(sp.sympify(x), environment) for x in e)) for e in (model.momentum, model.beta)
    )
    torque = ca.jtimes(momentum, q, qd) + ca.jtimes(momentum, qd, qdd) - beta
    motion = {"q": q, "qd": qd}
    everything = motion | {"load": load, "temperature": temperature}
    listed = {
        "momentum": _listed("momentum", motion, ca.jacobian(momentum, theta)),
        "beta": _listed("beta", motion, ca.jacobian(beta, theta)),
        "torque": _listed("torque", motion | {"qdd": qdd}, ca.jacobian(torque, theta)),
        "terms": _listed("terms", everything, _term_matrix(arm.dof, terms, everything)),
    }
    text = "import numpy as np\n" + "".join(_function(x) for x, _ in listed.values())
    parts = {name: Part(places, _arguments(x)) for name, (x, places) in listed.items()}
    return Regressor(arm.dof, tuple(x.name for x in names), tuple(terms), text, parts)


def linear_columns(term: str, joint: int, values: Mapping[str, float]) -> list[TermColumn]:
    """Return a column for each linear parameter of a term; nonlinear ones from `values`, else by default.

    Raises InputError for a term with state: its columns are not those of single samples (see columns.py).
    """
    entry = CATALOGUE[term]
    if entry.state:
        raise InputError(f"--term {term}: remembers the samples before; `residuum explain` fits it, not fit")
    fixed = {
        n: p.default
        for n, p in entry.parameters.items()
        if n not in entry.linear_in and p.default is not None
    }
    fixed |= {n: v for n, v in values.items() if n in entry.parameters and n not in entry.linear_in}
    return [TermColumn(term, joint, name, tuple(sorted(fixed.items()))) for name in entry.linear_in]


def _term_matrix(dof: int, terms: Sequence[TermColumn], columns: Mapping[str, ca.SX]) -> ca.SX:
    matrix = ca.SX(dof, len(terms))
    inputs = {Q: columns["q"], QD: columns["qd"], LOAD: columns["load"], TEMPERATURE: columns["temperature"]}
    for k, column in enumerate(terms):
        expression, named = CATALOGUE[column.term].on_joint(column.joint)
        slope = sp.sympify(expression.diff(named[column.parameter]))
        environment = numbers({named[n]: v for n, v in column.values})
        environment |= {sp.Symbol(f"{x.name}{column.joint}"): inputs[x][column.joint - 1] for x in INPUTS}
        matrix[column.joint - 1, k] = convert(slope, environment)
    return matrix


def _listed(
    name: str, inputs: Mapping[str, ca.SX], matrix: ca.SX
) -> tuple[Listing, tuple[tuple[int, int], ...]]:
    """List the structural nonzeros of a matrix, and say where each stands."""
    rows, columns = matrix.sparsity().get_triplet()
    values = (
        ca.vertcat(*(matrix[r, c] for r, c in zip(rows, columns, strict=True))) if len(rows) else ca.SX(0, 1)
    )
    return shortest(name, inputs, {"values": values}), tuple(zip(rows, columns, strict=True))


def _arguments(listing: Listing) -> tuple[tuple[str, int], ...]:
    return tuple((array, element) for _, array, element in body(listing, NUMPY).inputs)


def _function(listing: Listing) -> str:
    printed = body(listing, NUMPY)
    lines = [f"    {s.target} = {s.text}" for s in printed.statements]
    lines.append(f"    return ({''.join(f'{x}, ' for x in printed.outputs['values'])})")
    arguments = ", ".join(name for name, _, _ in printed.inputs)
    return f"\n\ndef {listing.name}({arguments}):\n" + "\n".join(lines) + "\n"


@lru_cache(maxsize=8)
def _module(text: str) -> ModuleType:
    return load_text(text, "generated_regressor")
