"""A foreign robot: MuJoCo's constraint solver holds its friction, a PD controller with feed-forward moves it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from residuum.recordings import Recording
from residuum.robots import Robot
from residuum.virtual.model import Build, RigidBody, build_model, link_body

from .paths import STEP

Array = NDArray[np.float64]
State = Callable[[Array, Array, Array, Array], Array]  # (q, qd, load Nm, deg C) -> (6,) Nm

#: Nm/rad and Nm s/rad of the controller; share of the dry friction that it feeds forward.
STIFF = np.array([3e4, 3e4, 2e4, 6e3, 6e3, 5e3])
DAMP, HELPED = 0.02 * STIFF, 0.8
#: rad, rad/s, A/sqrt: the sensors' steps and noise; part of the current's noise that the next sample keeps.
TICK, SPEED_NOISE, KEPT = 1.2e-5, 8e-4, 0.6
#: s; gears warm up by WARM deg C with this time.
HEATING, WARM = 250.0, 7.0


@dataclass(frozen=True)
class Healthy:
    """A robot as it left the factory; arrays (6,).

    masses, rotors: times those of the robot file; dry (Nm), damping (Nm s/rad): its friction; curved: whether
    it has a Stribeck bump and bends; offset: Nm; noise: of the current, A; soft: s, how softly MuJoCo sticks.
    """

    masses: Array
    rotors: Array
    dry: Array
    damping: Array
    curved: bool
    offset: Array
    noise: Array
    soft: float
    cold: Array  # deg C
    heat: Array


def nothing(_q: Array, _qd: Array, _load: Array, _hot: Array) -> Array:
    """No torque."""
    return np.zeros(6)


@dataclass(frozen=True)
class Gear:
    """What the changed joint's gear does beside holding and dragging: nothing, or one of these.

    stiffness: Nm/rad; gap: half of its slack, rad; bristle: rad over which friction builds up (Dahl); late: s
    by which friction's sign is late.
    """

    stiffness: float = 0.0
    gap: float = 0.0
    bristle: float = 0.0
    late: float = 0.0


@dataclass(frozen=True)
class Change:
    """What is different: name, joints (1..6; empty where they are not scored) and the true parameters.

    dry, drag: change of friction loss, and torque that drags; delay: s that currents come late; held: spans of
    the recording (shares) in which the load is there (None: always); push: link and place on it, m; force: N by
    share of the recording. Only of inverse.py: gear; later: torque (T, 6) Nm of time (T,), q and the sign of
    friction (T, 6), which the catalogue has no name for.
    """

    effect: str = ""
    joints: tuple[int, ...] = ()
    parameters: Mapping[str, Any] = field(default_factory=dict)
    links: Mapping[int, RigidBody] = field(default_factory=dict)
    load: RigidBody | None = None
    held: tuple[tuple[float, float], ...] | None = None
    gravity: Array | None = None
    rotor: Array = field(default_factory=lambda: np.ones(6))
    dry: State = nothing
    drag: State = nothing
    encoder: Array = field(default_factory=lambda: np.zeros(6))
    gain: Array = field(default_factory=lambda: np.ones(6))
    delay: float = 0.0
    push: tuple[int, Array] = (6, np.zeros(3))
    force: Callable[[float], Array | None] = lambda _share: None
    gear: Gear = Gear()
    later: Callable[[Array, Array, Array], Array] | None = None


def record(
    robot: Robot, healthy: Healthy, change: Change, path: Array, rate: int, seed: int, warmer: float
) -> Recording:
    """Simulate 2 ms a step along a path (T, 6); return it at a rate, Hz. warmer: deg C above cold."""
    model, plain = models(robot, healthy, change)
    data, empty = mujoco.MjData(model), _Load(model, change)
    gains = np.array([x.drive_gain for x in robot.joint])
    speed = np.gradient(path, STEP, axis=0)
    ahead = inverse(plain, path, speed, np.gradient(speed, STEP, axis=0))
    time = np.arange(len(path)) * STEP
    hot = heated(healthy, warmer, time)
    data.qpos[:], sum_ = path[0] + change.encoder, np.zeros(6)
    q, qd, torque = (np.empty_like(path) for _ in range(3))
    for i in range(len(path)):
        share = i / len(path)
        empty.hold(share)
        q[i], qd[i] = data.qpos - change.encoder, data.qvel
        error = path[i] - q[i]
        sum_ += STEP * error
        torque[i] = (
            ahead[i] + healthy.offset + HELPED * healthy.dry * np.tanh(speed[i] / 0.02)
            + STIFF * (error + 4 * sum_) + DAMP * (speed[i] - qd[i])
        )  # fmt: skip
        state = q[i], qd[i], ahead[i], hot[i]
        model.dof_frictionloss[:] = np.maximum(dry_level(healthy, qd[i]) + change.dry(*state), 0.05)
        data.qfrc_applied[:] = torque[i] - healthy.offset - change.drag(*state)
        _push(data, change, change.force(share))
        mujoco.mj_step(model, data, 2)
    if not np.isfinite(q).all():
        raise RuntimeError(f"{change.effect}: the simulation blew up")
    return sensed(time, q, qd, torque / gains / change.gain, hot, healthy, change, rate, seed)


def models(robot: Robot, healthy: Healthy, change: Change) -> tuple[Any, Any]:
    """Return the robot as it is, and as its controller takes it to be."""
    links = {}
    for k, factor in enumerate(healthy.masses, start=1):
        body = change.links.get(k) or link_body(robot, k)
        links[k] = RigidBody(body.mass * factor, body.centre_of_mass, body.inertia * factor)
    model = build_model(robot, Build(links, change.load, change.gravity), STEP / 2)
    model.opt.disableflags = int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    model.dof_armature[:] *= healthy.rotors * change.rotor
    model.dof_damping[:] = healthy.damping
    model.dof_solref[:] = [healthy.soft, 1.0]
    return model, build_model(robot, Build(), STEP / 2)


class _Load:
    """A load that comes and goes: without it nearly nothing hangs at the flange."""

    def __init__(self, model: Any, change: Change) -> None:
        self.model, self.spans, self.body = model, change.held, model.nbody - 1
        self.whole = (model.body_mass[self.body].copy(), model.body_inertia[self.body].copy())

    def hold(self, share: float) -> None:
        """Hold or drop it at a share of the recording."""
        if self.spans is not None:
            here = 1.0 if any(a <= share < b for a, b in self.spans) else 1e-6
            self.model.body_mass[self.body] = here * self.whole[0]
            self.model.body_inertia[self.body] = here * self.whole[1]


def heated(healthy: Healthy, warmer: float, time: Array) -> Array:
    """Return the gears' temperatures (T, 6), deg C, at times (T,) s."""
    return np.asarray(healthy.cold + warmer + healthy.heat * WARM * (1 - np.exp(-time[:, None] / HEATING)))


