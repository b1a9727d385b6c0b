"""Terms that remember, as listings: one sample for C and URScript, whole recordings for NumPy.

A sample is the catalogue's update as it stands. Along a recording NumPy wants each state's update as a map of
two numbers (a slope and a constant, or two bounds): such maps can be composed without a loop over samples.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca
import sympy as sp

from ..symbolic.terms import CATALOGUE, CLOCK, INPUTS, LOAD, QD, TEMPERATURE, Q
from ..symbolic.terms.forms import bounds, line, without_extremes
from .listing import Listing, shortest
from .reduce import Environment, convert, numbers
from .symbolic_model import JointTerm, SymbolicModel

RECALL, STEP = "recall", "step"


@dataclass(frozen=True)
class Maps:
    """States whose maps are known at the same time: the listing's name, their places, and the kind of map."""

    name: str
    places: tuple[int, ...]
    keeps: bool


def for_numpy(name: str) -> bool:
    """Whether a listing is for NumPy alone."""
    return name == RECALL or name.startswith("maps")


def states(model: SymbolicModel) -> list[tuple[JointTerm, str]]:
    """Return (term, name of a state) of every state, in the order of the generated code."""
    return [(term, name) for term in model.memory for name in term.states]


def stepped(model: SymbolicModel, environment: Environment) -> tuple[list[ca.SX], ca.SX]:
    """Return the torque of the terms that remember, one a joint, and the states (S,) after a sample.

    environment: inputs of every joint, the clock, parameters, and the states before the sample.
    """
    after = dict(environment)
    for term in model.memory:
        for name, update in CATALOGUE[term.data.name].state.items():
            after[term.states[name]] = convert(_on_joint(update, term), environment)
    grown = ca.vertcat(*(after[term.states[name]] for term, name in states(model)))
    return _torques(model, after), grown


def _torques(model: SymbolicModel, environment: Environment) -> list[ca.SX]:
    joints = range(1, model.model.dof + 1)
    sums = [sp.Add(*(t.expression for t in model.memory if t.data.joint == j)) for j in joints]
    return [convert(without_extremes(x), environment) for x in sums]


def _on_joint(expression: sp.Expr, term: JointTerm) -> sp.Expr:
    return without_extremes(sp.sympify(expression)).xreplace(term.renamed)


def maps(model: SymbolicModel) -> list[Maps]:
    """Return the states in groups, each needing only the states of the groups before it."""
    every = states(model)
    groups: dict[tuple[int, bool], list[int]] = {}
    for place, (term, name) in enumerate(every):
        keeps, pair = _map(term, name)
        entry = CATALOGUE[term.data.name]
        others = [n for n in entry.state if any(x.has(sp.Symbol(n)) for x in pair)]
        groups.setdefault((_depth(term, others), keeps), []).append(place)
    ordered = sorted(groups)
    return [Maps(f"maps{k}", tuple(groups[key]), key[1]) for k, key in enumerate(ordered, start=1)]


def _depth(term: JointTerm, names: Sequence[str]) -> int:
    """Return how many updates stand one behind another before these states are known."""
    entry, deepest = CATALOGUE[term.data.name], 0
    for name in names:
        _, pair = _map(term, name)
        behind = [n for n in entry.state if any(x.has(sp.Symbol(n)) for x in pair)]
        deepest = max(deepest, 1 + _depth(term, behind))
    return deepest


def _map(term: JointTerm, state: str) -> tuple[bool, tuple[sp.Expr, sp.Expr]]:
    """Return whether a state keeps its value between bounds, and the two numbers of its map."""
    entry = CATALOGUE[term.data.name]
    between = bounds(entry, state)
    pair = between or line(entry, state)
    if pair is None:
        raise NotImplementedError(f"{entry.name}: the update of {state} is neither linear in it nor a clamp")
    return between is not None, pair


def map_listings(model: SymbolicModel) -> dict[str, Listing]:
    """Return a listing for every group of maps, and `recall`: the torque with the states after a sample.

    Inputs q, qd, load, temperature (N), state (S) and clock (dt in s; 0 on the first sample, else 1).
    """
    n, every = model.model.dof, states(model)
    inputs = {x: ca.SX.sym(x, n) for x in ("q", "qd", "load", "temperature")}
    inputs |= {"state": ca.SX.sym("state", len(every)), "clock": ca.SX.sym("clock", 2)}
    environment = numbers(model.values) | _named(model, inputs)
    found = {}
    for group in maps(model):
        pairs = [_map(*every[place])[1] for place in group.places]
        sides = [
            ca.vertcat(
                *(
                    convert(_on_joint(pair[side], every[place][0]), environment)
                    for place, pair in zip(group.places, pairs, strict=True)
                )
            )
            for side in (0, 1)
        ]
        found[group.name] = shortest(group.name, inputs, {"first": sides[0], "second": sides[1]})
    torque = ca.vertcat(*_torques(model, environment))
    return found | {RECALL: shortest(RECALL, inputs, {"torque": torque})}


def _named(model: SymbolicModel, inputs: Mapping[str, ca.SX]) -> Environment:
    """Return what stands for every input, clock and state symbol of the terms."""
    columns = {Q: inputs["q"], QD: inputs["qd"], LOAD: inputs["load"], TEMPERATURE: inputs["temperature"]}
    named = {sp.Symbol(f"{x.name}{i + 1}"): columns[x][i] for x in INPUTS for i in range(model.model.dof)}
    named |= {x: inputs["clock"][i] for i, x in enumerate(CLOCK)}
    return named | {t.states[n]: inputs["state"][i] for i, (t, n) in enumerate(states(model))}


def step_listing(
    model: SymbolicModel, environment: Environment, motion: Mapping[str, ca.SX], outputs: Mapping[str, ca.SX]
) -> Listing:
    """Return `step`: a sample of everything that the observer needs, states included.

    environment: the rigid body's. motion: q, qd, temperature. outputs: momentum, beta, friction without
    what remembers. Further inputs: state (S), clock (dt in s; 0 on the first sample, else 1), before (N): the
    momentum of the sample before, whose change makes the torque that the joints carry.
    """
    further = {
        "state": ca.SX.sym("state", len(states(model))),
        "clock": ca.SX.sym("clock", 2),
        "before": ca.SX.sym("before", model.model.dof),
    }
    dt, started = further["clock"][0], further["clock"][1]
    carried = started * ((outputs["momentum"] - further["before"]) / dt) - outputs["beta"]
    inputs = {**motion, **further}
    torque, after = stepped(model, environment | _named(model, {**inputs, "load": carried}))
    friction = outputs["friction"] + ca.vertcat(*torque)
    return shortest(STEP, inputs, {**outputs, "friction": friction, "after": after})
