"""gen-model's check of its own output: the NumPy text against SymPy's energies, evaluated exactly."""

from collections.abc import Sequence

import mpmath as mp
import numpy as np
from numpy.typing import NDArray

from ..symbolic.base_parameters import base_energies
from ..symbolic.nominal import robot_arm
from ..symbolic.reference import Reference, lambdify
from .functions import SymbolicModel
from .load import load_text

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
    return worst


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
        result.append(
            lambdify(list(numbers), expression, model.dynamics.chain.__class__())(*numbers.values())
        )
    return result


def _relative(found: NDArray[np.float64], exact: Sequence[mp.mpf]) -> float:
    scale = max([abs(x) for x in exact] + [mp.mpf(1)])
    return float(max(abs(mp.mpf(float(f)) - x) for f, x in zip(found, exact, strict=True)) / scale)
