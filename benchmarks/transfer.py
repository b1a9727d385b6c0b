"""Transfer: coefficients found without a load, kept on a recording with one.

python benchmarks/transfer.py RECORDINGS/unloaded_*.csv --loaded RECORDINGS/loaded_*.csv [--robot ur10e]

On the unloaded runs a joint's friction gets one further term: what explain names, or its impostor. All
coefficients then stay; on the loaded run only the ten parameters of the payload are fitted. The right name
extrapolates to the torque that the load adds, the impostor does not. Errors are of each joint's low-passed
torque where it moves.
"""

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from residuum.mismatch.candidates import Candidate
from residuum.mismatch.evidence import Evidence, gather, residual
from residuum.mismatch.grams import regime
from residuum.mismatch.naming import nuisance, scored
from residuum.mismatch.proof import rms_where
from residuum.mismatch.quantities import PAYLOAD, payload_columns
from residuum.mismatch.refit import parameters
from residuum.mismatch.rows import make_rows
from residuum.recordings import Recording, read
from residuum.recordings.audit import clean
from residuum.robots import load_robot
from residuum.symbolic.nominal import nominal_model

Array = NDArray[np.float64]

NAMES = ("load_dependent_friction", "position_dependent_friction")


def best_of(evidence: Evidence, effect: str, joint: int) -> Candidate:
    """Return an effect's hypothesis on a joint (0-based) at its best nonlinear value."""
    some = [c for c in evidence.found.each if c.key == (effect, joint)]
    return max(scored(evidence, nuisance(evidence), some), key=lambda s: s.evidence).candidate


def loaded_error(evidence: Evidence, recording: Recording, theta: Array) -> tuple[Array, Array]:
    """Return the rms (N,) Nm of a loaded run with only the payload fitted, and the payload (10,).

    The load that friction grows with includes the payload, so rows are made anew.
    """
    space, physics = evidence.setup.space, evidence.setup.physics
    payload = np.zeros(10)
    links = physics.map.links[:, -10:]
    for _ in range(3):
        setup = replace(evidence.setup, base=evidence.setup.base + links @ payload)
        rows = make_rows(recording, setup)
        left, columns = residual(rows, space, theta), payload_columns(evidence, rows)
        moving = regime(rows) < 2
        scale = rms_where([left], moving)
        a = np.concatenate([columns[moving[:, j], j] / scale[j] for j in range(space.dof)])
        b = np.concatenate([left[moving[:, j], j] / scale[j] for j in range(space.dof)])
        payload = np.linalg.solve(a.T @ a + np.diag(1 / PAYLOAD**2), a.T @ b)
    return rms_where([left - columns @ payload], moving), payload


def run(unloaded: Sequence[Path], loaded: Sequence[Path], robot: str, joints: Sequence[int]) -> None:
    """Print a row of errors for each model."""
    data, digest = load_robot(robot)
    runs = [clean(read(p))[0] for p in unloaded]
    evidence = gather(runs, [True] * len(runs), nominal_model(data, digest, len(data.joint)), data)
    models = {"Coulomb and viscous": nuisance(evidence)}
    for name in NAMES:
        found = [best_of(evidence, name, j - 1) for j in joints]
        added = evidence.found.directions.take([c for x in found for c in x.columns])
        models[f"and {name}"] = nuisance(evidence) + added
    where = ", ".join(map(str, joints))
    print(
        f"| friction of joints {where} | run | rms, Nm, joint 1 to {len(data.joint)} | payload, kg |\n|---|---|---|---|"
    )
    for path in loaded:
        recording = clean(read(path))[0]
        for name, model in models.items():
            rms, payload = loaded_error(evidence, recording, parameters(evidence, model))
            print(f"| {name} | {path.stem} | {' / '.join(f'{x:.3f}' for x in rms)} | {payload[0]:.2f} |")


def main() -> None:
    """Read arguments and run."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("unloaded", nargs="+", type=Path)
    parser.add_argument("--loaded", nargs="+", type=Path, required=True)
    parser.add_argument("--robot", default="ur10e")
    parser.add_argument("--joints", nargs="+", type=int, default=[2, 3])
    a = parser.parse_args()
    run(a.unloaded, a.loaded, a.robot, a.joints)


if __name__ == "__main__":
    main()
