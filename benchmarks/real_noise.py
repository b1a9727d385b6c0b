"""Known effects in real noise: added to real recordings of a UR10e, then named by explain's own steps.

python benchmarks/real_noise.py RECORDINGS/unloaded_*.csv [--robot ur10e] [--repeats 2] [--seed 1]

What the recordings lack by themselves is found first and taken off (masses and ripple stay in the model).
Then one effect at a time is added to the filtered torque of every run, with nonlinear values that stand on
no grid. Its size is the rms of what base parameters, offset, Coulomb and viscous friction leave of it
(--whole: of all of it) over the residual's rms, both where the joint moves.
Right: the first new name is of the effect's family, on its joint where it has one. Payloads, links and rotors
are not among them: without a reference the base parameters of this arm are free, and hold them; nor are
asymmetries of friction, which in motion are offsets.
"""

import argparse
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from residuum.mismatch.candidates import Candidate
from residuum.mismatch.columns import WIDTH, Column, space_of
from residuum.mismatch.evidence import Evidence, gather, renewed, residual
from residuum.mismatch.judging import Judged, judge
from residuum.mismatch.naming import chosen, nuisance, reweighed
from residuum.mismatch.proof import joint_moves, rms_where
from residuum.mismatch.refit import parameters
from residuum.mismatch.rows import make_rows
from residuum.recordings import Recording, read
from residuum.recordings.audit import clean
from residuum.robots import load_robot
from residuum.symbolic.nominal import nominal_model
from residuum.symbolic.terms import CATALOGUE

Array = NDArray[np.float64]
Added = tuple[Array, ...]  # (n, N) Nm by run

SIZES = (0.10, 0.20, 0.35, 0.50)
#: facts of the crude baseline: plain leave-one-run-out on such logs, 16 effects.
CRUDE = {0.10: (25, 11), 0.20: (62, 12), 0.35: (90, 5), 0.50: (99, 1)}

#: Nm; what moves no more than this is not there.
NOTHING = 1e-9

#: effect -> term, parameter, values off every grid.
OWN = {
    "cable_spring": ("spring", "k", ()),
    "stribeck": ("stribeck", "Fs", (("vs", 0.12),)),
    "nonlinear_viscous (quadratic)": ("quadratic", "F2", ()),
    "nonlinear_viscous (cubic)": ("cubic", "F3", ()),
    "nonlinear_viscous (power 0.4)": ("power", "Fp", (("n", 0.4),)),
    "load_dependent_friction": ("load_dependent", "mu", ()),
    "position_dependent_friction": ("position_dependent", "A", (("n", 1.0),)),
    "presliding_hysteresis": ("presliding", "A", (("zs", 0.008),)),
    "velocity_lag": ("lag", "A", (("lag", 0.009),)),
}
#: effect -> the candidate whose directions make it.
SHARED = ("encoder_offset", "joint_elasticity", "base_tilt", "time_delay")


@dataclass(frozen=True)
class Case:
    """An effect in the recordings. joint: 0-based, None for those that move all."""

    name: str
    joint: int | None
    size: float
    added: Added

    @property
    def family(self) -> str:
        """What a right answer is called."""
        return self.name.partition(" ")[0]


def columns_of(recordings: Sequence[Recording], evidence: Evidence) -> dict[str, list[Array]]:
    """Return each own effect's filtered column on all joints: effect -> (n, N) by run."""
    own = tuple(Column(t, p, _with_width(t, v)) for t, p, v in OWN.values())
    physics = evidence.setup.physics
    setup = replace(evidence.setup, space=space_of(physics.regressor, own, ()), limits=None)
    found: dict[str, list[Array]] = {name: [] for name in OWN}
    for recording in recordings:
        rows = make_rows(recording, setup)
        for k, name in enumerate(OWN):
            at = [len(setup.space.seen[j]) + k for j in range(physics.dof)]
            found[name].append(np.stack([rows.columns[j][:, a] for j, a in enumerate(at)], axis=1))
    return found


def _with_width(term: str, values: tuple[tuple[str, float], ...]) -> tuple[tuple[str, float], ...]:
    return (*values, ("width", WIDTH)) if "width" in CATALOGUE[term].parameters else values


