"""What all tests share: models, generated trees, and the real recordings when they are there."""

import signal
import threading
from functools import cache
from pathlib import Path

import pytest

from residuum.codegen.generate import generate
from residuum.robots import load_robot
from residuum.symbolic.nominal import nominal_model

RECORDINGS = Path(__file__).resolve().parents[2] / "shared" / "recordings"


if threading.current_thread() is threading.main_thread():
    # shells start background jobs with Ctrl-C ignored, and so would the commands that are tested be started
    signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--update", action="store_true", help="write the golden files anew instead of comparing")
    parser.addoption("--robot-host", metavar="ADDRESS", help="a robot or URSim for the tests that only read")


@cache
def _generated(robot: str, dof: int, variant: str = "full"):
    return generate(nominal_model(*load_robot(robot), dof, variant=variant))


@pytest.fixture(scope="session")
def generated():
    """(robot, dof, variant) -> Generated, each made once a session."""
    return _generated


@pytest.fixture(scope="session")
def real_recordings() -> Path:
    """Folder of the real recordings; without it the test is skipped."""
    if not RECORDINGS.is_dir():
        pytest.skip("the real recordings are not beside this checkout")
    return RECORDINGS
