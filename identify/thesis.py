"""The scheme of Gylling 2019 (KTH, ch. 3.2) on joints 1-3, as it stands there, to compare with.

The residual of the thesis' own three-joint model, without friction, is fitted sample by sample with a
regressor whose columns change with the noise band of the speed (eq. 3.2.8), by plain least squares
(eq. 3.2.7). Joint 1's regressor is multiplied by a gain that grows with the arm's reach; joints 2 and 3
get a column q (eq. 3.2.9-3.2.12). Nothing here is used by the other scheme.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from ..codegen.generate import observer_text
from ..codegen.load import load_text
from ..errors import InputError
from ..recordings import Recording, read, speeds
from ..recordings.audit import clean
from ..robots import Robot
from ..robots.model import FitRecord, Input, Model, ThesisFriction
from ..symbolic.nominal import nominal_model
from .observation import observe
from .rows import REST

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

JOINTS = 3
#: s; the arm rests where no joint has moved for this long before and after.
_QUIET = 0.25


@dataclass(frozen=True)
class Run:
    """One recording as the scheme sees it; T settled samples of three joints.

    friction (T, 3): minus the observer's residual, Nm; torque (T, 3): gain times current, Nm; resting (T,);
    moving (T,): any recorded joint is faster than 0.01 rad/s. target: target speed, the measured one where
    none is recorded.
    """

    name: str
    q: Array
    qd: Array
    target: Array
    current: Array
    friction: Array
    torque: Array
    resting: Flags
    moving: Flags


@dataclass(frozen=True)
class ThesisFit:
    """The scheme's model, and its errors on runs left out: percent of torque norm and rms (Nm), (3,)."""

    model: Model
    percent: Array
    rms: Array
    runs: int


def fit_thesis(recordings: Sequence[Path], robot: Robot, robot_hash: str) -> ThesisFit:
    """Fit the thesis' friction to recordings of a robot and leave each out once.

    Raises InputError for recordings that cannot be used.
    """
    model = nominal_model(robot, robot_hash, JOINTS, variant="thesis")
    module = load_text(observer_text(model))
    lengths = {name: value.value for name, value in model.base.items()}
    runs, inputs = [], []
    for path in recordings:
        good, report = clean(read(path))
        report.require()
        if good.joints < JOINTS:
            raise InputError(f"{path}: has {good.joints} joints; the thesis' scheme needs three")
        runs.append(_run(good, module))
        inputs.append(Input(name=path.name, sha256=good.source.sha256 if good.source else ""))
    everything = friction_of(runs, lengths)
    error, torque, count = np.zeros(JOINTS), np.zeros(JOINTS), 0
    for k, run in enumerate(runs):
        others = [r for i, r in enumerate(runs) if i != k] or runs
        left = (run.friction - predict(run, friction_of(others, lengths), lengths))[run.moving]
        error += np.sum(left**2, axis=0)
        torque += np.sum(run.torque[run.moving] ** 2, axis=0)
        count += len(left)
    percent, rms = 100 * np.sqrt(error / torque), np.sqrt(error / max(count, 1))
    record = FitRecord(
        scheme="thesis (Gylling 2019, ch. 3.2)", form="momentum observer",
        cutoff=model.observer_gain / (2 * np.pi),
        order=1, zero_phase=False, folds=len(runs), left_out="a recording at a time",
        held_out_percent=tuple(percent.tolist()), held_out_rms=tuple(rms.tolist()),
        noise=(), residual_memory=(),
        parameters=17, directions=17, gains="drive gains are the robot file's, not fitted",
    )  # fmt: skip
    fitted = model.model_copy(
        update={"thesis": everything, "fit": record, "inputs": (*model.inputs, *inputs)}
    )
    return ThesisFit(fitted, percent, rms, len(runs))


def friction_of(runs: Sequence[Run], lengths: dict[str, float]) -> ThesisFriction:
    """Fit noise band, reach gain and friction to some runs (eq. 3.2.7)."""
    bands = noise_band(runs)
    gain = reach_gain(runs, lengths)
    rows = []
    for joint in range(JOINTS):
        W = np.vstack([_regressor(r, joint, bands[joint], gain, lengths) for r in runs])
        target = np.concatenate([r.friction[:, joint] for r in runs])
        rows.append(np.append(np.linalg.lstsq(W, target, rcond=1e-10)[0], [0.0])[:6])
    c, s, b1, b2, b3, alpha = (tuple(float(x) for x in column) for column in np.array(rows).T)
    return ThesisFriction(
        noise_band=tuple(bands.tolist()),
        coulomb=c,
        stiction=s,
        b1=b1,
        b2=b2,
        b3=b3,
        position=alpha,
        reach_gain=gain,
    )


def predict(run: Run, friction: ThesisFriction, lengths: dict[str, float]) -> Array:
    """Return the friction (T, 3) in Nm that the scheme predicts for a run."""
    columns = []
    for j in range(JOINTS):
        W = _regressor(run, j, friction.noise_band[j], friction.reach_gain, lengths)
        f = friction
        values = np.array([f.coulomb[j], f.stiction[j], f.b1[j], f.b2[j], f.b3[j], f.position[j]])
        columns.append(W @ values[: W.shape[1]])
    return np.column_stack(columns)


