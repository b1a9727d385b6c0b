"""From a recording to filtered regression rows: torque = columns @ parameters, without accelerations.

The momentum form, dp/dt - beta + terms = motor torque, is linear in the parameters. Both sides pass the
same low-pass, and the derivative of p acts on the kernel (see kernel.py). Rows stand four to a period of
the cutoff; what lies closer together carries no more information.
"""

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..codegen.regressors import Regressor
from ..errors import InputError
from ..recordings import Recording, speeds
from .kernel import Filter, Kernel, batches, portions, segments

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Form = Literal["momentum", "inverse-dynamics"]

#: rad/s; slower than this a joint rests, and its friction is anything between plus and minus Coulomb.
REST = 0.01
#: A step of more than this many median steps is a gap, as in the audit.
GAP = 5.0
#: The kernel needs this many samples a period of its cutoff.
SAMPLES_PER_PERIOD = 8.0
#: Rows whose regressors are evaluated together.
_PORTION = 400


@dataclass(frozen=True)
class Recipe:
    """How rows are made.

    gains (N,): Nm/A. cutoff: Hz, lowered to an eighth of the recording's rate when that is less. form:
    "momentum" (no acceleration) or "inverse-dynamics" (positions differentiated twice by the kernel).
    base (B,): the parameters whose gravity is the load of load-dependent terms.
    """

    regressor: Regressor
    gains: tuple[float, ...]
    cutoff: float = 10.0
    order: int = 4
    zero_phase: bool = True
    form: Form = "momentum"
    base: tuple[float, ...] = ()

    def kernel(self, rate: float) -> Kernel:
        """Return the filter for a recording of some rate (Hz)."""
        return Kernel(min(self.cutoff, rate / SAMPLES_PER_PERIOD), self.order, self.zero_phase)

    @property
    def needs_temperature(self) -> bool:
        """Whether a term's column depends on the joint's temperature."""
        return any(name == "temperature" for name, _ in self.regressor.parts["terms"].arguments)

    @property
    def needs_load(self) -> bool:
        """Whether a term's column depends on the torque that the joint carries."""
        return any(name == "load" for name, _ in self.regressor.parts["terms"].arguments)

    def indices(self, joint: int) -> Indices:
        """Return which of the B + K parameters joint (0-based) sees, ascending."""
        parts = self.regressor.parts
        rigid = {c for name in ("momentum", "beta") for r, c in parts[name].places if r == joint}
        own = {len(self.regressor.base) + c for r, c in parts["terms"].places if r == joint}
        return np.array(sorted(rigid | own), dtype=np.int64)


@dataclass(frozen=True)
class Rows:
    """n filtered rows of N joints.

    time (n,) s; torque (n, N) Nm, gain times current; columns: a matrix (n, P_i) a joint, whose parameters
    are Recipe.indices(i); moving (n, N): whether the joint moves over most of the kernel; starts: indices
    at which a gap-free stretch begins; step: seconds between rows.
    """

    time: Array
    torque: Array
    moving: NDArray[np.bool_]
    columns: tuple[Array, ...]
    starts: tuple[int, ...]
    step: float

    def __len__(self) -> int:
        return len(self.time)

    def stretches(self) -> list[slice]:
        """Return the gap-free stretches."""
        edges = [*self.starts, len(self)]
        return [slice(a, b) for a, b in pairwise(edges)]


def make_rows(recording: Recording, recipe: Recipe) -> Rows:
    """Filter a clean recording's columns and torques.

    Stretches shorter than the kernel give nothing, so there may be no row at all.
    Raises InputError when there are fewer joints than in the model, or no temperatures that a term needs.
    """
    n = recipe.regressor.dof
    if recording.joints < n:
        raise InputError(
            f"{recording.name}: has {recording.joints} joints, the model {n}; give --dof {recording.joints}"
        )
    if recipe.needs_temperature and recording.joint_temperatures is None:
        raise InputError(
            f"{recording.name}: has no joint_temperatures; leave the temperature term out or record them"
        )
    time = recording.timestamp - recording.timestamp[0]
    rate, times = recording.rate, 1 if recipe.form == "momentum" else 2
    kernel = recipe.kernel(rate)
    step = 1 / (4 * kernel.cutoff)
    pieces: list[_Piece] = []
    starts, count = [], 0
    for stretch in segments(time, GAP / rate):
        for k, (at, part) in enumerate(portions(time, stretch, kernel, step, _PORTION, times)):
            if k == 0:
                starts.append(count)
            motion = recording.take(part)
            pieces.append((at, *_FORMS[recipe.form](motion, time[part], at, recipe, kernel)))
            count += len(at)
    return _joined(pieces, tuple(starts), step, recipe, float(recording.timestamp[0]))


#: Instants (n,), torque and moving share (n, 2 N), columns.
_Piece = tuple[Array, Array, list[Array]]


