"""From a recording to what its columns are made of, sample by sample.

Speeds without noise, the torque that each gear carries, and the time since reversals.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, gaussian_filter1d, maximum_filter1d, minimum_filter1d

from ..codegen.columns import columns as term_columns
from ..identify.kernel import Filter, Kernel, batches, segments
from ..identify.rows import GAP, REST, SAMPLES_PER_PERIOD
from ..recordings import Recording
from ..robots.model import TermData
from ..symbolic.terms import CATALOGUE
from .columns import SLACK, WINDUP, Space
from .flexible import Ranges
from .lacking import Lacking
from .physics import Physics, slopes, tilts
from .speed import calm_speeds

Array = NDArray[np.float64]

#: Hz; lowered to an eighth of the recording's rate. DERIVED: where speeds are derived from positions, whose
#: noise is then differentiated twice.
CUTOFF, DERIVED = 15.0, 10.0
#: s and rad: within so little travel for so long a joint is at rest, bouncing and creeping included; what
#: turns round sooner passes through zero speed.
PAUSE, BRISTLE = 0.15, 1e-3
#: Hz; slopes of the rigid body are smooth: they are evaluated at least this often, and interpolated.
_SLOPE_RATE = 100.0
#: s; wind-up and delay are sought in torques no faster than this: noise of the acceleration is in the
#: torque's error, too, and would pass for them (errors in variables).
CALM = 0.04
#: s; a delay in faster ones, too, where noise is at most this share of their changes' squares: smoothing
#: takes the edges off jerks, which may tell most of a delay.
QUICKER, NOISE = (0.02, 0.01), 0.03


@dataclass(frozen=True)
class Setup:
    """What rows are made with. gains (N,) Nm/A; base (B,): parameters of loads and slopes.

    friction (N, 2): Coulomb and viscous, of the torque that is delayed or scaled; limits: ranges of the
    flexible curve (None: it is left out). known: terms whose torque is taken off what was measured.
    lacking: what the model lacks by its form.
    """

    physics: Physics
    space: Space
    gains: Array
    base: Array
    friction: Array
    limits: Ranges | None = None
    known: tuple[TermData, ...] = ()
    lacking: tuple[Lacking, ...] = ()


@dataclass(frozen=True)
class Slopes:
    """The rigid body's slopes along a recording (physics.slopes, and `tilt` of physics.tilts).

    time (K,): s; values: each (K, N, M).
    """

    time: Array
    values: Mapping[str, Array]

    def along(self, time: Array) -> dict[str, Array]:
        """Return each at instants (T,), interpolated, (T, N, M)."""
        return {
            k: between(time, self.time, v.reshape(len(v), -1)).reshape(len(time), *v.shape[1:])
            for k, v in self.values.items()
        }


@dataclass(frozen=True)
class Track:
    """A recording's samples, joints of the model only: (T, N).

    load: torque (Nm) that the gear carries; calm: without what is faster than CALM, load_rate: calm's
    rate; motor: load with the rotor's own inertia; steady: motor without what is faster than CALM; swift:
    motor without what is faster still.
    moving: passing through zero speed is no rest.
    """

    time: Array
    q: Array
    qd: Array
    measured: Array
    temperature: Array
    load: Array
    calm: Array
    load_rate: Array
    motor: Array
    steady: Array
    swift: Array
    since: Array
    moving: NDArray[np.bool_]
    beyond: Array  # (T, L, 2 N): momentum and beta that the model lacks by its form
    held: Array  # (T, N, H): columns that remember, made over the whole recording at once (gears.py)
    slopes: Slopes


def track_of(recording: Recording, setup: Setup) -> tuple[Track, Kernel, float]:
    """Return a recording's samples, the filter for its rows, and its rate, Hz."""
    n = setup.physics.dof
    time = recording.timestamp - recording.timestamp[0]
    rate = recording.rate
    kernel = Kernel(min(DERIVED if recording.qd is None else CUTOFF, rate / SAMPLES_PER_PERIOD))
    everything, speed = recording.q, calm_speeds(recording)
    q, qd = everything[:, :n], speed[:, :n]
    beyond = np.empty((len(q), 0, 2 * n))
    if setup.lacking:
        beyond = np.stack([x.column(everything, speed) for x in setup.lacking], axis=1)
    hot = recording.joint_temperatures
    temperature = np.full_like(q, 30.0) if hot is None else hot[:, :n]
    track = Track(
        time, q, qd, recording.current[:, :n] * setup.gains, temperature,
        *_load(time, q, qd, setup, kernel, rate),
        _since(time, qd), moves(q, rate), beyond, np.empty((len(q), n, 0)), _slopes(time, q, qd, setup),
    )  # fmt: skip
    return replace(track, measured=track.measured - _known(track, setup)), kernel, rate


def _known(track: Track, setup: Setup) -> Array:
    """Torque (T, N) of the terms that the nominal model has beside Coulomb and viscous friction."""
    found = np.zeros_like(track.q)
    for term in setup.known:
        entry, j = CATALOGUE[term.name], term.joint - 1
        values = {n: v for n, v in term.parameters.items() if n not in entry.linear_in}
        for name in entry.linear_in:
            column = sampled(track, slice(None), term.name, name, tuple(values.items()))
            found[:, j] += term.parameters.get(name, 0.0) * column[:, j]
    return found


