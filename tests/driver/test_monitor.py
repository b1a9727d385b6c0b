"""The live observer against the virtual robot: quiet at rest and in motion, and loud at a push."""

from itertools import islice, takewhile
from pathlib import Path

import numpy as np
import pytest
from virtual_robot import Robot

import residuum
from residuum.codegen.load import load_file
from residuum.driver import Monitor
from residuum.virtual import Plant

MODEL = Path(residuum.__file__).parent / "generated" / "ur5e_dof6"
PUSH = {"start": 1.5, "end": 2.3, "force": (0.0, 0.0, -120.0), "link": 6, "profile": "hold"}


@pytest.fixture
def observer():
    return load_file(MODEL / "observer.py")


def test_every_package_goes_through_it(robot, observer) -> None:
    monitor = Monitor("127.0.0.1", observer, robot.ports.rtde)
    last = list(islice(monitor.readings(), 40))[-1]
    assert last.lost == 0
    assert last.packages >= 40
    assert last.threshold == pytest.approx(observer.THRESHOLDS)
    assert last.temperature == pytest.approx(43.0, abs=5.0)
    assert last.detections.sum() == 0


def test_a_push_is_a_detection_with_its_time(observer) -> None:
    robot = Robot(plant=Plant(external_contact=(PUSH,)))
    try:
        monitor = Monitor("127.0.0.1", observer, robot.ports.rtde)
        seen = list(takewhile(lambda reading: reading.time < 2.2, monitor.readings()))
    finally:
        robot.close()
    before = [r for r in seen if r.time < 1.5]
    after = seen[-1]
    assert before and all(r.detections.sum() == 0 for r in before)
    assert after.detections.sum() >= 1
    assert 1.5 < after.latest < 1.9
    assert after.over.any()
    assert np.abs(after.external[1]) > 30.0
