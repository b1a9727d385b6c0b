"""A model that knows the virtual arm's friction well enough, without a fit: made once a session."""

import numpy as np
import pytest

from residuum.collisions.models import Known, eyes
from residuum.robots import load_robot
from residuum.robots.model import TermData, Thresholds
from residuum.symbolic.nominal import nominal_model

#: Coulomb (Nm) and viscous (Nm s/rad) of a fit to the virtual UR5e, and limits in Nm.
COULOMB, VISCOUS = (6.7, 7.2, 5.7, 1.6, 1.4, 1.5), (5.3, 6.9, 6.4, 1.5, 1.3, 1.3)
LIMITS = (7.0, 8.0, 6.0, 2.0, 2.0, 2.0)


@pytest.fixture(scope="session")
def robot():
    return load_robot("ur5e")[0]


@pytest.fixture(scope="session")
def model():
    terms = [TermData(name="coulomb", joint=j + 1, parameters={"Fc": c}) for j, c in enumerate(COULOMB)]
    terms += [TermData(name="viscous", joint=j + 1, parameters={"Fv": v}) for j, v in enumerate(VISCOUS)]
    update = {"term": tuple(terms), "thresholds": Thresholds(static=LIMITS)}
    return nominal_model(*load_robot("ur5e"), 6).model_copy(update=update)


@pytest.fixture(scope="session")
def seen(model):
    return eyes(Known("test", model, tuple(np.array(LIMITS))), 10.0)
