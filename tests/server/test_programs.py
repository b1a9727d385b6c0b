"""Programs on the controller, in lock step with the physics, without sockets."""

import numpy as np
import pytest

from residuum.robots import load_robot
from residuum.virtual import Plant, clamped_hand
from residuum.virtual.server import Controller
from residuum.virtual.server.primary import ErrorCode, Failure, Key, Text


def run(controller: Controller, body: str, seconds: float, name: str = "main") -> list:
    """Run a program's lines for some time; return what was announced."""
    lines = "\n".join(f"  {line}" for line in body.strip().splitlines())
    controller.programs.start(f"def {name}():\n{lines}\nend\n")
    return wait(controller, seconds)


def wait(controller: Controller, seconds: float) -> list:
    for _ in range(round(seconds / 0.002)):
        controller.tick()
    said, controller.messages = controller.messages, []
    return said


def actual(controller: Controller, name: str = "actual_q") -> np.ndarray:
    return controller.arm.state.rtde[name]


def test_movej_arrives_in_the_time_of_its_profile(controller) -> None:
    goal = "[0.5, -1.4, 1.4, -1.5, -1.5, 0.2]"
    said = run(controller, f"movej({goal}, a=2.0, v=1.0)", 1.004)  # 0.5 m at 1 rad/s with ramps of 0.5 s
    assert said == [Key("STARTED", "main"), Key("STOPPED", "main")]
    assert controller.arm.target[0] == pytest.approx([0.5, -1.4, 1.4, -1.5, -1.5, 0.2], abs=1e-9)
    wait(controller, 0.5)
    assert actual(controller) == pytest.approx([0.5, -1.4, 1.4, -1.5, -1.5, 0.2], abs=2e-3)


def test_movej_takes_the_time_it_is_given(controller) -> None:
    run(
        controller,
        "movej([0.3, -1.57, 1.57, -1.57, -1.57, 0.0], t=2.0)\nwrite_output_integer_register(0, 1)",
        1.99,
    )
    assert ("integer", 0) not in controller.world.outputs
    wait(controller, 0.02)
    assert controller.world.outputs["integer", 0] == 1


def test_movel_is_straight(controller) -> None:
    start = np.array(controller.snapshot.value("actual_TCP_pose"))
    controller.programs.start(
        "def line():\n  p0 = get_actual_tcp_pose()\n  movel(pose_trans(p0, p[0.1, 0.05, -0.1, 0, 0, 0.3]))\nend\n"
    )
    goal, away = None, []
    for _ in range(1200):
        place = np.array(controller.tick().value("target_TCP_pose"))[:3]
        goal = np.array(controller.world.waypoint)[:3]
        way = (goal - start[:3]) / np.linalg.norm(goal - start[:3])
        away.append(np.linalg.norm(np.cross(place - start[:3], way)))
    assert controller.programs.state == "stopped"
    assert np.linalg.norm(goal - start[:3]) == pytest.approx(0.15, abs=1e-3)
    assert place == pytest.approx(goal, abs=1e-6)
    assert max(away) < 1e-4


def test_movel_to_beyond_reach_ends_the_program_and_the_robot_holds(controller) -> None:
    said = run(controller, "movel(p[1.5, 0, 0.2, 0, 0, 0], v=0.5)", 3.0)
    assert any(isinstance(m, Failure) and m.line == 2 for m in said)
    before = actual(controller)
    wait(controller, 0.5)
    assert actual(controller) == pytest.approx(before, abs=1e-3)
    assert not controller.arm.protective_stop


def test_speedj_goes_on_until_its_thread_is_killed_and_stopj_stops(controller) -> None:
    run(
        controller,
        """
thread go():
  while True:
    speedj([0.5, 0, 0, 0, 0, 0], 2.0, 0.1)
  end
end
h = run go()
sleep(0.6)
kill h
stopj(4.0)
write_output_integer_register(0, 1)
while True:
  sync()
end""",
        0.5,
    )
    assert actual(controller, "actual_qd")[0] == pytest.approx(0.5, abs=0.02)
    wait(controller, 0.3)
    assert controller.world.outputs["integer", 0] == 1
    assert abs(actual(controller, "actual_qd")[0]) < 0.01
    assert controller.programs.state == "playing"


def test_speedj_without_a_time_takes_a_step_even_when_it_is_there(controller) -> None:
    said = run(controller, "while True:\n  speedj([0, 0, 0, 0, 0, 0], 1.0)\nend", 0.1)
    assert said == [Key("STARTED", "main")]


