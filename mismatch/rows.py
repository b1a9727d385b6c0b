"""From recordings to filtered rows: torque = columns @ parameters, each joint with its own matrix.

Both sides pass the same zero-phase low-pass, and momentum is differentiated by the kernel
(identify/kernel.py). Rows stand four to a period of the cutoff.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..codegen.columns import columns as term_columns
from ..identify.kernel import Filter, Kernel, batches, portions, segments
from ..identify.rows import GAP, REST
from ..recordings import Recording
from . import signs
from .columns import DELAYS, LATE, LATE_FRICTION, REPEAT, WIDTH, Space
from .fast import Fast, fast_band
from .flexible import curves
from .gears import held
from .lacking import Lacking
from .track import Setup, Track, between, remembers, sampled, track_of

Array = NDArray[np.float64]

#: Rows whose samples are worked on together.
_PORTION = 300
#: Nm; a drive's torque within this has no sign.
DRIVE = 0.02
#: What rows hold by joint, (n, N).
_OF_JOINTS = ("torque", "moving", "sliding", "q", "qd", "load", "temperature", "since")


@dataclass(frozen=True)
class Rows:
    """n rows of a recording: time (n,) s; torque (n, N) Nm; columns[j] (n, P_j) in the space's order.

    moving, sliding (n, N): shares of the kernel in which the joint is not at rest, and is faster than REST.
    q, qd, load, temperature, since (n, N): smoothed state there. step: s.
    """

    time: Array
    torque: Array
    columns: tuple[Array, ...]
    moving: Array
    sliding: Array
    q: Array
    qd: Array
    load: Array
    temperature: Array
    since: Array
    step: float
    fast: Fast | None = None

    def __len__(self) -> int:
        return len(self.time)

    @property
    def arm_moves(self) -> NDArray[np.bool_]:
        """Rows (n,) in whose kernel some joint moves most of the time."""
        return np.asarray(self.moving.max(axis=1) > 0.5, np.bool_)


def make_rows(recording: Recording, setup: Setup) -> Rows:
    """Filter a clean recording. There may be no row at all: stretches shorter than the kernel give none."""
    track, kernel, rate = track_of(recording, setup)
    track = replace(track, held=held(track, setup))
    step = 1 / (4 * kernel.cutoff)
    pieces = list[Rows]()
    for stretch in segments(track.time, GAP / rate):
        for at, part in portions(track.time, stretch, kernel, step, _PORTION):
            pieces.append(_filtered(track, part, at, setup, kernel))
    origin = float(recording.timestamp[0])
    rows = _joined(pieces, step, setup.space, origin)
    return replace(rows, fast=_fast(track, setup, kernel, origin))


def kept(rows: Rows, keep: NDArray[np.bool_] | slice) -> Rows:
    """Return some rows (n,)."""
    some: dict[str, Any] = {name: getattr(rows, name)[keep] for name in ("time", *_OF_JOINTS)}
    return replace(rows, columns=tuple(x[keep] for x in rows.columns), **some)


def _fast(track: Track, setup: Setup, kernel: Kernel, origin: float) -> Fast | None:
    own = [c for c in setup.space.own if c.term == "ripple"]
    if not own:
        return None
    columns = [sampled(track, slice(None), c.term, c.parameter, c.values) for c in own]
    found = fast_band(track.time, track.measured, columns, track.qd, track.since, kernel.cutoff)
    return replace(found, time=tuple(t + origin for t in found.time))


def _own(track: Track, part: slice, setup: Setup) -> Array:
    """Own columns of some samples (T, N, K)."""
    found, place = list[Array](), 0
    cache: dict[tuple[str, tuple[tuple[str, float], ...]], dict[str, Array]] = {}
    direction = signs.sign(track.qd[part], WIDTH)
    built = _built_up(track, part, setup)
    friction, slides, swift = _friction(track, part, setup, built), built * direction, track.swift[part]
    drive = track.motor[part] + friction
    for c in setup.space.own:
        if c.term == "gain":
            found.append(-drive)
        elif c.term == "curve":
            continue
        elif c.term == REPEAT:
            found.append(np.zeros_like(direction))  # of what other recordings leave: evidence.py
        elif c.term == LATE:
            around = c.value["around"]
            found.append(_late(track, part, swift, around, True) + _late(track, part, friction, around))
        elif c.term == LATE_FRICTION:
            found.append(_late(track, part, friction, c.value["around"]))
        elif remembers(c.term):
            found.append(track.held[part, :, place])
            place += 1
        else:
            key = c.term, c.values
            if key not in cache:
                cache[key] = term_columns(
                    c.term, dict(c.values), track.q[part], track.qd[part], track.load[part],
                    track.temperature[part], np.ones(len(direction)),
                )  # fmt: skip
            found.append(cache[key][c.parameter] * (slides if c.builds_up else 1.0))
    if setup.limits is not None:
        found += curves(
            track.q[part], track.qd[part], track.load[part], track.temperature[part], track.since[part],
            direction, signs.sign(drive, DRIVE), setup.limits,
        )  # fmt: skip
    return np.stack(found, axis=2)


def _friction(track: Track, part: slice, setup: Setup, built: Array) -> Array:
    """Friction (T, N) that the setup expects, Nm; built (T, N): the part of its level that pushes."""
    return np.asarray(setup.friction[:, 0] * built + setup.friction[:, 1] * track.qd[part], np.float64)


def _built_up(track: Track, part: slice, setup: Setup) -> Array:
    """Part (T, N), -1..1, of friction's level that pushes: it builds up over a short travel."""
    built = signs.sign(track.qd[part], WIDTH)
    for k, column in enumerate(c for c in setup.space.own if remembers(c.term)):
        if column.short:
            built = built + track.held[part, :, k]
    return built


