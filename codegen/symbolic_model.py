"""A model as equations: rigid body, terms, and the numbers of every symbol in them."""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import sympy as sp

from ..errors import InputError
from ..robots.model import Model, TermData
from ..robots.toml import nearest
from ..symbolic.base_parameters import base_energies, base_parameters
from ..symbolic.equations import Dynamics, dynamics
from ..symbolic.nominal import robot_arm
from ..symbolic.terms import CATALOGUE
from ..symbolic.thesis import PARAMETERS as THESIS_PARAMETERS
from ..symbolic.thesis import thesis_dynamics


@dataclass(frozen=True)
class JointTerm:
    """A term of the model on a joint: expression, parameters' symbols and their numbers.

    renamed: what the catalogue's symbols are called on the joint.
    """

    data: TermData
    expression: sp.Expr
    symbols: Mapping[str, sp.Symbol]
    values: Mapping[str, float]
    renamed: Mapping[sp.Symbol, sp.Symbol]

    @property
    def remembers(self) -> bool:
        """Whether it has state."""
        return bool(CATALOGUE[self.data.name].state)

    @property
    def states(self) -> dict[str, sp.Symbol]:
        """Return the symbol of each state."""
        return {name: self.renamed[sp.Symbol(name)] for name in CATALOGUE[self.data.name].state}


@dataclass(frozen=True)
class SymbolicModel:
    """A model as equations: rigid body, terms, and the numbers of every symbol in them."""

    model: Model
    dynamics: Dynamics
    terms: tuple[JointTerm, ...]
    values: Mapping[sp.Symbol, float]

    def friction(self, joint: int) -> sp.Expr:
        """Return the sum of the joint's terms (joint: 1..N) in a motion that goes on as it is, Nm.

        Every term that remembers is zero there.
        """
        return sp.Add(*(t.expression for t in self.terms if t.data.joint == joint and not t.remembers))

    @property
    def memory(self) -> tuple[JointTerm, ...]:
        """The terms that have state."""
        return tuple(t for t in self.terms if t.remembers)

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
        entries = (CATALOGUE[t.data.name] for t in self.terms)
        return any(x.has(variable) for e in entries for x in (e.expression, *e.state.values()))


def symbolic_model(model: Model) -> SymbolicModel:
    """Derive the equations of a model.

    Raises InputError for a base parameter or term that does not exist, or a parameter that is missing.
    """
    terms = tuple(joint_term(data, model, number) for data, number in _numbered(model.term))
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


def _numbered(terms: Iterable[TermData]) -> Iterator[tuple[TermData, int]]:
    """Yield each term and how many of its name stood on its joint so far, itself included."""
    seen = Counter[tuple[str, int]]()
    for data in terms:
        seen[data.name, data.joint] += 1
        yield data, seen[data.name, data.joint]


def joint_term(data: TermData, model: Model, number: int = 1) -> JointTerm:
    """Look a term up in the catalogue and give every parameter a number; see Term.on_joint for `number`."""
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
    expression, named = term.on_joint(data.joint, number)
    return JointTerm(data, expression, named, values, term.renamed(data.joint, number))


def _known_names(model: Model, names: Iterable[str]) -> None:
    known = list(names)
    for name in model.base:
        if name not in known:
            raise InputError(
                f"{model.name}: base parameter {name}: not one of this robot; {nearest(name, known)}"
            )