def cases(
    evidence: Evidence,
    columns: dict[str, list[Array]],
    left: Sequence[Array],
    repeats: int,
    seed: int,
    whole: bool,
) -> list[Case]:
    """Draw every effect at every size, on joints at random; whole: sizes are those of all of it."""
    rng, found = np.random.default_rng(seed), []
    noise = _rms(left, evidence)
    see = (lambda x: x) if whole else _Visible(evidence).of
    shared = {name: _seen(evidence, name) for name in SHARED}
    for size in SIZES:
        for name, by_run in columns.items():
            for j in rng.permutation(evidence.setup.space.dof)[:repeats]:
                only = [np.where(np.arange(x.shape[1]) == j, x, 0.0) for x in by_run]
                found.append(_scaled(name, int(j), size, only, see(only), noise, evidence))
        for name, some in shared.items():
            order = rng.permutation(len(some))
            for k in range(repeats):
                c = some[order[k % len(some)]]
                torque = _torques(evidence, _mixed(evidence, c, rng))
                found.append(_scaled(name, c.joint, size, torque, see(torque), noise, evidence))
    return found


def _seen(evidence: Evidence, effect: str) -> list[Candidate]:
    """Return an effect's candidates that do anything here: an offset of the base joint's encoder does not."""
    some = [c for c in evidence.found.each if c.effect == effect]
    torques = ([np.abs(x).max() for x in _torques(evidence, _mixed(evidence, c))] for c in some)
    return [c for c, torque in zip(some, torques, strict=True) if max(torque) > NOTHING]


def _mixed(evidence: Evidence, c: Candidate, rng: np.random.Generator | None = None) -> Array:
    """Return an effect's parameters: its directions at random, or those of a clock, which move all alike."""
    vectors = evidence.found.directions.vectors[:, list(c.columns)].toarray()
    if rng is None or c.effect == "time_delay":
        return np.asarray(vectors.sum(axis=1))
    return np.asarray(vectors @ (np.abs(rng.standard_normal(len(c.columns))) + 0.2))


def _torques(evidence: Evidence, vector: Array) -> list[Array]:
    space = evidence.setup.space
    return [
        np.stack([r.columns[j] @ vector[space.indices[j]] for j in range(space.dof)], axis=1)
        for r in evidence.runs
    ]


def _rms(values: Sequence[Array], evidence: Evidence) -> Array:
    return rms_where(values, joint_moves(evidence))


class _Visible:
    """What a baseline of free base parameters, offset, Coulomb and viscous friction leaves where joints move."""

    def __init__(self, evidence: Evidence) -> None:
        self.moving, self.bases = joint_moves(evidence), []
        for j in range(evidence.setup.space.dof):
            columns = np.concatenate([r.columns[j][:, self._plain(evidence, j)] for r in evidence.runs])
            self.bases.append(np.linalg.svd(columns[self.moving[:, j]], full_matrices=False)[0])

    @staticmethod
    def _plain(evidence: Evidence, j: int) -> list[int]:
        space = evidence.setup.space
        start = len(space.seen[j])
        own = [start + k for k, c in enumerate(space.own) if c.usual or c.term == "offset"]
        return [*range(start), *own]

    def of(self, torque: Sequence[Array]) -> list[Array]:
        whole = np.concatenate(torque)
        for j, basis in enumerate(self.bases):
            moving = self.moving[:, j]
            whole[moving, j] -= basis @ (basis.T @ whole[moving, j])
        return np.split(whole, np.cumsum([len(x) for x in torque])[:-1])


def _scaled(
    name: str,
    joint: int | None,
    size: float,
    torque: Sequence[Array],
    visible: Sequence[Array],
    noise: Array,
    evidence: Evidence,
) -> Case:
    """Bring an effect to a size: the largest ratio of its visible rms to the residual's over the joints."""
    ratio = float(np.max(_rms(visible, evidence) / noise))
    return Case(name, joint, size, tuple(x * size / max(ratio, 1e-12) for x in torque))


