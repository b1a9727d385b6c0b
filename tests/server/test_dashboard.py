"""The dashboard's answers, as UR's client library matches them."""

import re

import pytest

from residuum.virtual.server.dashboard import Dashboard


@pytest.mark.parametrize(
    ("line", "pattern"),
    [
        ("PolyscopeVersion", r"URSoftware 5\.21\.\d+\.\d+ \(.+\)"),
        ("robotmode", "Robotmode: RUNNING"),
        ("safetymode", "Safetymode: NORMAL"),
        ("safetystatus", "Safetystatus: NORMAL"),
        ("running", "Program running: false"),
        ("programState", r"STOPPED \S+"),
        ("get serial number", r"\d+"),
        ("get robot model", "UR5"),
        ("is in remote control", "true"),
        ("load arm.urp", "Loading program: arm.urp"),
        ("get loaded program", "No program loaded"),
        ("popup hello there", "showing popup"),
        ("close popup", "closing popup"),
        ("addToLog hello", "Added log message"),
        ("stop", "Stopped"),
        ("play", "Failed to execute: play"),
        ("pause", "Failed to execute: pause"),
        ("unlock protective stop", "Protective stop releasing"),
        ("quit", "Disconnected"),
        ("make coffee", 'could not understand: "make coffee"'),
        ("", 'could not understand: ""'),
    ],
)
def test_answers(controller, line, pattern) -> None:
    assert re.fullmatch(pattern, Dashboard(controller).answer(line))


def test_a_program_is_seen_paused_and_stopped(controller) -> None:
    dashboard = Dashboard(controller)
    controller.programs.start("def loop():\n  while True:\n    sync()\n  end\nend\n")
    assert dashboard.answer("programState") == "PLAYING loop"
    assert dashboard.answer("running") == "Program running: true"
    assert dashboard.answer("pause") == "Pausing program"
    assert dashboard.answer("programState") == "PAUSED loop"
    assert dashboard.answer("play") == "Starting program"
    assert dashboard.answer("stop") == "Stopped"
    assert dashboard.answer("programState").startswith("STOPPED")
    assert dashboard.answer("play") == "Starting program"
    assert dashboard.answer("programState") == "PLAYING loop"


def test_power(controller) -> None:
    dashboard = Dashboard(controller)
    controller.programs.start("def loop():\n  while True:\n    sync()\n  end\nend\n")
    assert dashboard.answer("power off") == "Powering off"
    assert dashboard.answer("robotmode") == "Robotmode: POWER_OFF"
    assert controller.programs.state == "stopped"
    assert dashboard.answer("power on") == "Powering on"
    assert dashboard.answer("robotmode") == "Robotmode: IDLE"
    controller.programs.start("def no():\n  sync()\nend\n")
    assert controller.programs.state == "stopped"
    assert dashboard.answer("brake release") == "Brake releasing"
    assert dashboard.answer("robotmode") == "Robotmode: RUNNING"
