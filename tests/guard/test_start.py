"""The guard refuses to begin, and the motion does not run, when something looks wrong."""

import numpy as np
import pytest
from guarding import Arm, run_until

from residuum.codegen.guard import REASONS
from residuum.urscript import Machine, ScriptRuntimeError


class Dashboard(Arm):
    """A controller whose dashboard server answers."""

    version = "5.11.1"

    def do_socket_open(self, address, port, name):
        self.lines = ["Connected: Universal Robots Dashboard Server"]
        return (address, port) == ("127.0.0.1", 29999)

    def do_socket_send_line(self, text, name):
        assert text == "PolyscopeVersion"
        self.lines.append(f"URSoftware {self.version}.108318 (Feb 02 2021)")
        return True

    def do_socket_read_line(self, name, timeout):
        return self.lines.pop(0)


def refused(text: str, world: Arm) -> int:
    """Run; return the reason of the refusal."""
    machine = Machine(text, world)
    machine.run(1500)
    assert machine.finished and world.state == 7
    assert not any(what == "movej" for _, what in world.log)
    assert world.messages[-1] == f"collision guard: see docs/guard.md, reason {world.reason}"
    return world.reason


@pytest.fixture(scope="module")
def text(small) -> str:
    from residuum.codegen.motion import read_motion

    motion = read_motion("movej([0.0, 0.0, 0.0, 0.0, 0.0, 0.0])\n", "move.script", "5.11")
    return small.guard(motion=motion)


@pytest.fixture
def world(collision) -> Arm:
    return Arm(collision)


def test_all_is_well(text, world) -> None:
    assert run_until(Machine(text, world), world, state=2) < 300
    assert world.reason == 0


def test_another_step_time(text, world) -> None:
    world.do_get_steptime = lambda: 0.008
    assert refused(text, world) == 1


@pytest.mark.parametrize(("version", "reason"), [("5.9.4", 2), ("5.4.0", 2)])
def test_older_polyscope(text, collision, version, reason) -> None:
    world = Dashboard(collision)
    world.version = version
    assert refused(text, world) == reason


@pytest.mark.parametrize("version", ["5.11.0", "5.25.1"])
def test_same_or_newer_polyscope(text, collision, version) -> None:
    world = Dashboard(collision)
    world.version = version
    run_until(Machine(text, world), world, state=2)


@pytest.mark.parametrize("kg", [0.1, 5.0])
def test_another_payload(text, world, kg) -> None:
    world.payload = kg
    assert refused(text, world) == 3


def test_the_payload_that_the_model_knows(small, world) -> None:
    world.payload = 1.5
    run_until(Machine(small.guard(payload=1.48), world), world, state=2)


def test_a_robot_that_moves(text, world) -> None:
    world.stopped, world.settle = 0, None
    assert refused(text, world) == 4


def test_angle_registers_of_something_else(text, world) -> None:
    read = world.do_read_port_register
    world.do_read_port_register = lambda a: 0 if 270 <= a < 276 else read(a)
    assert refused(text, world) == 5


def test_a_current_that_no_joint_can_carry(text, world) -> None:
    world._current[100:, 2] = 30.0
    assert refused(text, world) == 6


@pytest.mark.parametrize("value", [0.0, 0.123])
def test_currents_that_never_change(text, world, value) -> None:
    world._current[:, :] = value
    assert refused(text, world) == 7


def test_a_residual_at_rest_beyond_its_threshold(text, world) -> None:
    world._current[:, 1] += 3.0
    assert refused(text, world) == 8


def test_rtde_values_are_checked_too(small, collision) -> None:
    world = Arm(collision)
    world._rtde["actual_q"] = np.zeros_like(collision.q)
    assert refused(small.guard(current_source="rtde"), world) == 5


def test_missing_rtde_field_stops_the_program_at_its_line(small, collision) -> None:
    world, text = Arm(collision), small.guard(current_source="rtde")
    del world._rtde["actual_current"]
    with pytest.raises(ScriptRuntimeError) as error:
        Machine(text, world).run(100)
    assert 'get_rtde_value("actual_current")' in text.splitlines()[error.value.line - 1]
    assert error.value.code == "rtde-field"


def test_unset_resume_register_stops_the_program_at_its_line(small, world) -> None:
    text = small.guard()
    world.unset_is_error = True
    with pytest.raises(ScriptRuntimeError) as error:
        Machine(text, world).run(3000)
    assert "read_input_boolean_register(64)" in text.splitlines()[error.value.line - 1]
    assert error.value.code == "unset-register"


def test_every_reason_has_its_words() -> None:
    assert sorted(REASONS) == list(range(1, 10))