def noise_band(runs: Sequence[Run]) -> Array:
    """Return the largest |qd| (3,) at rest, rad/s: the thesis' epsilon."""
    largest = [np.abs(r.qd[r.resting]).max(axis=0) for r in runs if r.resting.any()]
    return np.maximum(np.max(largest, axis=0), 1e-4) if largest else np.full(JOINTS, REST)


def reach_gain(runs: Sequence[Run], lengths: dict[str, float]) -> tuple[float, float]:
    """Fit a exp(b |A + B|) to the peaks of joint 1's residual over reach (straight line in the logarithm).

    Peaks: local maxima of |residual| over a second either way; a is scaled so that the mean gain is one.
    """
    reach, peak = [], []
    for run in runs:
        size = np.abs(run.friction[:, 0])
        for k in range(0, len(size), 100):
            part = slice(k, k + 100)
            if run.moving[part].any() and size[part].max() > 0:
                top = k + int(np.argmax(size[part]))
                reach.append(_reach(run.q[top : top + 1], lengths)[0])
                peak.append(size[top])
    if len(peak) < 3 or np.ptp(reach) < 1e-3:
        return 1.0, 0.0
    b, _ = np.polyfit(reach, np.log(peak), 1)
    return float(1 / np.mean(np.exp(b * np.array(reach)))), float(b)


def _reach(q: Array, k: dict[str, float]) -> Array:
    """Return |A + B| in m: horizontal reach of the centres of mass of links 3 and 2 (thesis, 3.1.2)."""
    b = k["l2"] * np.cos(q[:, 1])
    a = k["L2"] * np.cos(q[:, 1]) + k["l3"] * np.cos(q[:, 1] + q[:, 2])
    return np.abs(a + b)


def _regressor(
    run: Run, joint: int, band: float, gain: tuple[float, float], lengths: dict[str, float]
) -> Array:
    """[w1 sgn(i) + w3 sgn(qd), w2 sgn(i), w3 qt, w3 qt^2, w3 qt^3] (eq. 3.2.8), and q on joints 2, 3."""
    qd, target, i = run.qd[:, joint], run.target[:, joint], run.current[:, joint]
    slow = np.abs(qd) < band
    w1, w2, w3 = slow & run.resting, slow & ~run.resting, ~slow
    columns = [
        w1 * np.sign(i) + w3 * np.sign(qd),
        w2 * np.sign(i),
        w3 * target,
        w3 * target**2,
        w3 * target**3,
    ]
    if joint == 0:
        a, b = gain
        return (a * np.exp(b * _reach(run.q, lengths)))[:, None] * np.column_stack(columns)
    return np.column_stack([*columns, run.q[:, joint]])


def _run(recording: Recording, module: ModuleType) -> Run:
    seen = observe(recording, module)
    keep = seen.settled
    qd = speeds(recording)
    moving = np.asarray((np.abs(qd) > REST).any(axis=1), dtype=np.bool_)
    target = recording.target_qd if recording.target_qd is not None else qd
    current = recording.current[:, :JOINTS]
    return Run(
        recording.name, recording.q[keep, :JOINTS], qd[keep, :JOINTS], target[keep, :JOINTS], current[keep],
        -seen.residual[keep], module.motor_torque(current)[keep],
        _resting(recording.timestamp, moving)[keep], moving[keep],
    )  # fmt: skip


def _resting(time: Array, moving: Flags) -> Flags:
    """Whether nothing has moved from a quarter of a second before to a quarter after."""
    total = np.concatenate([[0], np.cumsum(moving)])
    first = np.searchsorted(time, time - _QUIET, "left")
    last = np.searchsorted(time, time + _QUIET, "right")
    return np.asarray(total[last] == total[first], dtype=np.bool_)


def table(found: ThesisFit) -> str:
    """Return the scheme's parameters and errors as text."""
    f = found.model.thesis
    assert f is not None
    lines = [f"{'joint':24}" + "".join(f"{i:>10}" for i in range(1, JOINTS + 1))]
    for name, unit in (
        ("noise_band", "rad/s"),
        ("coulomb", "Nm"),
        ("stiction", "Nm"),
        ("b1", ""),
        ("b2", ""),
        ("b3", ""),
        ("position", "Nm/rad"),
    ):
        lines.append(f"{f'{name} {unit}':24}" + "".join(f"{x:10.4g}" for x in getattr(f, name)))
    lines.append(f"{'left out: error, %':24}" + "".join(f"{x:10.2f}" for x in found.percent))
    lines.append(f"{'left out: rms, Nm':24}" + "".join(f"{x:10.3f}" for x in found.rms))
    lines.append(
        f"joint 1 times {f.reach_gain[0]:.3g} exp({f.reach_gain[1]:.3g} reach);"
        f" {found.runs} recordings, one at a time left out"
    )
    return "\n".join(lines)