def test_speedl_and_stopl(controller) -> None:
    start = np.array(controller.snapshot.value("actual_TCP_pose"))
    run(controller, "speedl([0, 0, 0.1, 0, 0, 0], 1.0, 0.5)\nstopl(2.0)", 1.0)
    moved = np.array(controller.snapshot.value("actual_TCP_pose"))[:3] - start[:3]
    assert controller.programs.state == "stopped"
    assert moved[2] == pytest.approx(0.1 * 0.45 + 0.5 * 0.1**2 / 2.0, abs=2e-3)
    assert moved[:2] == pytest.approx([0, 0], abs=1e-3)


def test_servoj_follows_and_arrives(controller) -> None:
    run(
        controller,
        """
q = get_target_joint_positions()
q[0] = q[0] + 0.1
n = 0
while n < 300:
  servoj(q, t=0.002, lookahead_time=0.1, gain=300)
  n = n + 1
end
stopj(4.0)""",
        1.0,
    )
    assert actual(controller)[0] == pytest.approx(0.1, abs=3e-3)


def test_freedrive_lets_the_arm_be_pushed_and_holds_afterwards() -> None:
    push = {"external_contact": ({"start": 0.2, "end": 1.2, "force": (0, 40.0, 0), "link": 6},)}
    controller = Controller(load_robot("ur5e")[0], Plant(**push))
    run(controller, "freedrive_mode()\nsleep(1.5)\nend_freedrive_mode()\nwhile True:\n  sync()\nend", 0.1)
    start = actual(controller)
    assert controller.arm.freedrive
    wait(controller, 1.2)
    pushed = actual(controller)
    assert np.abs(pushed - start).max() > 0.05
    wait(controller, 0.5)
    held = actual(controller)
    wait(controller, 0.5)
    assert not controller.arm.freedrive
    assert actual(controller) == pytest.approx(held, abs=2e-3)


def test_motion_in_freedrive_is_refused(controller) -> None:
    said = run(controller, "freedrive_mode()\nsync()\nmovej([0, -1.5, 1.5, -1.5, -1.5, 0])", 0.1)
    assert any(isinstance(m, Failure) and "freedrive" in m.text and m.line == 4 for m in said)
    assert not controller.arm.freedrive


def test_a_blocked_joint_is_a_protective_stop(controller) -> None:
    point = controller.arm.simulator.where(6)
    controller.arm.simulator.add_obstacle(clamped_hand(tuple(point - [0, 0, 0.05]), (0, 0, 1)))
    said = run(controller, "movel(pose_add(get_actual_tcp_pose(), p[0, 0, -0.3, 0, 0, 0]), v=0.25)", 2.0)
    assert controller.arm.protective_stop
    assert any(isinstance(m, ErrorCode) and "off its target" in m.text for m in said)
    assert controller.snapshot.value("safety_mode") == (3,)
    assert controller.snapshot.value("safety_status_bits")[0] & 5 == 4
    assert controller.programs.state == "stopped"
    controller.programs.start("def no():\n  sync()\nend\n")
    assert controller.programs.state == "stopped"
    assert not controller.arm.unlock()
    wait(controller, 5.0)
    assert controller.arm.unlock()
    controller.programs.start("def yes():\n  sync()\nend\n")
    assert controller.programs.state == "playing"


def test_currents_come_as_milliamperes_of_16_bits(controller) -> None:
    run(
        controller,
        "k = 0\nwhile k < 6:\n  write_output_integer_register(k, read_port_register(290 + k))\n  k = k + 1\nend",
        0.002,
    )
    told = [controller.world.outputs["integer", k] for k in range(6)]
    assert told == [round(1000 * x) for x in controller.arm.before.rtde["actual_current"]]
    assert min(told) < -1000
    controller.world.signed = False
    run(controller, "write_output_integer_register(1, read_port_register(291))", 0.002)
    assert controller.world.outputs["integer", 1] > 32767


def test_get_rtde_value_is_a_step_older_than_the_joints() -> None:
    controller = Controller(load_robot("ur5e")[0], version="5.25.1")
    said = run(
        controller, 'sync()\nsync()\nwrite_output_float_register(0, get_rtde_value("timestamp"))', 0.006
    )
    assert said[0] == Key("STARTED", "main")
    assert controller.world.outputs["float", 0] == pytest.approx(0.002)
    assert controller.arm.time == pytest.approx(0.006)


def test_an_older_controller_has_no_get_rtde_value(controller) -> None:
    said = run(controller, 'x = get_rtde_value("actual_q")', 0.01)
    assert any(isinstance(m, Failure) for m in said)


def test_a_new_program_replaces_the_running_one_and_a_secondary_does_not(controller) -> None:
    said = run(controller, "while True:\n  sync()\nend", 0.01, "first")
    assert said == [Key("STARTED", "first")]
    controller.programs.start("sec beside():\n  set_standard_digital_out(2, True)\nend\n")
    assert wait(controller, 0.01) == []
    assert controller.snapshot.value("actual_digital_output_bits") == (4,)
    said = run(controller, "while True:\n  sync()\nend", 0.01, "second")
    assert said == [Key("STOPPED", "first"), Key("STARTED", "second")]