def _late(track: Track, part: slice, torque: Array, delay: float, centred: bool = False) -> Array:
    """Return what a torque (T, N) differs by when it comes late, per second of delay.

    centred: as its slope, which has nothing in common with the noise that the rows themselves have of it.
    """
    t, ahead = track.time[part], 0.5 * delay if centred else 0.0
    early, late = (between(np.clip(x, t[0], t[-1]), t, torque) for x in (t + ahead, t + ahead - delay))
    return np.asarray((late - early) / delay, np.float64)


def _common(track: Track, part: slice, setup: Setup) -> tuple[Array, Array]:
    """Columns that act on all joints: what is differentiated and what is kept, each (T, N, S)."""
    n, t = setup.physics.dof, track.time[part]
    slope = track.slopes.along(t)
    load, rate = track.calm[part], track.load_rate[part]
    moved, kept = list[Array](), list[Array]()
    for dq, dv in ((None, None), (-load, -rate)):
        for j in range(n):
            by_q = 1.0 if dq is None else dq[:, j : j + 1]
            p, b = slope["pq"][:, :, j] * by_q, slope["bq"][:, :, j] * by_q
            if dv is not None:
                p = p + slope["pv"][:, :, j] * dv[:, j : j + 1]
                b = b + slope["bv"][:, :, j] * dv[:, j : j + 1]
            moved.append(p)
            kept.append(-b)
    turned = slope["tilt"]
    for k in range(2):
        moved.append(np.zeros_like(load))
        kept.append(turned[:, :, k])
    # what friction does at reversals depends on more than the clock, so it gets a coefficient of its own
    friction = _friction(track, part, setup, _built_up(track, part, setup))
    for torque, noisy in ((track.steady[part], True), (friction, False), (track.swift[part], True)):
        for delay in DELAYS:
            moved.append(np.zeros_like(load))
            kept.append(_late(track, part, torque, delay, noisy))
    for k in range(len(setup.lacking)):
        moved.append(track.beyond[part, k, :n])
        kept.append(-track.beyond[part, k, n:])
    return np.stack(moved, axis=2), np.stack(kept, axis=2)


