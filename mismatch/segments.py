"""Stretches of time in which something is there: a first guess, the likeliest states, what counts as one."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
T = TypeVar("T")

#: Nats that a change of state costs.
SWITCH = 8.0
#: Windows at most, whose runs of neighbours are tried as the first guess.
WINDOWS = 100


@dataclass(frozen=True)
class Sums:
    """Normal equations of k parameters in each of W windows: matrix (W, k, k), right (W, k); rows of each."""

    matrix: Array
    right: Array
    rows: tuple[slice, ...]


def sums_of(columns: Array, weight: Array, target: Array, width: int) -> Sums:
    """Sum the normal equations of target (n, N) by columns (n, N, k) in windows of about `width` rows.

    weight (n, N): of each row and joint.
    """
    weighted = columns * weight[:, :, None]
    starts = np.arange(0, max(len(target) - width // 2, 1), width)
    ends = [*starts[1:].tolist(), len(target)]
    return Sums(
        np.add.reduceat(np.einsum("tji,tjk->tik", weighted, columns), starts),
        np.add.reduceat(np.einsum("tji,tj->ti", weighted, target), starts),
        tuple(slice(a, b) for a, b in zip(starts.tolist(), ends, strict=True)),
    )


def first_guesses(runs: Sequence[Sums], std: Array, most: int) -> list[tuple[int, slice, float]]:
    """Return runs, rows and nats of stretches in which parameters of prior width std (k,) explain most.

    Every stretch of whole windows of a run is tried; nats are of the log marginal likelihood. Best first, and
    none overlaps a better one.
    """
    each = list[tuple[float, int, slice]]()
    for r, sums in enumerate(runs):
        count, k = sums.right.shape
        first, last = np.triu_indices(count)
        until = np.concatenate([np.zeros((1, k, k)), np.cumsum(sums.matrix, axis=0)])
        so_far = np.concatenate([np.zeros((1, k)), np.cumsum(sums.right, axis=0)])
        evidence, _ = marginal(until[last + 1] - until[first], so_far[last + 1] - so_far[first], std)
        spans = zip(first.tolist(), last.tolist(), strict=True)
        each += [
            (nats, r, slice(sums.rows[i].start, sums.rows[j].stop))
            for nats, (i, j) in zip(evidence.tolist(), spans, strict=True)
        ]
    best = apart(sorted(each, key=lambda x: -x[0]), lambda x: x[1:], most)
    return [(r, part, nats) for nats, r, part in best]


def marginal(matrix: Array, right: Array, std: Array) -> tuple[Array, Array]:
    """Return by how many nats (S,) parameters are likelier than none, and the parameters (S, k).

    matrix (S, k, k), right (S, k): normal equations; std (k,): prior widths; of the log marginal likelihood.
    """
    a, b = matrix * np.outer(std, std) + np.eye(len(std)), right * std
    size = np.linalg.solve(a, b[:, :, None])[:, :, 0]
    return 0.5 * np.einsum("ik,ik->i", b, size) - 0.5 * np.linalg.slogdet(a)[1], std * size


def clear_of(handled: Mapping[int, Mask], run: int, rows: slice) -> bool:
    """Return whether a stretch of rows of a run has none in which a load is handled (n,), by run."""
    return run not in handled or not handled[run][rows].any()


def apart(
    best_first: Iterable[T], place: Callable[[T], tuple[int, slice]], most: int | None = None
) -> list[T]:
    """Return those, so many at most, of which none lies over a better one; place: run and rows of each."""
    found, taken = list[T](), list[tuple[int, slice]]()
    for one in best_first:
        if len(found) == most:
            break
        run, part = place(one)
        if all(run != r or part.stop <= p.start or part.start >= p.stop for r, p in taken):
            found.append(one)
            taken.append((run, part))
    return found


def segmented(gain: Array, switch: float = SWITCH) -> Mask:
    """Return the likeliest states (n,) by what each row gains if something is there (n,), nats.

    A change of state costs `switch`, the first state nothing (Viterbi 1967).
    """
    there, away = 0.0, 0.0
    came = np.zeros((len(gain), 2), bool)  # whether the row's state (away, there) was entered at this row
    for t, g in enumerate(gain.tolist()):
        came[t] = away < there - switch, there < away - switch
        away, there = max(away, there - switch), max(there, away - switch) + g
    found = np.empty(len(gain), bool)
    state = there > away
    for t in range(len(gain) - 1, -1, -1):
        found[t] = state
        state ^= bool(came[t, int(state)])
    return found


def stretches(held: Mask) -> list[slice]:
    """Return the stretches of true rows."""
    edges = np.flatnonzero(np.diff(held.astype(np.int8), prepend=0, append=0)).tolist()
    return [slice(a, b) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def joined(held: Mask, shortest: int) -> Mask:
    """Close pauses shorter than so many rows, then drop stretches shorter than that; ends count as pauses."""
    found = held.copy()
    for state in (False, True):
        for part in stretches(found == state):
            inside = state or (part.start > 0 and part.stop < len(held))
            if inside and part.stop - part.start < shortest:
                found[part] = not state
    return found


def two_levels(values: Array, weight: Array) -> tuple[float, float]:
    """Return the two levels, low and high, around which weighted values (n,) lie closest, n at least 2.

    Of sorted values one cut makes the two classes, so every cut is tried.
    """
    order = np.argsort(values)
    x, w = values[order], np.maximum(weight[order], 1e-300)
    mass, moment = np.cumsum(w), np.cumsum(w * x)
    low, high = moment[:-1] / mass[:-1], (moment[-1] - moment[:-1]) / np.cumsum(w[::-1])[-2::-1]
    between = low * moment[:-1] + high * (moment[-1] - moment[:-1])
    k = int(np.argmax(between))
    return float(low[k]), float(high[k])
