"""What all of them start from: torques, residuals and one group of columns for each candidate effect.

Rigid-body columns are residuum's regressor; the candidates' are the plain textbook ones, through the same
10 Hz zero-phase low-pass as the torque, at 40 rows a second.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.signal import butter, sosfiltfilt

from residuum.codegen.regressors import regressor
from residuum.identify.physical import link_map
from residuum.recordings import read
from residuum.robots import load_robot
from residuum.symbolic.nominal import nominal_model, robot_arm

CUTOFF, ROWS = 10.0, 40.0  # Hz, rows a second
WORK = 125.0  # Hz at which columns are made
STEP = 1e-4  # rad, of finite differences


@dataclass(frozen=True)
class Group:
    """A candidate: effect, the joint it sits on (0: all), and its columns' places by joint 0..5."""

    effect: str
    joint: int
    places: tuple[tuple[int, ...], ...]  # per joint, among the candidate columns of that joint


@dataclass(frozen=True)
class Track:
    """Rows of one recording: torque and nominal torque (n, 6); per joint base (n, B), friction (n, 3)
    (sign, speed, one) and candidates (n, C); whether each joint moves (n, 6)."""

    torque: np.ndarray
    nominal: np.ndarray
    base: list[np.ndarray]
    friction: list[np.ndarray]
    candidates: list[np.ndarray]
    moving: np.ndarray


@dataclass(frozen=True)
class Body:
    """An arm's torque regressor, published parameters, the map from links, gravity along x and y."""

    columns: object
    published: np.ndarray
    links: np.ndarray
    level: tuple
    gains: np.ndarray
    gears: np.ndarray


@lru_cache(maxsize=4)
def body(name: str) -> Body:
    robot, digest = load_robot(name)
    model = nominal_model(robot, digest, 6)
    columns = regressor(robot_arm(model))
    level = []
    for way in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)):
        turned = nominal_model(robot.model_copy(update={"gravity": tuple(9.81 * x for x in way)}), digest, 6)
        r = regressor(robot_arm(turned))
        level.append((r, np.array([turned.base[n].value for n in r.base])))
    published = np.array([model.base[n].value for n in columns.base])
    gains = np.array([j.drive_gain for j in robot.joint])
    gears = np.array([j.gear for j in robot.joint])
    return Body(columns, published, link_map(model).links, tuple(level), gains, gears)


def torque_at(columns, base, q, qd, qdd):
    return columns.matrix("torque", q=q, qd=qd, qdd=qdd) @ base


def load(path, robot: str) -> tuple[Track, list[Group]]:
    """Return a recording's rows and the candidate groups (the same for all recordings of a robot)."""
    arm, record = body(robot), read(path)
    time = record.timestamp - record.timestamp[0]
    rate = 1.0 / np.median(np.diff(time))
    every = max(round(rate / WORK), 1)
    thin = rate / every

    def smooth(x, cut=CUTOFF, fs=rate):
        return sosfiltfilt(butter(2, cut, fs=fs, output="sos"), x, axis=0)

    q, torque = smooth(record.q, 20.0)[::every], smooth(record.current * arm.gains)[::every]
    speed = record.qd if record.qd is not None else np.gradient(record.q, time, axis=0)
    fine = speed[::every]
    qd = np.gradient(q, 1.0 / thin, axis=0)
    qdd = smooth(np.gradient(qd, 1.0 / thin, axis=0), CUTOFF, thin)
    hot = record.joint_temperatures[::every]
    matrix = arm.columns.matrix("torque", q=q, qd=qd, qdd=qdd)
    nominal = matrix @ arm.published
    pick = slice(round(0.5 * thin), -round(0.5 * thin), max(round(thin / ROWS), 1))

    def rows(x):
        return smooth(x, CUTOFF, thin)[pick]

    groups, own, shared = [], [], [[] for _ in range(6)]
    for j in range(6):
        named = joint_columns(q[:, j], fine[:, j], nominal[:, j], qdd[:, j], hot[:, j], arm.gears[j], thin)
        own.append(np.column_stack([c for columns in named.values() for c in columns]))
        at = 0
        for effect, columns in named.items():
            places = tuple(range(at, at + len(columns)))
            groups.append(Group(effect, j + 1, tuple(places if k == j else () for k in range(6))))
            at += len(columns)
    for effect, joint, block in shared_columns(arm, matrix, q, qd, qdd, nominal, thin):
        places = []
        for j in range(6):
            at = own[j].shape[1] + sum(c.shape[1] for c in shared[j])
            live = [k for k in range(block.shape[2]) if np.abs(block[:, j, k]).max() > 1e-9]
            shared[j].append(block[:, j, :])
            places.append(tuple(at + k for k in live))
        groups.append(Group(effect, joint, tuple(places)))
    sign = soft(fine)
    return Track(
        rows(torque),
        rows(nominal),
        [rows(matrix[:, j, :]) for j in range(6)],
        [rows(np.column_stack([sign[:, j], fine[:, j], np.ones(len(q))])) for j in range(6)],
        [rows(np.column_stack([own[j], *shared[j]])) for j in range(6)],
        (np.abs(qd) > 0.02)[pick],
    ), groups


