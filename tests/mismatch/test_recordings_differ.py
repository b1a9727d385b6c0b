"""Friction that is another in each recording: a change is what stands out from that."""

import numpy as np
import pytest

from residuum.mismatch.evidence import gather
from residuum.mismatch.judging import judge
from residuum.recordings import read
from residuum.recordings.audit import clean
from residuum.robots import load_robot
from residuum.symbolic.nominal import nominal_model
from residuum.virtual import Plant, effects, simulate
from residuum.virtual.motions import fourier

pytestmark = pytest.mark.slow

JOINT, SPREAD = 2, 3.0  # Nm s/rad


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """(seed, more viscous friction in Nm s/rad) -> a recording of 30 s at 125 Hz."""
    folder, (robot, _) = tmp_path_factory.mktemp("differ"), load_robot("ur5e")

    def of(seed: int, more: float):
        plant = Plant(viscous_friction=(effects.ViscousFriction(joint=JOINT, damping=more),))
        path = folder / f"{seed}_{more:.2f}.csv"
        simulate(robot, plant, fourier(robot, 30.0, seed=seed), 125, seed).recording.write_csv(path)
        return clean(read(path))[0]

    return of


@pytest.fixture(scope="module")
def reference(recorded):
    spread = SPREAD * np.random.default_rng(4).choice([-1.0, 1.0], 5) * np.linspace(0.5, 1.0, 5)
    return [recorded(seed, float(more)) for seed, more in enumerate(spread, start=1)]


@pytest.mark.parametrize(("more", "names"), [(SPREAD, []), (8 * SPREAD, ["viscous_friction"])])
def test_a_change_stands_out_from_how_recordings_differ(reference, recorded, more, names) -> None:
    robot, digest = load_robot("ur5e")
    recordings = [*reference, recorded(9, more)]
    evidence = gather(recordings, [False] * 5 + [True], nominal_model(robot, digest, 6), robot)
    judged = judge(evidence)
    assert [
        a.score.candidate.effect for a in judged.accepted if a.score.candidate.joint == JOINT - 1
    ] == names
    if not names:
        assert any("a reference recording shows" in why for _, why in judged.refused)