def _load(
    time: Array, q: Array, qd: Array, setup: Setup, kernel: Kernel, rate: float
) -> tuple[Array, Array, Array, Array, Array, Array]:
    """Return load, calm, load_rate, motor, steady and swift of a `Track`, each (T, N), by the setup."""
    columns, n = setup.physics.regressor, setup.physics.dof
    momentum = columns.combined("momentum", setup.base, q=q, qd=qd)
    rotors = columns.combined("momentum", setup.physics.rotors, q=q, qd=qd)
    beta = columns.combined("beta", setup.base, q=q, qd=qd)
    load, calm, slope, motor, steady, swift = (np.zeros_like(q) for _ in range(6))
    filtering, step = Filter(kernel), 1 / (4 * kernel.cutoff)
    for stretch in segments(time, GAP / rate):
        own = time[stretch]
        at = np.arange(own[0], own[-1], step)
        if len(own) < 8 or len(at) < 2:
            continue
        both, coarse = np.hstack([momentum[stretch], rotors[stretch]]), np.empty((len(at), 2 * n))
        for rows, samples in batches(own, at, kernel):
            _, derived = filtering.weights(own[samples], at[rows], (0, 1))
            coarse[rows] = derived @ both[samples]
        geared = coarse[:, :n] - coarse[:, n:]  # the motor turns its rotor itself, the gear does not
        motor[stretch] = between(own, at, coarse[:, :n]) - beta[stretch]
        load[stretch] = between(own, at, geared) - beta[stretch]
        still = between(at, own, beta[stretch])
        whole = coarse[:, :n] - still
        slow = gaussian_filter1d(whole, CALM / step, axis=0)
        steady[stretch] = between(own, at, slow)
        swift[stretch] = between(own, at, _swift(whole, slow, step))
        total = gaussian_filter1d(geared - still, CALM / step, axis=0)
        calm[stretch] = between(own, at, total)
        slope[stretch] = between(own, at, np.gradient(total, step, axis=0))
    return load, calm, slope, motor, steady, swift


def _swift(torque: Array, calm: Array, step: float) -> Array:
    """Return calm torques (K, N) at a step (s), or those that lack less of the whole where noise allows it.

    What smoothing takes off is noise in most instants and motion in some: its median tells the noise.
    """
    found = calm
    for width in QUICKER:
        quick = gaussian_filter1d(torque, width / step, axis=0)
        noise = 1.4826 * np.median(np.abs(np.diff(quick - calm, axis=0)), axis=0)
        change = np.mean(np.diff(quick, axis=0) ** 2, axis=0)
        found = np.where(noise**2 < NOISE * change, quick, found)
    return np.asarray(found, np.float64)


def moves(q: Array, rate: float) -> NDArray[np.bool_]:
    """Return where joints at angles (T, N) move and do not rest (T, N), at a rate in Hz."""
    width = 2 * round(PAUSE * rate / 2) + 1
    travel = maximum_filter1d(q, width, axis=0) - minimum_filter1d(q, width, axis=0)
    return ~np.asarray(binary_dilation(travel < BRISTLE, np.ones((width, 1), np.bool_)), np.bool_)


def _since(time: Array, qd: Array) -> Array:
    """Seconds since each joint last changed its direction (T, N); rests in between do not count as one."""
    found = np.empty_like(qd)
    for j in range(qd.shape[1]):
        moving = np.flatnonzero(np.abs(qd[:, j]) > REST)
        direction = np.sign(qd[moving, j])
        begins = moving[np.flatnonzero(np.diff(direction, prepend=0.0) != 0)] if len(moving) else moving
        last = np.searchsorted(begins, np.arange(len(time)), "right") - 1
        found[:, j] = np.where(last >= 0, time - time[begins[last]] if len(begins) else 9.0, 9.0)
    return found


def _slopes(time: Array, q: Array, qd: Array, setup: Setup) -> Slopes:
    """Slopes of the links alone; none where no column needs them."""
    if not (setup.space.common or any(c.term in (SLACK, WINDUP) for c in setup.space.own)):
        return Slopes(time, {})
    every = max(1, int(1 / _SLOPE_RATE / max(float(np.median(np.diff(time))), 1e-6)))
    pick = np.unique(np.append(np.arange(0, len(time), every), len(time) - 1))
    found = slopes(setup.physics, setup.base - setup.physics.rotors, q[pick], qd[pick])
    return Slopes(time[pick], {**found, "tilt": tilts(setup.physics, q[pick])})


def remembers(term: str) -> bool:
    """Return whether a column depends on the samples before."""
    return term in (SLACK, WINDUP) or (term in CATALOGUE and bool(CATALOGUE[term].state))


def sampled(
    track: Track, part: slice, term: str, parameter: str, values: tuple[tuple[str, float], ...]
) -> Array:
    """Return a term's column (T, N) along some samples: its torque by a linear parameter."""
    dt = np.diff(track.time, prepend=track.time[0] - np.median(np.diff(track.time)))
    return term_columns(
        term, dict(values), track.q[part], track.qd[part], track.load[part], track.temperature[part], dt[part]
    )[parameter]


def between(at: Array, known: Array, values: Array) -> Array:
    """Interpolate columns (K, C) from instants `known` to `at`."""
    if len(known) == len(at) and np.array_equal(known, at):
        return values
    right = np.clip(np.searchsorted(known, at, "left"), 1, len(known) - 1)
    share = np.clip((at - known[right - 1]) / (known[right] - known[right - 1]), 0, 1)[:, None]
    return np.asarray((1 - share) * values[right - 1] + share * values[right], np.float64)
