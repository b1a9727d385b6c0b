import pytest
from virtual_robot import Robot

from residuum.robots import load_robot
from residuum.virtual.server import Controller


@pytest.fixture
def robot():
    running = Robot()
    yield running
    running.close()


@pytest.fixture
def controller():
    return Controller(load_robot("ur5e")[0])
