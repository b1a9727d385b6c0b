"""Stop, rest, freedrive, in this order; what triggered can be read; the guard goes on when told."""

import numpy as np
import pytest
from guarding import Arm, run_until, track

from residuum.codegen.guard import FLOATS, INTEGERS, SAMPLES, SPACING
from residuum.urscript import Array, Machine


def start(text: str, rows, **options) -> tuple[Machine, Arm]:
    world = Arm(rows, **options)
    return Machine(text, world), world


def test_freedrive_comes_after_rest_and_that_after_the_stop(small, collision) -> None:
    machine, world = start(small.guard(), collision)
    hit = run_until(machine, world, state=3)
    assert world.log == [(hit, "stopj")], "the stop begins in the step of the detection"
    assert "rs_motion" not in machine.threads
    run_until(machine, world, state=6)
    assert [what for _, what in world.log] == ["stopj", "freedrive"]
    assert world.when("freedrive") >= hit + world.settle, "joints swing on after stopj has returned"
    assert world.swing == 0.0


def test_no_freedrive_while_the_robot_does_not_rest(small, collision) -> None:
    machine, world = start(small.guard(), collision, settle=None)
    run_until(machine, world, state=5)
    assert world.reason == 9
    world.settle = 1
    machine.run(10)
    world.inputs["boolean", 64] = True
    run_until(machine, world, state=2)
    assert [what for _, what in world.log] == ["stopj"], "no freedrive, so none is ended"


def test_joints_beyond_the_model_have_to_rest_too(small, collision) -> None:
    class Wrist(Arm):
        """Joint 5 swings on for half a second."""

        def do_get_actual_joint_speeds(self):
            speeds = list(super().do_get_actual_joint_speeds())
            if self.stopped is not None and self.frame < self.stopped + 250:
                speeds[4] = 0.3
            return Array(speeds)

    world = Wrist(collision)
    machine = Machine(small.guard(), world)
    run_until(machine, world, state=6)
    assert world.when("freedrive") >= world.stopped + 250


def test_hold_keeps_the_position(small, collision) -> None:
    machine, world = start(small.guard(reaction="hold"), collision)
    run_until(machine, world, state=5)
    machine.run(500)
    assert [what for _, what in world.log] == ["stopj"] and world.reason == 0


@pytest.mark.parametrize("detector", ["static", "velocity", "vote"])
def test_retract_drives_the_joint_where_it_is_pushed(small, collision, detector) -> None:
    machine, world = start(small.guard(reaction="retract", detector=detector), collision)
    run_until(machine, world, state=6)
    away = [0.0, -0.5, 0.0, 0.0, 0.0, 0.0]
    assert [what for _, what in world.log] == ["stopj", f"speedj {away} 3.0 0.3", "stopj", "freedrive"]


@pytest.mark.parametrize(
    ("resume", "key", "table"),
    [("register:70", ("boolean", 70), "inputs"), ("digital:3", ("standard in", 3), "digital")],
)
def test_a_rising_edge_resumes(small, collision, resume, key, table) -> None:
    machine, world = start(small.guard(resume=resume), collision)
    getattr(world, table)[key] = True
    run_until(machine, world, state=6)
    machine.run(300)
    assert world.state == 6, "an input that was on all the time is no request"
    getattr(world, table)[key] = False
    machine.run(10)
    getattr(world, table)[key] = True
    run_until(machine, world, state=1)
    assert not world.freedrive and world.log[-1][1] == "end freedrive"
    again = run_until(machine, world, state=2)
    assert again - world.when("end freedrive") > 250, "the bias is measured again"
    assert "rs_motion" in machine.threads
    assert world.outputs["integer", INTEGERS["joint"]] == 0
    assert world.outputs["integer", INTEGERS["collisions"]] == 1
    machine.run(200)
    assert world.state == 2


def test_the_last_second_can_be_read_while_it_waits(small, collision) -> None:
    text = small.guard()
    live = track(text, Arm(collision), 3000, 3)
    machine, world = start(text, collision)
    run_until(machine, world, state=6)
    seen = {}
    for _ in range(4 * SAMPLES + 10):
        machine.frame()
        sample = world.outputs["integer", INTEGERS["sample"]]
        seen[sample] = [world.outputs["float", FLOATS["residual"] + k] for k in range(3)]
    assert sorted(seen) == list(range(1, SAMPLES + 1))
    assert seen[SAMPLES] == pytest.approx(live.residual[-1], abs=0), "the newest is the detection"
    watched = live.residual[live.begin :]
    kept = watched[SPACING - 1 :: SPACING]
    kept = kept if len(watched) % SPACING == 0 else [*kept, watched[-1]]
    shown = np.array([seen[k] for k in range(1, SAMPLES + 1)])
    assert np.array_equal(shown[-len(kept[-SAMPLES:]) :], kept[-SAMPLES:])


def test_the_frame_of_the_guard_counts_operations(small, collision) -> None:
    from residuum.codegen.guard import guard_size

    text = small.guard()
    machine, world = start(text, collision)
    run_until(machine, world, state=2)
    machine.run(100)
    counted = [machine.frame().operations["rs_guard"] for _ in range(50)]
    size = guard_size(text)
    assert size.operations <= max(counted) <= size.operations + 10, "the loop around it comes on top"


@pytest.mark.parametrize(
    ("detector", "bits"),
    [("static", {1}), ("speed", {2}), ("cusum", {4}), ("velocity", {8}), ("vote", {6, 10, 12, 14})],
)
def test_the_detectors_that_agreed_are_told(small, collision, detector, bits) -> None:
    machine, world = start(small.guard(detector=detector), collision)
    run_until(machine, world, state=3)
    assert world.outputs["integer", INTEGERS["detectors"]] in bits
    assert world.outputs["integer", INTEGERS["joint"]] == 2
    assert world.outputs["boolean", 65] is True and world.outputs["boolean", 64] is False
