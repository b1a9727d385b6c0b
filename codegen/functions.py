"""The straight-line functions of a model: what every language gets, as listings."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import casadi as ca
import sympy as sp

from ..errors import InputError
from ..robots.model import Model, TermData
from ..robots.toml import nearest
from ..symbolic.base_parameters import base_energies, base_parameters
from ..symbolic.equations import Dynamics, dynamics
from ..symbolic.nominal import robot_arm
from ..symbolic.terms import CATALOGUE, INPUTS, LOAD, QD, TEMPERATURE, Q
from ..symbolic.thesis import PARAMETERS as THESIS_PARAMETERS
from ..symbolic.thesis import thesis_dynamics
from .algebra import simplify
from .listing import Listing, from_casadi
from .reduce import Environment, convert, convert_chain, numbers, symbols


@dataclass(frozen=True)
class JointTerm:
    """A term of the model on a joint: expression, parameters' symbols and their numbers."""

    data: TermData
    expression: sp.Expr
    symbols: Mapping[str, sp.Symbol]
    values: Mapping[str, float]


@dataclass(frozen=True)
class SymbolicModel:
    """A model as equations: rigid body, terms, and the numbers of every symbol in them."""

    model: Model
    dynamics: Dynamics
    terms: tuple[JointTerm, ...]
    values: Mapping[sp.Symbol, float]

    def friction(self, joint: int) -> sp.Expr:
        """Return the sum of the joint's terms (joint: 1..N), Nm."""
        return sp.Add(*(t.expression for t in self.terms if t.data.joint == joint))

    def without_rotors(self) -> "SymbolicModel":
        """Return the rigid body with massless rotors, which is what published operation counts are of."""
        base = {k: v for k, v in self.model.base.items() if not k.startswith("IA")}
        return symbolic_model(self.model.model_copy(update={"base": base, "term": ()}))

    def with_all_parameters(self) -> "SymbolicModel":
        """Return the model without rotors with a number in every base parameter, as an identified one has."""
        base = {
            k: v if v.value else v.model_copy(update={"value": 1.0 + 0.01 * i})
            for i, (k, v) in enumerate(self.model.base.items())
            if not k.startswith("IA")
        }
        return symbolic_model(self.model.model_copy(update={"base": base, "term": ()}))

    def uses(self, variable: sp.Symbol) -> bool:
        """Whether any term depends on an input of the catalogue, such as the temperature."""
        return any(variable in CATALOGUE[t.data.name].expression.free_symbols for t in self.terms)


def symbolic_model(model: Model) -> SymbolicModel:
    """Derive the equations of a model.

    Raises InputError for a base parameter or term that does not exist, or a parameter that is missing.
    """
    terms = tuple(joint_term(data, model) for data in model.term)
    term_values = {t.symbols[n]: v for t in terms for n, v in t.values.items()}
    if model.variant == "thesis":
        _known_names(model, THESIS_PARAMETERS)
        values = {sp.Symbol(name): x.value for name, x in model.base.items()}
        return SymbolicModel(model, thesis_dynamics(), terms, values | term_values)
    arm = robot_arm(model)
    _known_names(model, [s.name for s in base_parameters(arm)])
    values = {sp.Symbol(name): x.value for name, x in model.base.items() if x.value}
    constants = {symbol: float(value) for symbol, value in arm.values.items()}
    return SymbolicModel(model, dynamics(base_energies(arm, values)), terms, constants | values | term_values)


def joint_term(data: TermData, model: Model) -> JointTerm:
    """Look a term up in the catalogue and give every parameter a number."""
    if data.name not in CATALOGUE:
        raise InputError(
            f"{model.name}: term {data.name}: no such term; {nearest(data.name, list(CATALOGUE))}"
        )
    term = CATALOGUE[data.name]
    if unknown := sorted(set(data.parameters) - set(term.parameters)):
        raise InputError(
            f"{model.name}: term {data.name}: no parameter {unknown[0]}; known: {', '.join(term.parameters)}"
        )
    values = {n: p.default for n, p in term.parameters.items() if p.default is not None} | data.parameters
    if missing := sorted(set(term.parameters) - set(values)):
        raise InputError(
            f"{model.name}: term {data.name} on joint {data.joint}: parameter {missing[0]} is missing"
        )
    expression, named = term.on_joint(data.joint)
    return JointTerm(data, expression, named, values)


def _known_names(model: Model, names: Iterable[str]) -> None:
    known = list(names)
    for name in model.base:
        if name not in known:
            raise InputError(
                f"{model.name}: base parameter {name}: not one of this robot; {nearest(name, known)}"
            )


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
    and beta are parts of it.
    """
    g = _graph(model)
    n = model.model.dof
    qdd, load, temperature = (ca.SX.sym(x, n) for x in ("qdd", "load", "temperature"))
    mass = ca.jacobian(g.momentum, g.qd)
    q, qd = {"q": g.q}, {"q": g.q, "qd": g.qd}
    core = simplify(
        shortest(
            "core",
            qd | {"temperature": temperature},
            {
                "momentum": g.momentum,
                "beta": g.beta,
                "friction": _friction(model, g, g.gravity, temperature),
            },
        )
    )
    return {
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


def shortest(name: str, inputs: Mapping[str, ca.SX], outputs: Mapping[str, ca.SX]) -> Listing:
    """List a function, with and without CasADi's own search for equal subexpressions; keep the shorter."""
    plain = from_casadi(name, inputs, outputs)
    shared = from_casadi(name, inputs, dict(zip(outputs, ca.cse([*outputs.values()]), strict=True)))
    return min((plain, shared), key=lambda x: x.operations)


def operation_count(model: SymbolicModel) -> int:
    """Return the operations of momentum and beta alone: what the project's tables give."""
    g = _graph(model)
    found = shortest("momentum_and_beta", {"q": g.q, "qd": g.qd}, {"momentum": g.momentum, "beta": g.beta})
    return simplify(found).operations
