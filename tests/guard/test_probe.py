"""The probe measures what the interpreter was told to be; the snapshot leaves the guard alone."""

import numpy as np
import pytest
from guarding import Arm, run_until

from residuum.codegen.guard import PROBE_FRAMES, PROBE_REPEATS
from residuum.urscript import Machine


class Slow(Arm):
    """Registers that change every `period` steps only."""

    period = 1

    def _row(self, rows, back=0):
        frame, self.frame = self.frame, self.frame - self.frame % self.period
        try:
            return super()._row(rows, back)
        finally:
            self.frame = frame


def probed(text: str, world: Arm) -> dict:
    machine = Machine(text, world)
    machine.run(PROBE_FRAMES + 600 * len(PROBE_REPEATS))
    assert machine.finished and world.messages[-1] == "probe: done"
    return world.outputs


@pytest.mark.parametrize("period", [1, 4])
def test_refresh_of_the_registers(small, collision, period) -> None:
    world = Slow(collision, encoding="unsigned")
    world.period = period
    found = probed(small.scripts()["probe.script"], world)
    raw = np.round(collision.current * 1000)[np.arange(PROBE_FRAMES) // period * period]
    for k in range(6):
        changes = np.diff(raw[:, k]) != 0
        assert found["integer", 32 + k] == changes.sum()
        runs = np.diff(np.concatenate([[-1], np.flatnonzero(changes), [PROBE_FRAMES - 1]]))
        assert found["integer", 38 + k] in (runs.max(), runs.max() - 1)
    assert found["integer", 32] > 2000 / period


@pytest.mark.parametrize(("encoding", "code"), [("signed", 1), ("unsigned", 2)])
def test_sign_of_the_registers(small, collision, encoding, code) -> None:
    world = Arm(collision, encoding=encoding)
    found = probed(small.scripts()["probe.script"], world)
    assert found["integer", 44] == code
    assert f"probe: negative registers are {encoding}" in world.messages
    assert all(abs(found["float", 24 + k]) < 1e-3 for k in range(6))


def test_time_of_a_step(small, collision) -> None:
    text = small.scripts(polyscope="5.23")["probe.script"]
    world = Arm(collision)
    steps = 0.002 * np.arange(len(collision.q))
    world._rtde |= {"timestamp": steps, "actual_execution_time": np.full(len(steps), 0.5)}
    machine, most, place = Machine(text, world), {}, ("integer", 45)
    for _ in range(PROBE_FRAMES + 600 * len(PROBE_REPEATS)):
        operations = machine.frame().operations.get("probe", 0)
        repeats = world.outputs.get(place, -1)
        most[repeats] = max(most.get(repeats, 0), operations)
    assert [most[n] for n in PROBE_REPEATS[1:]] == sorted(most[n] for n in PROBE_REPEATS[1:])
    assert most[8] - most[4] > 0.9 * 4 / 2 * (most[4] - most[2]), "the load is the equations"
    assert world.outputs["float", 30] == pytest.approx(0.5)
    assert world.outputs["float", 36] == 0.0
    assert world.outputs[place] == -1


def test_the_snapshot_runs_in_one_step_beside_the_guard(small, collision) -> None:
    scripts, world = small.scripts(), Arm(collision)
    run_until(Machine(scripts["collision_guard.script"], world), world, state=2)
    before = dict(world.outputs)
    snapshot = Machine(scripts["snapshot.script"], world)
    snapshot.frame()
    assert snapshot.finished and world.outputs == before
    assert "snapshot: state of the guard 2" in world.messages
    assert sum("mA" in x for x in world.messages) == 6


def test_the_probe_does_not_move_the_robot(small) -> None:
    for word in ("movej", "speedj", "servoj", "stopj", "freedrive"):
        assert word not in small.scripts()["probe.script"]
