"""Known effects that are added to the torques of real recordings, at sizes that a plain model leaves visible."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from residuum.mismatch.candidates import Candidate
from residuum.mismatch.columns import WIDTH, Column, Space, space_of
from residuum.mismatch.evidence import Evidence
from residuum.mismatch.plausibility import SYNCHRONOUS
from residuum.mismatch.proof import joint_moves, rms_where
from residuum.mismatch.rows import make_rows
from residuum.recordings import Recording
from residuum.symbolic.terms import CATALOGUE

Array = NDArray[np.float64]
Added = tuple[Array, ...]  # (n, N) Nm by run

#: Rms of what an effect leaves visible over the residual's.
SIZES = (0.10, 0.20, 0.35, 0.50)
#: effect -> term, parameter, values off every grid.
OWN = {
    "cable_spring": ("spring", "k", ()),
    "stribeck": ("stribeck", "Fs", (("vs", 0.12),)),
    "nonlinear_viscous (quadratic)": ("quadratic", "F2", ()),
    "nonlinear_viscous (cubic)": ("cubic", "F3", ()),
    "nonlinear_viscous (power 0.4)": ("power", "Fp", (("n", 0.4),)),
    "load_dependent_friction": ("load_dependent", "mu", ()),
    "position_dependent_friction": ("position_dependent", "A", (("n", 1.0),)),
}
#: effect -> term, nonlinear value: what friction does at reversals, the whole Coulomb level of it. Its travel
#: (rad) or time (s), off every grid, makes its size; a part of the level, as no gear has it, is not drawn.
REVERSALS = {"presliding_hysteresis": ("presliding", "zs"), "velocity_lag": ("lag", "lag")}
VALUES, NEAR = tuple(float(x) for x in np.geomspace(0.0011, 0.037, 25)), 0.1
#: Effects that the directions of their candidates make.
SHARED = ("encoder_offset", "joint_elasticity", "base_tilt", "time_delay")
#: What only recordings of the healthy robot show besides.
CHANGED = {
    "coulomb_friction": ("coulomb", "Fc", ()), "viscous_friction": ("viscous", "Fv", ()),
    "current_offset": ("offset", "c", ()),
}  # fmt: skip
CHANGED_SHARED = ("payload", "link_inertial", "rotor_inertia", "drive_gain", "torque_ripple")


@dataclass(frozen=True)
class Case:
    """An effect in the recordings. joint: 0-based, None for those that move all."""

    name: str
    joint: int | None
    size: float
    added: Added
    scale: float = 1.0  # of what was drawn

    @property
    def family(self) -> str:
        """What a right answer is called."""
        return self.name.partition(" ")[0]


def columns_of(recordings: Sequence[Recording], evidence: Evidence) -> dict[str, list[Array]]:
    """Return each own effect's filtered column on all joints: effect -> (n, N) by run."""
    effects = OWN | CHANGED if evidence.has_reference else OWN
    own = [Column(t, p, _with_width(t, v)) for t, p, v in effects.values()]
    return dict(zip(effects, _filtered(recordings, evidence, own), strict=True))


def reversals_of(recordings: Sequence[Recording], evidence: Evidence) -> dict[str, list[list[Array]]]:
    """Return what friction of the Coulomb level does at reversals: effect -> by VALUES -> (n, N) by run, Nm."""
    found, level = {}, evidence.setup.friction[:, 0]
    for effect, (term, name) in REVERSALS.items():
        own = [Column(term, "A", _with_width(term, ((name, v),))) for v in VALUES]
        found[effect] = [[x * level for x in runs] for runs in _filtered(recordings, evidence, own)]
    return found


def _filtered(
    recordings: Sequence[Recording], evidence: Evidence, own: Sequence[Column]
) -> list[list[Array]]:
    """Return columns on all joints, (n, N) by run, of each."""
    physics = evidence.setup.physics
    setup = replace(evidence.setup, space=space_of(physics.regressor, tuple(own), ()), limits=None)
    found = [list[Array]() for _ in own]
    for recording in recordings:
        rows = make_rows(recording, setup)
        for k, runs in enumerate(found):
            at = [len(setup.space.seen[j]) + k for j in range(physics.dof)]
            runs.append(np.stack([rows.columns[j][:, a] for j, a in enumerate(at)], axis=1))
    return found


def _with_width(term: str, values: tuple[tuple[str, float], ...]) -> tuple[tuple[str, float], ...]:
    return (*values, ("width", WIDTH)) if "width" in CATALOGUE[term].parameters else values


def cases(
    evidence: Evidence,
    columns: dict[str, list[Array]],
    reversals: dict[str, list[list[Array]]],
    left: Sequence[Array],
    repeats: int,
    seed: int,
    whole: bool,
) -> list[Case]:
    """Draw every effect at every size, on joints at random; whole: sizes are those of all of it."""
    rng, found = np.random.default_rng(seed), []
    sight = _Sight(evidence, left, whole)
    effects = (*SHARED, *CHANGED_SHARED) if evidence.has_reference else SHARED
    shared = {name: some for name in effects if (some := _possible(evidence, name, sight))}
    joints = range(evidence.setup.space.dof)
    ratios = {
        name: np.array([[sight.ratio(_only(runs, j)) for j in joints] for runs in by_value])
        for name, by_value in reversals.items()
    }
    for size in SIZES:
        for name, by_run in columns.items():
            for j in rng.permutation(joints)[:repeats]:
                found.append(_scaled(name, int(j), size, _only(by_run, j), sight))
        for name, by_value in ratios.items():
            near = {int(j): k for k, j in np.argwhere(np.abs(np.log(by_value / size)) < NEAR)}
            for j in rng.permutation(list(near))[:repeats]:
                found.append(Case(name, int(j), size, tuple(_only(reversals[name][near[int(j)]], j))))
        for name, some in shared.items():
            order = rng.permutation(len(some))
            for k in range(repeats):
                c = some[order[k % len(some)]]
                vector = _mixed(evidence, c, rng)
                case = _scaled(name, c.joint, size, torques(evidence, vector), sight)
                if name != "time_delay" or case.scale * vector.max() >= SYNCHRONOUS:
                    found.append(case)
    return found