def dry_level(healthy: Healthy, qd: Array) -> Array:
    """Return dry friction (.., 6) Nm at speeds (.., 6)."""
    bends = 1 + 0.15 * np.exp(-((qd / 0.1) ** 2)) + 0.12 * np.sqrt(np.abs(qd)) if healthy.curved else 1.0
    return np.asarray(healthy.dry * bends)


def inverse(model: Any, q: Array, qd: Array, qdd: Array) -> Array:
    """Return the torque (T, 6) Nm of a motion by MuJoCo's inverse dynamics."""
    data, found = mujoco.MjData(model), np.empty_like(q)
    for i in range(len(q)):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[i], qd[i], qdd[i]
        mujoco.mj_inverse(model, data)
        found[i] = data.qfrc_inverse
    return found


def _push(data: Any, change: Change, force: Array | None) -> None:
    link, place = change.push
    at = 0.0 if force is None else force
    data.xfrc_applied[link, :3] = at
    data.xfrc_applied[link, 3:] = np.cross(data.xmat[link].reshape(3, 3) @ place, at * np.ones(3))


def sensed(
    time: Array, q: Array, qd: Array, current: Array, hot: Array, healthy: Healthy, change: Change,
    rate: int, seed: int,
) -> Recording:  # fmt: skip
    """Return what sensors report, by a seed, at a rate (Hz), of angles, speeds, currents (T, 6) and deg C."""
    rng, late = np.random.default_rng(seed), round(change.delay / STEP)
    current = np.concatenate([np.repeat(current[:1], late, axis=0), current[: len(current) - late]])
    white, noise = rng.standard_normal(q.shape), np.zeros(q.shape)
    for i in range(1, len(q)):
        noise[i] = KEPT * noise[i - 1] + np.sqrt(1 - KEPT**2) * white[i]
    every = slice(None, None, round(1 / (STEP * rate)))
    return Recording(
        "foreign",
        500.0 + time[every],
        (np.round(q / TICK) * TICK)[every],
        (current + healthy.noise * noise)[every],
        qd=(qd + SPEED_NOISE * rng.standard_normal(q.shape))[every],
        joint_temperatures=np.round(hot[every] * 4) / 4,
    )
