"""The flexible curve: what anything smooth in the recorded variables could explain. It is no physics.

Its held-out gain is the ceiling for a named mechanism, its place says where to look, and a name that
reaches only a small part of it is not believed.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Curves over a variable: how many hats (linear B-splines), and whether they turn with the direction.
PIECES = {
    "q": 10,
    "q sign": 10,
    "speed": 5,
    "speed sign": 6,
    "load": 6,
    "load sign": 5,
    "since reversal": 5,
    "temperature": 3,
    "drive sign": 1,
}
#: s; edges of the hats over the time since the last reversal.
_SINCE = np.array([0.0, 0.05, 0.1, 0.2, 0.4, 0.8])


@dataclass(frozen=True)
class Ranges:
    """What the recordings cover, a row a joint: q (rad), |qd| (rad/s), load (Nm), temperature (deg C)."""

    q: Array  # (N, 2)
    speed: Array
    load: Array
    temperature: Array


def ranges(q: Array, qd: Array, load: Array, temperature: Array) -> Ranges:
    """Return the ranges of samples (T, N) between their 1st and 99th percentile."""

    def span(x: Array) -> Array:
        low, high = np.percentile(x, [1.0, 99.0], axis=0)
        return np.stack([low, np.maximum(high, low + 1e-6)], axis=1)

    speed = span(np.abs(qd))
    speed[:, 0] = 0.0
    return Ranges(span(q), speed, span(load), span(temperature))


def names() -> list[tuple[str, int]]:
    """Return the (variable, piece) of each column of `curves`."""
    return [(name, k) for name, count in PIECES.items() for k in range(count)]


def curves(
    q: Array, qd: Array, load: Array, temperature: Array, since: Array, sign: Array, drive: Array,
    limits: Ranges,
) -> Iterator[Array]:  # fmt: skip
    """Give the curve's columns (T, N) in the order of `names`.

    sign, drive: smooth direction of each joint's motion, and of the torque that its drive gives.
    """
    speed = np.abs(qd)
    kinds = {
        "q": (q, limits.q, False),
        "q sign": (q, limits.q, True),
        "speed": (speed, limits.speed, False),
        "speed sign": (speed, limits.speed, True),
        "load": (load, limits.load, False),
        "load sign": (np.abs(load), _magnitude(limits.load), True),
        "temperature": (temperature, limits.temperature, True),
    }
    for name, count in PIECES.items():
        if name == "since reversal":
            for k in range(count):
                yield sign * ((since >= _SINCE[k]) & (since < _SINCE[k + 1]))
            continue
        if name == "drive sign":
            yield drive
            continue
        x, span, turned = kinds[name]
        unit = (x - span[:, 0]) / (span[:, 1] - span[:, 0]) * (count - 1)
        for k in range(count):
            hat = np.clip(1 - np.abs(np.clip(unit, 0, count - 1) - k), 0, None)
            yield hat * sign if turned else hat * (speed > 0)


def _magnitude(span: Array) -> Array:
    top = np.abs(span).max(axis=1)
    return np.stack([np.zeros_like(top), top], axis=1)