def common_names(dof: int, lacking: Sequence[Lacking] = ()) -> tuple[str, ...]:
    """Return the names of the columns of `_common`; lacking: what the model lacks by its form."""
    joints = range(1, dof + 1)
    per_joint = [f"{kind}{j}" for kind in ("encoder", "elasticity") for j in joints]
    return (
        *per_joint,
        "roll",
        "pitch",
        *(f"{x}{k + 1}" for x in ("delay", "reversal", "jerk") for k in range(len(DELAYS))),
        *(x.name for x in lacking),
    )


def _filtered(track: Track, part: slice, at: Array, setup: Setup, kernel: Kernel) -> Rows:
    physics, n = setup.physics, setup.physics.dof
    q, qd, count = track.q[part], track.qd[part], part.stop - part.start
    momentum = physics.regressor.values("momentum", q=q, qd=qd)
    beta = physics.regressor.values("beta", q=q, qd=qd)
    own = _own(track, part, setup)
    states = [q, qd, track.load[part], track.temperature[part], np.minimum(track.since[part], 9.0)]
    motion = [track.moving[part], np.abs(qd) > REST]
    plain = [beta, own.reshape(count, -1), track.measured[part], *motion, *states]
    shared_moved, shared_kept = (
        _common(track, part, setup) if setup.space.common else (np.empty((count, n, 0)),) * 2
    )
    slow = np.hstack([momentum, shared_moved.reshape(count, -1)])
    fast = np.hstack([*plain, shared_kept.reshape(count, -1)])
    moved, kept = np.empty((len(at), slow.shape[1])), np.empty((len(at), fast.shape[1]))
    filtering = Filter(kernel)
    for rows, samples in batches(track.time[part], at, kernel):
        smooth, slope = filtering.weights(track.time[part][samples], at[rows])
        moved[rows] = slope @ slow[samples]
        kept[rows] = smooth @ fast[samples]
    return _placed(at, moved, kept, momentum.shape[1], beta.shape[1], setup)


def _placed(at: Array, moved: Array, kept: Array, m: int, b: int, setup: Setup) -> Rows:
    space, parts = setup.space, setup.physics.regressor.parts
    n, k, s = space.dof, len(space.own), len(space.common)
    own = kept[:, b : b + n * k].reshape(-1, n, k)
    after = b + n * k
    torque, moving, sliding, q, qd, load, temperature, since = (
        kept[:, after + i * n : after + (i + 1) * n] for i in range(8)
    )
    rows = len(at)
    common = moved[:, m:].reshape(rows, n, s) + kept[:, after + 8 * n :].reshape(rows, n, s)
    matrices = []
    for j in range(n):
        position = {p: i for i, p in enumerate(space.seen[j])}
        rigid = np.zeros((len(at), len(position)))
        for values, part, sign in ((moved, "momentum", 1.0), (kept, "beta", -1.0)):
            for i, (row, column) in enumerate(parts[part].places):
                if row == j:
                    rigid[:, position[column]] += sign * values[:, i]
        matrices.append(np.hstack([rigid, own[:, j], common[:, j]]))
    return Rows(at, torque, tuple(matrices), moving, sliding, q, qd, load, temperature, since, 0.0)


def _joined(pieces: list[Rows], step: float, space: Space, origin: float) -> Rows:
    if not pieces:
        none = np.empty((0, space.dof))
        empty = tuple(np.empty((0, len(ix))) for ix in space.indices)
        return Rows(np.empty(0), none, empty, none, none, none, none, none, none, none, step)
    joined: dict[str, Any] = {name: np.vstack([getattr(p, name) for p in pieces]) for name in _OF_JOINTS}
    columns = tuple(np.vstack([p.columns[j] for p in pieces]) for j in range(space.dof))
    time = np.concatenate([p.time for p in pieces]) + origin
    return Rows(time, columns=columns, step=step, **joined)