def _momentum_form(
    motion: Recording, time: Array, at: Array, recipe: Recipe, kernel: Kernel
) -> tuple[Array, list[Array]]:
    n, regressor = recipe.regressor.dof, recipe.regressor
    q, qd = motion.q[:, :n], speeds(motion)[:, :n]
    momentum = regressor.values("momentum", q=q, qd=qd)
    beta = regressor.values("beta", q=q, qd=qd)
    others = np.hstack([beta, terms(motion, q, qd, recipe), _measured(motion.current[:, :n], qd, recipe)])
    moved, kept = np.empty((len(at), momentum.shape[1])), np.empty((len(at), others.shape[1]))
    filtering = Filter(kernel)
    for rows, samples in batches(time, at, kernel):
        smooth, slope = filtering.weights(time[samples], at[rows])
        moved[rows] = slope @ momentum[samples]
        kept[rows] = smooth @ others[samples]
    width = beta.shape[1]
    rigid = [("momentum", moved, 1.0), ("beta", kept[:, :width], -1.0)]
    return kept[:, -2 * n :], _placed(recipe, rigid, kept[:, width : -2 * n])


def _measured(current: Array, qd: Array, recipe: Recipe) -> Array:
    """Torques and whether each joint moves, side by side (T, 2 N)."""
    return np.hstack([current * np.array(recipe.gains), np.abs(qd) > REST])


def _inverse_form(
    motion: Recording, time: Array, at: Array, recipe: Recipe, kernel: Kernel
) -> tuple[Array, list[Array]]:
    n, regressor = recipe.regressor.dof, recipe.regressor
    inside = (time >= time[0] + kernel.support) & (time <= time[-1] - kernel.ahead)
    q, qd, qdd = (np.empty((int(inside.sum()), n)) for _ in range(3))
    filtering, own, current = Filter(kernel), time[inside], np.empty_like(q)
    for rows, samples in batches(time, own, kernel):
        found = filtering.weights(time[samples], own[rows], (0, 1, 2))
        q[rows], qd[rows], qdd[rows] = (w @ motion.q[samples, :n] for w in found)
        current[rows] = found[0] @ motion.current[samples, :n]
    everything = np.hstack(
        [
            regressor.values("torque", q=q, qd=qd, qdd=qdd),
            terms(motion.take(inside), q, qd, recipe),
            _measured(current, qd, recipe),
        ]
    )
    kept = np.empty((len(at), everything.shape[1]))
    for rows, samples in batches(own, at, kernel):
        kept[rows] = filtering.weights(own[samples], at[rows], (0,))[0] @ everything[samples]
    width = len(regressor.parts["torque"].places)
    return kept[:, -2 * n :], _placed(recipe, [("torque", kept[:, :width], 1.0)], kept[:, width : -2 * n])


_FORMS = {"momentum": _momentum_form, "inverse-dynamics": _inverse_form}


def terms(motion: Recording, q: Array, qd: Array, recipe: Recipe) -> Array:
    """Return the unfiltered term columns that are not fixed zeros, (T, values)."""
    hot = motion.joint_temperatures
    temperature = np.zeros_like(q) if hot is None else hot[:, : q.shape[1]]
    load = gravity(recipe, q) if recipe.needs_load else np.zeros_like(q)
    return recipe.regressor.values("terms", q=q, qd=qd, load=load, temperature=temperature)


def gravity(recipe: Recipe, q: Array) -> Array:
    """Return the gravity torque (T, N) in Nm of the recipe's base parameters: minus beta at rest."""
    return -recipe.regressor.combined("beta", np.array(recipe.base), q=q, qd=np.zeros_like(q))


def _placed(recipe: Recipe, rigid: list[tuple[str, Array, float]], term_values: Array) -> list[Array]:
    """Sum the values of each joint's columns into its matrix (n, P_i)."""
    regressor, matrices = recipe.regressor, []
    for joint in range(regressor.dof):
        position = {int(p): k for k, p in enumerate(recipe.indices(joint))}
        matrix = np.zeros((len(term_values), len(position)))
        for part, values, sign in rigid:
            for k, (row, column) in enumerate(regressor.parts[part].places):
                if row == joint:
                    matrix[:, position[column]] += sign * values[:, k]
        for k, (row, column) in enumerate(regressor.parts["terms"].places):
            if row == joint:
                matrix[:, position[len(regressor.base) + column]] += term_values[:, k]
        matrices.append(matrix)
    return matrices


def _joined(
    pieces: list[_Piece], starts: tuple[int, ...], step: float, recipe: Recipe, origin: float
) -> Rows:
    n = recipe.regressor.dof
    if not pieces:
        empty = tuple(np.empty((0, len(recipe.indices(i)))) for i in range(n))
        return Rows(np.empty(0), np.empty((0, n)), np.empty((0, n), bool), empty, (), step)
    columns = tuple(np.vstack([p[2][i] for p in pieces]) for i in range(n))
    time = np.concatenate([p[0] for p in pieces]) + origin
    measured = np.vstack([p[1] for p in pieces])
    return Rows(time, measured[:, :n], measured[:, n:] > 0.5, columns, starts, step)
