"""A term along a recording in plain Python: the SymPy expressions as they stand, sample by sample."""

import math

import numpy as np
import sympy as sp

from residuum.symbolic.terms import CATALOGUE, CLOCK, INPUTS

_MODULES = [{"Max": max, "Min": min, "Abs": abs, "exp": math.exp, "sin": math.sin, "cos": math.cos}, "math"]


def torque_by_hand(term, values, q, qd, load, temperature, dt) -> np.ndarray:
    """Torque (T,) of one joint; values holds every parameter; inputs are (T,)."""
    entry = CATALOGUE[term]
    symbols = [
        *INPUTS,
        *CLOCK,
        *(sp.Symbol(n) for n in entry.parameters),
        *(sp.Symbol(n) for n in entry.state),
    ]
    expression = sp.lambdify(symbols, entry.expression, _MODULES)
    updates = [sp.lambdify(symbols, x, _MODULES) for x in entry.state.values()]
    parameters = [float(values[n]) for n in entry.parameters]
    state = [0.0] * len(updates)
    found = []
    for k in range(len(q)):
        clock = [float(x[k]) for x in (q, qd, load, temperature, dt)] + [float(k > 0)]
        state = [update(*clock, *parameters, *state) for update in updates]
        found.append(expression(*clock, *parameters, *state))
    return np.array(found)


def built_up_by_hand(values, q, qd, dt) -> np.ndarray:
    """Part (T,), -1..1, of a Coulomb level that pushes: of coulomb and presliding together. values: zs, width."""
    unit, none = {"Fc": 1.0, "A": 1.0, **values}, 0 * qd
    return sum(torque_by_hand(x, unit, q, qd, none, none, dt) for x in ("coulomb", "presliding"))


def motion(samples: int, joints: int, seed: int = 0) -> dict:
    """A motion with reversals, rests, uneven steps and a load that changes sign: arrays (T, N), dt (T,)."""
    random = np.random.default_rng(seed)
    dt = random.choice([0.002, 0.004, 0.008, 0.1], samples, p=[0.6, 0.2, 0.19, 0.01])
    time = np.cumsum(dt)[:, None]
    phase = random.uniform(0, 6, joints)
    qd = np.sin(7 * time + phase) + 0.5 * np.sin(31 * time)
    qd[np.abs(qd) < 0.05] = 0.0
    q = np.cumsum(qd * dt[:, None], axis=0) + phase
    load = 20 * np.cos(3 * q) + random.normal(size=(samples, joints))
    return {"q": q, "qd": qd, "load": load, "temperature": 30 + 5 * time + 0 * q, "dt": dt}


def parameters(term, seed: int = 0) -> dict:
    """A value for every parameter: from the plausible range, else the default."""
    random = np.random.default_rng(seed)
    entry = CATALOGUE[term].parameters
    return {n: float(random.uniform(*p.plausible)) if p.plausible else p.default for n, p in entry.items()}
