"""What the guard's tests share."""

import pytest
from guarding import Printer, model_of, simulated, then_rest


@pytest.fixture(scope="session")
def small() -> Printer:
    """Three joints with friction; made once."""
    return Printer(model_of("ur5e", 3, 25.0, 8.0))


@pytest.fixture(scope="session")
def collision(small):
    """A motion with a push on joint 2 from frame 1320 on, then a long rest."""
    return then_rest(small.observer, simulated(small.observer, dof=3), at=1500)