def test_wrong_programs_name_line_and_column_and_leave_the_running_one(controller) -> None:
    run(controller, "while True:\n  sync()\nend", 0.01, "good")
    said = run(controller, "x = = 3", 0.01, "bad")
    assert said == [Failure(2, 7, said[0].text)] and "yntax" in said[0].text
    assert controller.programs.name == "good"


def test_runtime_errors_end_the_program_with_their_place(controller) -> None:
    said = run(controller, "sync()\nx = 1 / 0", 0.02)
    assert [type(m) for m in said] == [Key, Failure, Key]
    assert (said[1].line, said[1].text.startswith("Runtime error")) == (3, True)


def test_a_program_that_only_computes_is_stopped_and_the_controller_lives(controller) -> None:
    said = run(controller, "while True:\n  x = 1\nend", 0.01)
    assert any(isinstance(m, Failure) and "too much time" in m.text for m in said)
    before = controller.arm.time
    wait(controller, 0.01)
    assert controller.arm.time > before


def test_pause_leaves_the_path_for_no_instant(controller) -> None:
    run(controller, "movej([1.0, -1.57, 1.57, -1.57, -1.57, 0.0], a=2.0, v=1.0)", 0.7)
    assert controller.programs.pause()
    wait(controller, 0.5)
    assert controller.programs.state == "paused"
    held = actual(controller)[0]
    assert 0.3 < held < 0.9
    wait(controller, 0.5)
    assert actual(controller)[0] == pytest.approx(held, abs=2e-3)
    controller.programs.play()
    speeds = []
    for _ in range(700):
        controller.tick()
        speeds.append(controller.arm.target[1][0])
    assert np.abs(np.diff(speeds)).max() < 0.02
    assert actual(controller)[0] == pytest.approx(1.0, abs=2e-3)


def test_the_speed_slider_slows_paths(controller) -> None:
    controller._receive({"speed_slider_mask": (1,), "speed_slider_fraction": (0.25,)})
    wait(controller, 0.5)
    run(controller, "movej([1.0, -1.57, 1.57, -1.57, -1.57, 0.0], a=4.0, v=1.0)", 2.0)
    assert controller.arm.target[1][0] == pytest.approx(0.25, abs=1e-6)


def test_a_watchdog_stops_the_program_when_its_client_goes_silent(controller) -> None:
    run(
        controller,
        'rtde_set_watchdog("input_int_register_0", 10.0, "stop")\nwhile True:\n  sync()\nend',
        0.05,
    )
    for _ in range(10):
        controller._receive({"input_int_register_0": (0,)})
        assert wait(controller, 0.05) == []
    said = wait(controller, 0.2)
    assert controller.programs.state == "stopped"
    assert any(isinstance(m, ErrorCode) and "watchdog" in m.text for m in said)


def test_messages_reach_the_log(controller) -> None:
    said = run(controller, 'textmsg("speed: ", 3)', 0.01)
    assert Text("speed: 3") in said


def test_payload_is_believed(controller) -> None:
    load = controller.arm.state.rtde["target_moment"].copy()
    run(controller, "set_target_payload(2.0, [0, 0, 0.05])", 0.02)
    assert controller.arm.payload.mass == 2.0
    change = controller.arm.state.rtde["target_moment"] - load
    assert abs(change[1]) > 5.0  # 2 kg at about half a metre
    assert actual(controller) == pytest.approx([0, -1.5708, 1.5708, -1.5708, -1.5708, 0], abs=0.02)


def test_inputs_of_all_kinds_arrive(controller) -> None:
    controller._receive(
        {
            "input_double_register_5": (2.5,),
            "input_bit_registers32_to_63": (0x80000001,),
            "input_bit_register_64": (True,),
            "standard_digital_output_mask": (0b110,),
            "standard_digital_output": (0b010,),
            "standard_analog_output_mask": (2,),
            "standard_analog_output_1": (0.5,),
        }
    )
    controller.tick()
    value = controller.snapshot.value
    assert value("input_double_register_5") == (2.5,)
    assert value("input_bit_registers32_to_63") == (0x80000001,)
    assert value("input_bit_register_64") == (True,)
    assert value("actual_digital_output_bits") == (2,)
    assert value("standard_analog_output1") == (0.5,)
    run(controller, "if read_input_boolean_register(63):\n  write_output_integer_register(0, 9)\nend", 0.01)
    assert controller.world.outputs["integer", 0] == 9
