"""A small robot that follows the model: inverse dynamics as generated, friction inside the fitted family."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from residuum.codegen.generate import generate
from residuum.codegen.load import load_text
from residuum.recordings import Recording
from residuum.robots import Robot, load_robot
from residuum.robots.model import Model, TermData
from residuum.symbolic.nominal import nominal_model

SHARED = Path(__file__).resolve().parents[2].parent / "shared" / "recordings"

# UR5e factory calibration sheet: Coulomb level and torque at 3.2 rad/s, joint side, Nm
COULOMB = np.array([5.9, 6.5, 5.0, 1.4, 1.2, 1.3])
VISCOUS = (np.array([18.0, 22.0, 18.0, 4.4, 3.8, 4.0]) - COULOMB) / 3.2
OFFSET = np.array([0.2, -0.4, 0.1, 0.05, -0.03, 0.02])
# real logs: rms about 5-10 % of the torque, integrated memory 0.62-0.96 s; AR(1): 2 tau
NOISE = np.array([1.2, 1.9, 0.8, 0.2, 0.2, 0.2])
MEMORY = np.array([0.92, 0.72, 0.62, 0.71, 0.68, 0.96]) / 2


@dataclass(frozen=True)
class Twin:
    """A robot with known truth: its model, and the generated code of it."""

    model: Model
    observer: object

    def recording(
        self, seconds: float, seed: int, rate: float = 100.0, noise: float = 1.0, jitter: float = 0.0
    ) -> Recording:
        rng = np.random.default_rng(seed)
        n = self.model.dof
        time = np.arange(round(seconds * rate)) / rate
        time = time + jitter * np.clip(rng.normal(size=len(time)), -2, 2) / rate
        q, qd, qdd = fourier(time, n, rng)
        torque = self.observer.inverse_dynamics(q, qd, qdd) + self.observer.friction(q, qd)
        torque = torque + noise * remembering(rng, len(time), 1 / rate, n)
        current = torque / self.observer.GAINS
        return Recording("simulated.csv", time + 10.0, q, current, qd=qd)


def fourier(time, n: int, rng, harmonics: int = 5, base: float = 0.1):
    """Sums of sines as in identification experiments: up to 0.5 Hz, about 1.5 rad/s."""
    q, qd, qdd = (np.zeros((len(time), n)) for _ in range(3))
    for k in range(1, harmonics + 1):
        w = 2 * np.pi * base * k
        a, b = rng.normal(size=(2, n)) * 0.9 / np.sqrt(harmonics) / w * 1.3
        s, c = np.sin(w * time)[:, None], np.cos(w * time)[:, None]
        q += a * s - b * c
        qd += w * (a * c + b * s)
        qdd += w**2 * (-a * s + b * c)
    return q + rng.uniform(-1.5, 1.5, n), qd, qdd


def remembering(rng, count: int, dt: float, n: int, scale=NOISE, memory=MEMORY):
    """AR(1) noise a joint: stationary standard deviation `scale`, time constant `memory`."""
    from scipy.signal import lfilter

    keep = np.exp(-dt / memory[:n])
    drive = rng.normal(size=(count, n)) * np.sqrt(1 - keep**2)
    drive[0] = rng.normal(size=n)
    columns = [lfilter([1.0], [1.0, -k], drive[:, i]) for i, k in enumerate(keep)]
    return scale[:n] * np.column_stack(columns)


def perturbed(robot: Robot, rng) -> Robot:
    """The robot with other masses, centres and inertias; physical, and not where the prior has them."""
    joints = []
    for joint in robot.joint:
        scale = rng.uniform(0.85, 1.15)
        centre = tuple(c * rng.uniform(0.9, 1.1) for c in joint.centre_of_mass)
        inertia = tuple(x * scale * 1.1 for x in joint.inertia)
        rotor = joint.rotor_inertia * rng.uniform(0.8, 1.2)
        changes = {
            "mass": joint.mass * scale,
            "centre_of_mass": centre,
            "inertia": inertia,
            "rotor_inertia": rotor,
        }
        joints.append(joint.model_copy(update=changes))
    return robot.model_copy(update={"joint": tuple(joints)})


def make_twin(robot: Robot, dof: int = 6, friction: bool = True, extra: tuple[TermData, ...] = ()) -> Twin:
    model = nominal_model(robot, "", dof)
    terms = []
    for i in range(dof if friction else 0):
        terms.append(TermData(name="coulomb", joint=i + 1, parameters={"Fc": COULOMB[i]}))
        terms.append(TermData(name="viscous", joint=i + 1, parameters={"Fv": VISCOUS[i]}))
        terms.append(TermData(name="offset", joint=i + 1, parameters={"c": OFFSET[i]}))
    model = model.model_copy(update={"term": (*terms, *extra)})
    return Twin(model, load_text(generate(model).files["observer.py"]))


@lru_cache(maxsize=2)
def ur5e() -> tuple[Robot, str]:
    return load_robot("ur5e")


@pytest.fixture(scope="session")
def twin() -> Twin:
    return make_twin(ur5e()[0])


@pytest.fixture
def shared() -> Path:
    if not SHARED.is_dir():
        pytest.skip("the shared real recordings are not beside this checkout")
    return SHARED


def write_csv(path: Path, recording: Recording, current: bool = True) -> Path:
    names = ("q", "qd", "current") if current else ("q", "qd")
    header = ["timestamp", *(f"actual_{c}_{j}" for c in names for j in range(recording.joints))]
    table = np.column_stack([recording.timestamp, *(getattr(recording, c) for c in names)])
    np.savetxt(path, table, fmt="%.9g", delimiter=",", header=",".join(header), comments="")
    return path


@pytest.fixture
def save(tmp_path: Path) -> Callable[..., Path]:
    return lambda recording, name="run.csv", current=True: write_csv(tmp_path / name, recording, current)


@pytest.fixture(scope="session")
def tools() -> SimpleNamespace:
    """The functions above, for tests that build their own robots."""
    return SimpleNamespace(
        make_twin=make_twin, perturbed=perturbed, ur5e=ur5e, write_csv=write_csv, NOISE=NOISE
    )