def _only(runs: Sequence[Array], j: int) -> list[Array]:
    """Return torques (n, N) by run on joint j alone."""
    return [np.where(np.arange(x.shape[1]) == j, x, 0.0) for x in runs]


def _possible(evidence: Evidence, effect: str, sight: "_Sight") -> list[Candidate]:
    """Return an effect's candidates that are visible at the largest size within twice their prior width.

    No gear is as soft as a light wrist would need, and free masses take nearly all of an encoder's offset.
    A gear that swings does so as its stiffness makes it and cannot be brought to a size: wind-up is slow here.
    """
    found = []
    for c in (c for c in evidence.found.each if c.effect == effect and not c.whole):
        if effect == "time_delay" and c.joint is not None:  # a clock's, which moves all
            continue
        directions = evidence.found.directions.take(c.columns)
        torque = torques(evidence, np.asarray(directions.vectors @ (2 * directions.std)))
        if sight.ratio(torque) >= SIZES[-1]:
            found.append(c)
    return found


def _mixed(evidence: Evidence, c: Candidate, rng: np.random.Generator) -> Array:
    """Return an effect's parameters: its directions at random, or those of a clock, which move all alike."""
    vectors = evidence.found.directions.vectors[:, list(c.columns)].toarray()
    if c.effect == "time_delay":
        return np.asarray(vectors.sum(axis=1))
    return np.asarray(vectors @ (np.abs(rng.standard_normal(len(c.columns))) + 0.2))


def torques(evidence: Evidence, vector: Array) -> list[Array]:
    """Return what parameters (P,) make of each run (n, N), Nm."""
    space = evidence.setup.space
    return [
        np.stack([r.columns[j] @ vector[space.indices[j]] for j in range(space.dof)], axis=1)
        for r in evidence.runs
    ]


def plain_columns(space: Space, j: int) -> list[int]:
    """Return where base parameters, offset, Coulomb and viscous friction stand in joint j's rows."""
    start = len(space.seen[j])
    own = [start + k for k, c in enumerate(space.own) if c.usual or c.term == "offset"]
    return [*range(start), *own]


def _plain_rows(evidence: Evidence, j: int) -> Array:
    """Return joint j's plain columns (n, P) along all runs."""
    plain = plain_columns(evidence.setup.space, j)
    return np.concatenate([r.columns[j][:, plain] for r in evidence.runs])


def _moves_anywhere(evidence: Evidence) -> NDArray[np.bool_]:
    """Return the rows (n, N) of all runs, the reference's too, in which a joint moves."""
    return joint_moves(replace(evidence, observed=(True,) * len(evidence.runs)))


def plain_left(evidence: Evidence) -> list[Array]:
    """Return what base parameters, offset, Coulomb and viscous friction leave of each run (n, N), Nm.

    Least squares of each joint by itself, over all rows in which it moves.
    """
    moving = _moves_anywhere(evidence)
    left = np.concatenate([r.torque for r in evidence.runs])
    for j in range(evidence.setup.space.dof):
        columns, used = _plain_rows(evidence, j), moving[:, j]
        left[:, j] -= columns @ np.linalg.lstsq(columns[used], left[used, j], rcond=None)[0]
    return np.split(left, np.cumsum([len(r) for r in evidence.runs])[:-1])


class _Sight:
    """How large torques are beside the residuals where joints move.

    Of all of them (whole), or of what a baseline of `plain_columns`, free on each joint, leaves.
    """

    def __init__(self, evidence: Evidence, left: Sequence[Array], whole: bool) -> None:
        self.moving, self.bases = _moves_anywhere(evidence), list[Array]()
        self.noise = rms_where(left, self.moving)
        for j in range(0 if whole else evidence.setup.space.dof):
            self.bases.append(
                np.linalg.svd(_plain_rows(evidence, j)[self.moving[:, j]], full_matrices=False)[0]
            )

    def ratio(self, torque: Sequence[Array]) -> float:
        """Return the largest ratio of rms over the joints."""
        seen = np.concatenate(torque)
        for j, basis in enumerate(self.bases):
            moving = self.moving[:, j]
            seen[moving, j] -= basis @ (basis.T @ seen[moving, j])
        return float(np.max(rms_where([seen], self.moving) / self.noise))


def _scaled(name: str, joint: int | None, size: float, torque: Sequence[Array], sight: _Sight) -> Case:
    """Bring an effect to a size."""
    ratio = sight.ratio(torque)
    scale = size / max(ratio, 1e-12)
    return Case(name, joint, size, tuple(x * scale for x in torque), scale)