def soft(qd):
    return np.tanh(qd / 0.005)


def joint_columns(q, qd, load_torque, qdd, hot, gear, rate):
    """Candidate columns of one joint by effect."""
    sign = soft(qd)
    slope = np.gradient(load_torque) * rate
    warm = hot - 35.0
    ripple = [f(k * gear * q) for k in (1, 2, 4) for f in (np.cos, np.sin)]
    return {
        "coulomb_friction": [sign],
        "viscous_friction": [qd],
        "friction_asymmetry": [np.ones_like(q)],
        "stribeck": [np.exp(-((qd / v) ** 2)) * sign for v in (0.05, 0.2)],
        "nonlinear_viscous": [qd * np.abs(qd), qd**3],
        "load_dependent_friction": [np.abs(load_torque) * sign],
        "temperature_dependent_friction": [warm * sign, warm * qd],
        "presliding_hysteresis": [dahl(q, 0.01) - sign],
        "velocity_lag": [lagged(sign, 0.01, rate) - sign],
        "torque_ripple": ripple,
        "position_dependent_friction": [sign * np.sin(q), sign * np.cos(q)],
        "cable_spring": [q],
        "rotor_inertia": [qdd],
        "drive_gain": [load_torque + 4.0 * sign],
        "joint_elasticity": [np.gradient(slope) * rate],
        "backlash": [np.gradient(np.tanh(load_torque / 0.5)) * rate],
    }


def shared_columns(arm, matrix, q, qd, qdd, nominal, rate):
    """Candidates that move several joints: (effect, joint or 0, (T, 6, k))."""
    for link in range(6):
        effect = "payload" if link == 5 else "link_inertial"
        yield effect, 0, matrix @ arm.links[:, 10 * link : 10 * link + 10]
    yield "base_tilt", 0, np.stack([torque_at(r, b, q, 0 * q, 0 * q) for r, b in arm.level], axis=2)
    yield "time_delay", 0, (np.gradient(nominal, axis=0) * rate)[:, :, None]
    for j in range(6):
        moved = np.zeros(6)
        moved[j] = STEP
        change = (torque_at(arm.columns, arm.published, q + moved, qd, qdd) - nominal) / STEP
        yield "encoder_offset", j + 1, change[:, :, None]


def dahl(q, travel):
    z, out = 0.0, np.empty_like(q)
    for k, dq in enumerate(np.diff(q, prepend=q[0])):
        end = 1.0 if dq > 0 else -1.0
        z = end + (z - end) * np.exp(-abs(dq) / travel)
        out[k] = z
    return out


def lagged(x, lag, rate):
    out, y, a = np.empty_like(x), x[0], np.exp(-1.0 / (lag * rate))
    for k, value in enumerate(x):
        y = a * y + (1.0 - a) * value
        out[k] = y
    return out


def finding(group: Group, confidence: float = 0.5) -> dict:
    joints = [group.joint] if group.joint else [j + 1 for j in range(6) if group.places[j]]
    return {"effect": group.effect, "joints": joints, "indistinguishable_from": [], "confidence": confidence,
            "parameters": {}, "equation": "", "share": {}, "next_motion": None}  # fmt: skip


def answer(findings: list[dict]) -> dict:
    verdict = "explained" if findings else "nothing_missing"
    return {"schema": 1, "verdict": verdict, "findings": findings, "where": [], "placebo_rate": None,
            "fit": {"unit": "Nm", "before": [], "after": []}}  # fmt: skip
