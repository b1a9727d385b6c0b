"""The straight-line functions of a model: what every language gets, as listings."""

from dataclasses import dataclass

import casadi as ca
import sympy as sp

from ..symbolic.terms import INPUTS, LOAD, QD, TEMPERATURE, Q
from .algebra import simplify
from .listing import Listing, shortest
from .memory import map_listings, step_listing
from .reduce import Environment, convert, convert_chain, numbers, symbols
from .symbolic_model import SymbolicModel, symbolic_model

__all__ = ["SymbolicModel", "listings", "operation_count", "symbolic_model"]


@dataclass(frozen=True)
class _Graph:
    """CasADi columns of the model's quantities."""

    q: ca.SX
    qd: ca.SX
    momentum: ca.SX
    beta: ca.SX
    gravity: ca.SX
    kinetic: ca.SX
    potential: ca.SX
    bias: ca.SX
    environment: Environment


def _graph(model: SymbolicModel) -> _Graph:
    d = model.dynamics
    q, qd = symbols(d.q), symbols(d.qd)
    environment = numbers(model.values)
    environment |= {s: q[i] for i, s in enumerate(d.q)} | {s: qd[i] for i, s in enumerate(d.qd)}
    environment = convert_chain(d.chain, environment)
    momentum, beta = (
        ca.vertcat(*(convert(sp.sympify(x), environment) for x in e)) for e in (d.momentum, d.beta)
    )
    at_rest = ca.Function("at_rest", [q, qd], [-beta])(q, ca.DM.zeros(len(d.q)))
    if d.bias is None:
        bias = ca.jtimes(momentum, q, qd) - beta
    else:
        bias = ca.vertcat(*(convert(x, environment) for x in d.bias))
    kinetic, potential = convert(d.kinetic, environment), convert(d.potential, environment)
    return _Graph(q, qd, momentum, beta, at_rest, kinetic, potential, bias, environment)


def _friction(model: SymbolicModel, graph: _Graph, load: ca.SX, temperature: ca.SX) -> ca.SX:
    environment = dict(graph.environment)
    columns = {Q: graph.q, QD: graph.qd, LOAD: load, TEMPERATURE: temperature}
    for i in range(model.model.dof):
        environment |= {sp.Symbol(f"{x.name}{i + 1}"): columns[x][i] for x in INPUTS}
    return ca.vertcat(*(convert(model.friction(i + 1), environment) for i in range(model.model.dof)))


def listings(model: SymbolicModel) -> dict[str, Listing]:
    """Return the model's functions, each reduced by CasADi and algebra.

    `core` is what the observer runs 500 times a second, so it alone is worth the algebra; momentum
    and beta are parts of it. Where terms remember, `step` takes its place, and NumPy has `maps1`, .. and
    `recall` for whole recordings.
    """
    g = _graph(model)
    n = model.model.dof
    qdd, load, temperature = (ca.SX.sym(x, n) for x in ("qdd", "load", "temperature"))
    mass = ca.jacobian(g.momentum, g.qd)
    q, qd = {"q": g.q}, {"q": g.q, "qd": g.qd}
    motion = qd | {"temperature": temperature}
    steady = {
        "momentum": g.momentum,
        "beta": g.beta,
        "friction": _friction(model, g, g.gravity, temperature),
    }
    core = simplify(shortest("core", motion, steady))
    found = {
        "core": core,
        "momentum_and_beta": core.part("momentum_and_beta", ("q", "qd"), ("momentum", "beta")),
        "momentum": core.part("momentum", ("q", "qd"), ("momentum",)),
        "beta": core.part("beta", ("q", "qd"), ("beta",)),
        "mass_matrix": shortest("mass_matrix", q, {"mass_matrix": mass}),
        "gravity": shortest("gravity", q, {"gravity": g.gravity}),
        "inverse_dynamics": shortest("inverse_dynamics", qd | {"qdd": qdd}, {"torque": mass @ qdd + g.bias}),
        "friction": shortest(
            "friction",
            qd | {"load": load, "temperature": temperature},
            {"friction": _friction(model, g, load, temperature)},
        ),
        "energy": shortest("energy", qd, {"kinetic": g.kinetic, "potential": g.potential}),
    }
    if model.memory:
        found["step"] = simplify(step_listing(model, g.environment, motion, steady))
        found |= map_listings(model)
    return found


def operation_count(model: SymbolicModel) -> int:
    """Return the operations of momentum and beta alone: what the project's tables give."""
    g = _graph(model)
    found = shortest("momentum_and_beta", {"q": g.q, "qd": g.qd}, {"momentum": g.momentum, "beta": g.beta})
    return simplify(found).operations
