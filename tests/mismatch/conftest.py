"""What the tests of `explain` share: a UR5e of three joints with known truth, and simulated recordings."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import pytest

from residuum.codegen.generate import generate
from residuum.codegen.load import load_text
from residuum.mismatch.candidates import own_columns
from residuum.mismatch.columns import space_of
from residuum.mismatch.evidence import Evidence, gather
from residuum.mismatch.physics import Physics, physics_of
from residuum.mismatch.rows import common_names
from residuum.mismatch.track import Setup
from residuum.recordings import Recording
from residuum.robots import Robot, load_robot
from residuum.robots.model import Model
from residuum.symbolic.nominal import nominal_model
from residuum.virtual import Plant, simulate
from residuum.virtual import effects as e
from residuum.virtual.motions import fourier
from residuum.virtual.surroundings import Contact

FRICTION = np.array([[5.0, 2.0], [6.0, 3.0], [4.0, 2.0]])
_W = 2 * np.pi * np.array([0.13, 0.21, 0.33])
_SIZE, _PHASE, _MIDDLE = np.array([1.0, 0.6, 0.7]), np.array([0.0, 1.0, 2.0]), np.array([0.0, -1.5, 1.2])


def motion(time):
    """Three joints in sines: q, qd, qdd (T, 3) at any instants, exact."""
    angle = np.outer(time, _W) + _PHASE
    return _MIDDLE + _SIZE * np.sin(angle), _SIZE * _W * np.cos(angle), -_SIZE * _W**2 * np.sin(angle)


@dataclass(frozen=True)
class Arm:
    """Three joints: model, the generated code of it, and what rows are made with."""

    robot: Robot
    model: Model

    @cached_property
    def observer(self):
        return load_text(generate(self.model).files["observer.py"])

    @cached_property
    def physics(self) -> Physics:
        return physics_of(self.model, self.robot)

    @cached_property
    def gains(self):
        return np.array([j.drive_gain for j in self.model.joint])

    @cached_property
    def setup(self) -> Setup:
        columns = self.physics.regressor
        space = space_of(columns, own_columns(float(self.robot.joint[0].gear)), common_names(3))
        return Setup(self.physics, space, self.gains, self.physics.published, FRICTION)

    def recording(self, time, torque, q=None, qd=None) -> Recording:
        """A recording of a torque (T, 3) on the drive side along `motion`."""
        q0, qd0, _ = motion(time)
        return Recording(
            "known", time, q0 if q is None else q, torque / self.gains, qd=qd0 if qd is None else qd,
            joint_temperatures=np.full((len(time), 3), 35.0),
        )  # fmt: skip

    def scaled(self, field: str, times) -> "Arm":
        """The arm of whose six joints a number is so many times as large."""
        joints = zip(self.robot.joint, times, strict=True)
        other = tuple(j.model_copy(update={field: x * getattr(j, field)}) for j, x in joints)
        robot = self.robot.model_copy(update={"joint": other})
        return Arm(robot, nominal_model(robot, "", 3))

    def column(self, rows, name: str, row: int):
        """A common column (n,) in a joint's rows."""
        space = self.setup.space
        return rows.columns[row][:, len(space.seen[row]) + len(space.own) + space.common.index(name)]


@pytest.fixture(scope="session")
def arm() -> Arm:
    robot, digest = load_robot("ur5e")
    return Arm(robot, nominal_model(robot, digest, 3))


@pytest.fixture(scope="session")
def along():
    return motion


@pytest.fixture(scope="session")
def recorded_arm(arm, along):
    """(friction of qd (T, 3) in Nm, noise in Nm, seed, the arm that moves) -> 60 s of it.

    beside: what else acts, of time (T,) and q (T, 3), in Nm.
    """

    def of(friction, noise: float, seed: int, body: Arm = arm, beside=lambda time, q: 0.0) -> Recording:
        time, rng = np.arange(0.0, 60.0, 0.008), np.random.default_rng(seed)
        q, qd, qdd = along(time)
        torque = body.observer.inverse_dynamics(q, qd, qdd) + friction(qd) + beside(time, q)
        return arm.recording(time, torque + noise * rng.standard_normal(q.shape))

    return of


@pytest.fixture(scope="session")
def moved(arm, recorded_arm):
    """What `recorded_arm` takes -> evidence of it."""
    return lambda *a, **named: gather([recorded_arm(*a, **named)], [True], arm.model, arm.robot)


@pytest.fixture(scope="session")
def healthy(moved) -> Evidence:
    """60 s of the published arm with Coulomb and viscous friction, and noise."""
    return moved(lambda qd: np.array([5.0, 6.0, 4.0]) * np.tanh(qd / 1e-3) + 2.0 * qd, 0.3, seed=5)


#: Changed robots: what differs from the one that the reference recordings are of.
CHANGED = {
    "clean": {},
    "payload": {"payload": e.Payload(mass=2.0, centre_of_mass=(0.0, 0.02, 0.05))},
    "load": {"load_dependent_friction": (e.LoadDependentFriction(joint=2, coefficient=0.1),)},
    "gain": {"drive_gain": (e.DriveGain(joint=3, error=0.2),)},
    "pushed": {
        "external_contact": tuple(
            Contact(start=t, end=t + 1.5, force=(20.0, -20.0, 20.0), link=6, profile="hold")
            for t in (8.0, 20.0)
        )
    },
    "asymmetry": {"friction_asymmetry": (e.FrictionAsymmetry(joint=1, torque=2.0),)},
}


@pytest.fixture(scope="session")
def simulated(tmp_path_factory):
    """(kind of CHANGED, seed) -> CSV of 30 s at 125 Hz, each simulated once a session."""
    folder, robot, made = tmp_path_factory.mktemp("simulated"), load_robot("ur5e")[0], {}

    def of(kind: str, seed: int) -> Path:
        if (kind, seed) not in made:
            run = simulate(robot, Plant(**CHANGED[kind]), fourier(robot, 30.0, seed=seed), 125, seed)
            made[kind, seed] = folder / f"{kind}_{seed}.csv"
            run.recording.write_csv(made[kind, seed])
        return made[kind, seed]

    return of