def answer(evidence: Evidence, known: Judged, case: Case) -> tuple[str, bool]:
    """Return the first new name and whether its joint is right."""
    runs = tuple(replace(r, torque=r.torque + x) for r, x in zip(evidence.runs, case.added, strict=True))
    changed = reweighed(replace(evidence, runs=runs), known.model)
    judged = judge(changed, known=known, most=1)
    found = [a for a in judged.accepted if a.is_finding]
    if not found:
        return "", True
    c = found[0].score.candidate
    return c.effect, c.joint == case.joint or case.joint is None


def everything(evidence: Evidence, known: Judged | None = None) -> Judged:
    """Judge until nothing more is found: what the recordings lack by themselves."""
    known = known or judge(evidence)
    while (more := judge(reweighed(evidence, known.model), known=known)).accepted:
        known = replace(more, accepted=known.accepted + more.accepted)
    return known


def taken_off(evidence: Evidence, known: Judged) -> tuple[Evidence, Judged]:
    """Return the recordings without what they lack by themselves, and what still stands of it in the model."""
    theta = parameters(evidence, known.model)
    stays = [a for a in known.accepted if a.score.candidate.effect in ("base_free", "torque_ripple")]
    gone = [c for a in known.accepted if a not in stays for c in a.score.candidate.columns]
    moved = np.unique(evidence.found.directions.take(gone).vectors.nonzero()[0])
    vector = np.zeros(evidence.setup.space.size)
    vector[moved] = theta[moved]
    runs = [
        replace(r, torque=r.torque - x)
        for r, x in zip(evidence.runs, _torques(evidence, vector), strict=True)
    ]
    model = nuisance(evidence)
    for a in stays:
        model = chosen(model, evidence, a.score.candidate)
    return renewed(evidence, runs), Judged(tuple(stays), model, ())


def run(
    paths: Sequence[Path], robot: str, repeats: int, seed: int, whole: bool, say: Callable[[str], None]
) -> None:
    """Print one line a size."""
    data, digest = load_robot(robot)
    recordings = [clean(read(p))[0] for p in paths]
    evidence = gather(recordings, [True] * len(paths), nominal_model(data, digest, len(data.joint)), data)
    known = everything(evidence)
    say(
        "known: " + ", ".join(f"{a.score.candidate.effect} {a.score.candidate.joint}" for a in known.accepted)
    )
    evidence, known = taken_off(evidence, known)
    known = everything(evidence, known)  # what only shows now that the rest is gone
    theta = parameters(evidence, known.model)
    left = [residual(r, evidence.setup.space, theta) for r in evidence.runs]
    drawn = cases(evidence, columns_of(recordings, evidence), left, repeats, seed, whole)
    results: dict[float, list[tuple[Case, str, bool]]] = {s: [] for s in SIZES}
    begun = time.perf_counter()
    for k, case in enumerate(drawn, start=1):
        results[case.size].append((case, *answer(evidence, known, case)))
        if sys.stderr.isatty() or k % 16 == 0:
            print(f"{k}/{len(drawn)}  {time.perf_counter() - begun:.0f} s", file=sys.stderr)
    say(
        "| effect rms / residual rms | n | right family | wrong family | none | joint right | crude: right, wrong |"
    )
    say("|---|---|---|---|---|---|---|")
    for size, found in results.items():
        n = len(found)
        right = [c for c in found if c[1] == c[0].family]
        wrong = [c for c in found if c[1] and c[1] != c[0].family]
        joints = sum(c[2] for c in right)
        crude = CRUDE[size]
        say(
            f"| {size:.2f} | {n} | {100 * len(right) / n:.0f} % | {100 * len(wrong) / n:.0f} % |"
            f" {100 * (n - len(right) - len(wrong)) / n:.0f} % | {joints}/{len(right)} | {crude[0]} %, {crude[1]} % |"
        )
    for size, found in results.items():
        for case, name, _ in found:
            if name != case.family:
                say(f"  {size:.2f} {case.name} joint {case.joint}: {name or 'nothing'}")


def main() -> None:
    """Read arguments and run."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("recordings", nargs="+", type=Path)
    parser.add_argument("--robot", default="ur10e")
    parser.add_argument("--repeats", type=int, default=1)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--whole", action="store_true", help="sizes of all of an effect")
    a = parser.parse_args()
    run(a.recordings, a.robot, a.repeats, a.seed, a.whole, print)


if __name__ == "__main__":
    main()
