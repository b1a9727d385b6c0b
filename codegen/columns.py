"""Columns of the catalogue's terms along a recording: derivatives by the linear parameters, in NumPy.

Terms with state are updated over all samples without a Python loop over them: an update that is linear in
its state, or keeps it between bounds, is a map of two numbers, and such maps can be composed block by block.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from ..symbolic.terms import CATALOGUE, CLOCK, INPUTS
from ..symbolic.terms.forms import bounds, line, without_extremes

Array = NDArray[np.float64]
#: A map of a state: (slope, constant) or (lowest, highest).
Pair = tuple[Array, Array]


@dataclass(frozen=True)
class _Function:
    """A lambdified expression and the names of its arguments."""

    arguments: tuple[str, ...]
    call: Callable[..., Array]

    def __call__(self, values: Mapping[str, Array | float]) -> Array:
        return self.call(*(values[name] for name in self.arguments))


@dataclass(frozen=True)
class _Update:
    """A state's update as the two numbers of its map; keeps: whether they are bounds."""

    state: str
    first: _Function
    second: _Function
    keeps: bool


@dataclass(frozen=True)
class _Compiled:
    updates: tuple[_Update, ...]
    slopes: Mapping[str, _Function]


def columns(
    term: str,
    values: Mapping[str, float],
    q: Array,
    qd: Array,
    load: Array,
    temperature: Array | None,
    dt: Array,
) -> dict[str, Array]:
    """Return the derivative of a term's torque by each of its linear parameters, each (T, N).

    values: nonlinear parameters, the same for all joints; others have their default. q, qd, load,
    temperature: (T, N) in rad, rad/s, Nm, deg C, temperature None where the term does not need it. dt: (T,)
    seconds since the sample before; that of the first is not used by terms that start settled.
    Raises KeyError for a term that does not exist.
    """
    entry, compiled = CATALOGUE[term], _compiled(term)
    known = _arguments(term, values, (q, qd, load, temperature), dt)
    known |= states(term, values, q, qd, load, temperature, dt)
    shape = np.shape(q)
    return {name: np.array(np.broadcast_to(compiled.slopes[name](known), shape)) for name in entry.linear_in}


def states(
    term: str,
    values: Mapping[str, float],
    q: Array,
    qd: Array,
    load: Array,
    temperature: Array | None,
    dt: Array,
) -> dict[str, Array]:
    """Return a term's states after each sample, each (T, N); see `columns` for the arguments."""
    known = _arguments(term, values, (q, qd, load, temperature), dt)
    shape = np.shape(q)
    after: dict[str, Array] = {}
    for update in _compiled(term).updates:
        pair = (update.first(known), update.second(known))
        after[update.state] = _scan(pair, shape, *(_CLAMP if update.keeps else _LINE))
        known[update.state] = np.concatenate([np.zeros((1, *shape[1:])), after[update.state][:-1]])
    return after


def _arguments(
    term: str, values: Mapping[str, float], inputs: tuple[Array | None, ...], dt: Array
) -> dict[str, Array | float]:
    entry = CATALOGUE[term]
    known: dict[str, Array | float] = {
        n: float(values.get(n, p.default if p.default is not None else np.nan))
        for n, p in entry.parameters.items()
    }
    known |= {x.name: v for x, v in zip(INPUTS, inputs, strict=True) if v is not None}
    started = np.ones((len(dt), 1))
    started[:1] = 0.0
    return known | {"dt": np.asarray(dt, dtype=float)[:, None], "started": started}


@cache
def _compiled(term: str) -> _Compiled:
    entry = CATALOGUE[term]
    updates = []
    for state in entry.state:
        between = bounds(entry, state)
        pair = between or line(entry, state)
        if pair is None:
            raise NotImplementedError(f"{term}: the update of {state} is neither linear in it nor a clamp")
        first, second = (_lambdified(term, x) for x in pair)
        updates.append(_Update(state, first, second, between is not None))
    slopes = {n: _lambdified(term, entry.expression.diff(sp.Symbol(n))) for n in entry.linear_in}
    return _Compiled(tuple(updates), slopes)


def _lambdified(term: str, expression: sp.Expr) -> _Function:
    entry = CATALOGUE[term]
    names = (*(x.name for x in (*INPUTS, *CLOCK)), *entry.parameters, *entry.state)
    plain = without_extremes(sp.sympify(expression))
    used = tuple(n for n in names if sp.Symbol(n) in plain.free_symbols)
    return _Function(used, sp.lambdify([sp.Symbol(n) for n in used], plain, "numpy", cse=True))


def _scan(
    pair: Pair,
    shape: tuple[int, ...],
    identity: tuple[float, float],
    compose: Callable[[Pair, Pair], Pair],
    apply: Callable[[Pair, Array], Array],
) -> Array:
    """Return a state that starts at 0 after each of the maps, (T, N).

    The samples are cut into about sqrt(T) blocks of as many. All blocks compose their own maps at the same
    time, then the state goes from block to block, and at last into each of them.
    """
    length = max(1, int(np.ceil(np.sqrt(shape[0]))))
    count = -(-shape[0] // length)
    own = tuple(_blocks(x, shape, count, length, neutral) for x, neutral in zip(pair, identity, strict=True))
    for k in range(1, length):
        own[0][k], own[1][k] = compose((own[0][k - 1], own[1][k - 1]), (own[0][k], own[1][k]))
    start = np.zeros((count, shape[1]))
    for i in range(1, count):
        start[i] = apply((own[0][-1, i - 1], own[1][-1, i - 1]), start[i - 1])
    found = apply((own[0], own[1]), start)
    return np.ascontiguousarray(found.transpose(1, 0, 2).reshape(count * length, shape[1])[: shape[0]])


def _blocks(values: Array, shape: tuple[int, ...], count: int, length: int, neutral: float) -> Array:
    """Return (length, count, N or 1): the k-th sample of all blocks stands together."""
    full = np.asarray(values, dtype=float)
    if full.ndim < 2 or full.shape[0] != shape[0]:
        full = np.broadcast_to(full, shape)
    padded = np.full((count * length, full.shape[1]), neutral)
    padded[: shape[0]] = full
    return np.ascontiguousarray(padded.reshape(count, length, -1).transpose(1, 0, 2))


def _then_line(before: Pair, after: Pair) -> Pair:
    return after[0] * before[0], after[0] * before[1] + after[1]


def _then_clamp(before: Pair, after: Pair) -> Pair:
    return np.clip(before[0], *after), np.clip(before[1], *after)


_LINE = ((1.0, 0.0), _then_line, lambda pair, x: pair[0] * x + pair[1])
_CLAMP = ((-np.inf, np.inf), _then_clamp, lambda pair, x: np.clip(x, *pair))
