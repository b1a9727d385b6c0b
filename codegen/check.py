"""gen-model's check of its own output: the NumPy text against SymPy's energies, evaluated exactly."""

from collections.abc import Sequence
from types import ModuleType

import mpmath as mp
import numpy as np
import sympy as sp
from numpy.typing import NDArray

from ..symbolic.base_parameters import base_energies
from ..symbolic.chain import Chain
from ..symbolic.nominal import robot_arm
from ..symbolic.reference import Reference, lambdify
from ..symbolic.terms import CATALOGUE, CLOCK, INPUTS
from .load import load_text
from .symbolic_model import JointTerm, SymbolicModel

#: Agreement that double precision must reach, relative to the largest element of a result.
TOLERANCE = 1e-11


def worst_disagreement(model: SymbolicModel, observer_text: str, states: int = 2) -> float:
    """Return the largest relative difference between generated NumPy and SymPy, over some states.

    Momentum and beta of the rigid body, and every joint's terms.
    """
    module = load_text(observer_text)
    n = model.model.dof
    random = np.random.default_rng(0)
    worst = 0.0
    for _ in range(states):
        q, qd = random.uniform(-np.pi, np.pi, n), random.uniform(-2, 2, n)
        load, hot = random.uniform(-50, 50, n), random.uniform(20, 60, n)
        exact = _rigid_body(model, q.tolist(), qd.tolist())
        worst = max(
            worst, _relative(module.momentum(q, qd), exact[0]), _relative(module.beta(q, qd), exact[1])
        )
        friction = _terms(model, q, qd, load, hot)
        worst = max(worst, _relative(module.friction(q, qd, load, hot), friction))
    return max(worst, _memory(model, module)) if model.memory else worst


def _memory(model: SymbolicModel, module: ModuleType, samples: int = 6) -> float:
    """Compare the terms that remember along a few samples of random motion, updated one by one."""
    random = np.random.default_rng(1)
    shape = (samples, model.model.dof)
    q, qd, load = (random.uniform(-x, x, shape) for x in (np.pi, 2.0, 50.0))
    hot, dt = random.uniform(20, 60, shape), random.uniform(0.002, 0.02, samples)
    steady = module.friction(q, qd, load, hot)
    found = module.friction(q, qd, load, hot, dt=dt, carried=load) - steady
    exact = np.zeros(shape, dtype=object)
    for term in model.memory:
        j = term.data.joint - 1
        columns = np.stack([q[:, j], qd[:, j], load[:, j], hot[:, j], dt, np.arange(samples) > 0], axis=1)
        exact[:, j] += _along(term, columns)
    return max(_relative(a, b.tolist()) for a, b in zip(found, exact, strict=True))


def _along(term: JointTerm, columns: NDArray[np.float64]) -> list[mp.mpf]:
    """Return a term's torque at each sample; columns (T, 6): `INPUTS` and `CLOCK`."""
    entry = CATALOGUE[term.data.name]
    symbols = [*INPUTS, *CLOCK, *(sp.Symbol(n) for n in (*entry.parameters, *entry.state))]
    parameters = [mp.mpf(float(term.values[n])) for n in entry.parameters]
    torque, *updates = (lambdify(symbols, x, Chain()) for x in (entry.expression, *entry.state.values()))
    state, found = [mp.mpf(0) for _ in updates], []
    for row in columns:
        numbers = [*(mp.mpf(float(x)) for x in row), *parameters]
        state = [update(*numbers, *state) for update in updates]
        found.append(torque(*numbers, *state))
    return found


def _rigid_body(
    model: SymbolicModel, q: list[float], qd: list[float]
) -> tuple[Sequence[mp.mpf], Sequence[mp.mpf]]:
    if model.model.variant == "full":
        arm = robot_arm(model.model)
        energies = base_energies(arm, model.values)
        symbols = {x for e in energies.lagrangian for x in e.free_symbols}
        symbols |= {x for _, e in energies.chain for x in e.free_symbols}
        reference = Reference(energies, {k: v for k, v in model.values.items() if k in symbols})
        return reference.momentum(q, qd), reference.beta(q, qd)
    d = model.dynamics
    arguments = [*d.q, *d.qd, *model.values]
    numbers = [mp.mpf(float(x)) for x in (*q, *qd, *model.values.values())]
    both = [[lambdify(arguments, x, d.chain)(*numbers) for x in parts] for parts in (d.momentum, d.beta)]
    return both[0], both[1]


def _terms(model: SymbolicModel, *columns: NDArray[np.float64]) -> list[mp.mpf]:
    result = []
    for joint in range(1, model.model.dof + 1):
        expression = model.friction(joint)
        inputs = {
            f"{name}{joint}": column[joint - 1]
            for name, column in zip(("q", "qd", "load", "temperature"), columns, strict=True)
        }
        values = {k: model.values.get(k, inputs.get(k.name)) for k in expression.free_symbols}
        numbers = {k: mp.mpf(float(v)) for k, v in values.items() if v is not None}
        result.append(lambdify(list(numbers), expression, Chain())(*numbers.values()))
    return result


def _relative(found: NDArray[np.float64], exact: Sequence[mp.mpf]) -> float:
    scale = max([abs(x) for x in exact] + [mp.mpf(1)])
    return float(max(abs(mp.mpf(float(f)) - x) for f, x in zip(found, exact, strict=True)) / scale)
