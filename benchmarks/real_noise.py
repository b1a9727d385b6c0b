"""Known effects in real noise: added to real recordings of a UR10e, then named by explain's own steps.

python benchmarks/real_noise.py RECORDINGS/unloaded_*.csv [--robot ur10e] [--repeats 2] [--seed 1]

What the recordings lack by themselves is found first and taken off (masses and ripple stay in the model).
Then one effect at a time is added to the filtered torque of every run, with nonlinear values that stand on
no grid. Its size is the rms of what base parameters, offset, Coulomb and viscous friction leave of it
(--whole: of all of it) over the residual's rms, both where the joint moves. The residual is what the same
plain model leaves of the recordings as they are, as in the published table; with --over known it is what is
left once all that was found is off, which is smaller.
Late signs and presliding come at the joint's Coulomb level, and only where some travel or time has the size;
a delay only where it is longer than what is no fault (plausibility.SYNCHRONOUS).
Beside it a plain leave-one-run-out namer answers the same cases (`crude.py`).
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
from added import SIZES, Case, cases, columns_of, plain_left, reversals_of, torques
from crude import namer
from numpy.typing import NDArray

from residuum.mismatch.candidates import Candidate
from residuum.mismatch.evidence import Evidence, gather, renewed, residual
from residuum.mismatch.judging import UNSEEN, Judged, judge
from residuum.mismatch.naming import chosen, nuisance, reweighed
from residuum.mismatch.refit import parameters
from residuum.recordings import read
from residuum.recordings.audit import clean
from residuum.robots import load_robot
from residuum.symbolic.nominal import nominal_model

Array = NDArray[np.float64]

#: facts of the crude baseline: plain leave-one-run-out on such logs, 16 effects.
CRUDE = {0.10: (25, 11), 0.20: (62, 12), 0.35: (90, 5), 0.50: (99, 1)}

#: Rounds in which what the recordings lack is taken off: each shows less.
_ROUNDS = 3
#: No names for the plain namer: these are free in its baseline.
FREE = (
    *UNSEEN, "base_free", "payload", "link_inertial", "rotor_inertia", "current_offset", "friction_asymmetry",
)  # fmt: skip


def answer(evidence: Evidence, known: Judged, with_it: Sequence[Array]) -> Candidate | None:
    """Return the first new finding in other torques (n, N) by run."""
    runs = tuple(replace(r, torque=x) for r, x in zip(evidence.runs, with_it, strict=True))
    judged = judge(renewed(evidence, runs), known=known, most=1)
    return next((a.score.candidate for a in judged.accepted if a.is_finding), None)


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
        replace(r, torque=r.torque - x) for r, x in zip(evidence.runs, torques(evidence, vector), strict=True)
    ]
    model = nuisance(evidence, known.masses)
    for a in stays:
        model = chosen(model, evidence, a.score.candidate)
    return renewed(evidence, runs), Judged(tuple(stays), model, (), known.masses)


def alone(evidence: Evidence, known: Judged) -> tuple[Evidence, Judged]:
    """Take off what the recordings lack by themselves, and what only shows once that is gone, and so on."""
    for _ in range(_ROUNDS):
        evidence, stays = taken_off(evidence, known)
        known = everything(evidence, stays)
        if len(known.accepted) == len(stays.accepted):
            break
    return evidence, known


def run(
    paths: Sequence[Path], robot: str, repeats: int, seed: int, whole: bool, over: str,
    say: Callable[[str], None],
) -> None:  # fmt: skip
    """Print one line a size."""
    data, digest = load_robot(robot)
    recordings = [clean(read(p))[0] for p in paths]
    evidence = gather(recordings, [True] * len(paths), nominal_model(data, digest, len(data.joint)), data)
    known = everything(evidence)
    say(
        "known: " + ", ".join(f"{a.score.candidate.effect} {a.score.candidate.joint}" for a in known.accepted)
    )
    left = plain_left(evidence)
    evidence, known = alone(evidence, known)
    if over == "known":
        theta = parameters(evidence, known.model)
        left = [residual(r, evidence.setup.space, theta) for r in evidence.runs]
    own, reversals = columns_of(recordings, evidence), reversals_of(recordings, evidence)
    drawn = cases(evidence, own, reversals, left, repeats, seed, whole)
    plain = namer(evidence, FREE).knowing([r.torque for r in evidence.runs])
    results: dict[float, list[Answered]] = {s: [] for s in SIZES}
    begun = time.perf_counter()
    for k, case in enumerate(drawn, start=1):
        with_it = [r.torque + x for r, x in zip(evidence.runs, case.added, strict=True)]
        results[case.size].append(Answered(case, answer(evidence, known, with_it), plain.name(with_it)))
        if sys.stderr.isatty() or k % 16 == 0:
            print(f"{k}/{len(drawn)}  {time.perf_counter() - begun:.0f} s", file=sys.stderr)
    report(results, say)


@dataclass(frozen=True)
class Answered:
    """A case and two answers; None where nothing is named."""

    case: Case
    ours: Candidate | None
    plain: Candidate | None


def report(results: dict[float, list[Answered]], say: Callable[[str], None]) -> None:
    """Print one line a size, and what was not named right."""
    say(
        "| effect rms / residual rms | n | right, wrong, none | joint right | plain: right, wrong, none | crude |"
    )
    say("|---|---|---|---|---|---|")
    for size, found in results.items():
        right = [a for a in found if _name(a.ours) == a.case.family]
        joints = sum(a.case.joint in (None, a.ours.joint) for a in right if a.ours)
        ours = _shares([(_name(a.ours), a.case.family) for a in found])
        plain = _shares([(_name(a.plain), a.case.family) for a in found])
        crude = "{} %, {} %".format(*CRUDE[size])
        say(f"| {size:.2f} | {len(found)} | {ours} | {joints}/{len(right)} | {plain} | {crude} |")
    for size, found in results.items():
        for a in found:
            if (name := _name(a.ours)) != a.case.family:
                say(f"  {size:.2f} {a.case.name} joint {a.case.joint}: {name or 'nothing'}")


def _name(found: Candidate | None) -> str:
    return found.effect if found else ""


def _shares(names: Sequence[tuple[str, str]]) -> str:
    """Return right, wrong and none in percent, of (name, truth)."""
    counts = (
        sum(n == t for n, t in names), sum(n not in ("", t) for n, t in names), sum(not n for n, _ in names),
    )  # fmt: skip
    return ", ".join(f"{100 * c / len(names):.0f} %" for c in counts)


def main() -> None:
    """Read arguments and run."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("recordings", nargs="+", type=Path)
    parser.add_argument("--robot", default="ur10e")
    parser.add_argument("--repeats", type=int, default=1)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--whole", action="store_true", help="sizes of all of an effect")
    parser.add_argument("--over", choices=("plain", "known"), default="plain", help="whose residual")
    a = parser.parse_args()
    run(a.recordings, a.robot, a.repeats, a.seed, a.whole, a.over, print)


if __name__ == "__main__":
    main()
