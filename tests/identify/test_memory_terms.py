"""Terms that remember, along recordings: predicted currents and observed torques of a model that has some."""

import numpy as np
import pytest

from residuum.codegen.regressors import linear_columns
from residuum.errors import InputError
from residuum.identify.motion import predicted_current
from residuum.identify.observation import observe
from residuum.identify.requests import parse_request
from residuum.recordings import Recording
from residuum.robots.model import TermData

EXTRA = (
    TermData(name="presliding", joint=2, parameters={"A": 6.0, "zs": 0.03}),
    TermData(name="lag", joint=3, parameters={"A": 5.0, "lag": 0.02}),
    TermData(name="delay", joint=1, parameters={"d": 0.02}),
)


@pytest.fixture(scope="module")
def remembering(tools):
    return tools.make_twin(tools.ur5e()[0], 3, extra=EXTRA)


@pytest.fixture(scope="module")
def plain(tools):
    return tools.make_twin(tools.ur5e()[0], 3)


@pytest.fixture(scope="module")
def recording(remembering):
    """20 s at 125 Hz with a gap of a second; terms go on through it."""
    module, time = remembering.observer, np.arange(0, 20, 0.008)
    time = time[(time < 8.0) | (time > 9.0)]
    rate = 2 * np.pi * np.array([0.23, 0.31, 0.47])
    phase = rate * time[:, None]
    q, qd, qdd = 0.7 * np.sin(phase), 0.7 * rate * np.cos(phase), -0.7 * rate**2 * np.sin(phase)
    rigid = module.inverse_dynamics(q, qd, qdd)
    dt = np.diff(time, prepend=-0.008)
    torque = rigid + module.friction(q, qd, dt=dt, carried=rigid)
    return Recording("remembering.csv", time, q, torque / module.GAINS, qd=qd)


def rms(x) -> np.ndarray:
    return np.sqrt((x[250:-250] ** 2).mean(axis=0))


def test_predicted_currents_have_what_remembers(recording, remembering, plain) -> None:
    truth = recording.current
    with_memory = rms(predicted_current(recording, remembering.observer) - truth)
    without = rms(predicted_current(recording, plain.observer) - truth)
    assert (with_memory < 0.35 * without).all()


def test_the_observer_takes_off_what_remembers(recording, remembering, plain) -> None:
    with_memory = rms(observe(recording, remembering.observer).external_torque)
    without = rms(observe(recording, plain.observer).external_torque)
    assert (with_memory[:2] < 0.6 * without[:2]).all()


def test_the_time_of_the_first_sample_does_not_matter(recording, remembering) -> None:
    later = Recording("later.csv", recording.timestamp + 1e5, recording.q, recording.current, qd=recording.qd)
    one, other = (predicted_current(r, remembering.observer) for r in (recording, later))
    np.testing.assert_allclose(one, other, atol=1e-6)


def test_fit_says_who_can_fit_them() -> None:
    with pytest.raises(InputError, match="presliding: remembers the samples before"):
        linear_columns("presliding", 2, {})
    with pytest.raises(InputError, match="residuum explain"):
        parse_request("lag:2", 6).columns(2)
