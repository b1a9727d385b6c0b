"""A generated observer run along a recording."""

from dataclasses import dataclass
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..recordings import Recording, speeds

Array = NDArray[np.float64]

#: With gain * dt above this the recursion no longer resembles a low-pass.
_LARGEST_STEP = 0.5
#: A joint this far from where the model has it (rad) is worth a word.
_RIGID = 0.05
#: Time constants after a start until the residual is taken as settled.
_SETTLING = 5.0


@dataclass(frozen=True)
class Observation:
    """What an observer saw: T samples, N joints.

    residual: torque that the rigid body does not explain (T, N), external_torque: the same with the
    model's friction and drive terms taken out (T, N); Nm, positive along the joint axis, both
    low-passed by 1/gain. settled (T,): whether the start of the segment is forgotten. starts:
    indices at which the observer was started anew, because the recording has a gap there.
    """

    timestamp: Array
    residual: Array
    external_torque: Array
    settled: NDArray[np.bool_]
    starts: tuple[int, ...]
    gain: float

    def rms(self) -> tuple[Array, Array]:
        """Return the rms (N,) of residual and external torque over the settled samples, Nm."""
        keep = self.settled if self.settled.any() else np.ones_like(self.settled)
        mean_square = (np.mean(x[keep] ** 2, axis=0) for x in (self.residual, self.external_torque))
        first, second = (np.sqrt(x) for x in mean_square)
        return first, second


def wrist_note(recording: Recording, observer: ModuleType) -> str:
    """Say where the joints that a reduced model takes as rigid are not where it has them; else nothing."""
    n = observer.DOF
    locked = observer.LOCKED_ANGLES[: recording.joints - n]
    if not len(locked):
        return ""
    away = np.abs(recording.q[:, n : n + len(locked)] - locked).max(axis=0)
    off = [f"{n + 1 + i} (by {np.rad2deg(x):.0f} deg)" for i, x in enumerate(away) if x > _RIGID]
    if not off:
        return ""
    return (
        f"{recording.name}: the model takes joint {', '.join(off)} as rigid elsewhere; what that costs is in "
        "the residual (gen-model --locked-angles, or more joints)"
    )


def observe(recording: Recording, observer: ModuleType, gain: float | None = None) -> Observation:
    """Run a generated observer along a recording of any rate and jitter.

    observer: a module of gen-model's observer.py. gain: 1/s, default the model's; at low rates it is
    lowered until gain * (median step) is 0.5. A step longer than 1/gain starts the observer anew.
    Raises InputError when the recording has fewer joints than the model, or fewer than two samples.
    """
    n = observer.DOF
    if recording.joints < n:
        raise InputError(f"{recording.name}: has {recording.joints} joints, the model needs {n}")
    if len(recording) < 2:
        raise InputError(f"{recording.name}: has fewer than two good rows; nothing to observe")
    steps = np.diff(recording.timestamp)
    median = float(np.median(steps))
    used = min(gain or observer.GAIN, _LARGEST_STEP / median)
    dt = np.concatenate([[median], steps])
    starts = (0, *(np.flatnonzero(dt > 1.0 / used).tolist()))
    q, qd, current = recording.q[:, :n], speeds(recording)[:, :n], recording.current[:, :n]
    hot = recording.joint_temperatures
    residual, external = np.empty_like(q), np.empty_like(q)
    settled = np.zeros(len(q), dtype=bool)
    for first, last in zip(starts, (*starts[1:], len(q)), strict=True):
        part = slice(first, last)
        temperature = None if hot is None else hot[part, :n]
        for target, terms in ((residual, False), (external, True)):
            instance = observer.Observer(gain=used, dt=median, terms=terms)
            piece = np.where(np.arange(last - first) == 0, median, dt[part])
            target[part] = instance.run(q[part], qd[part], current[part], temperature=temperature, dt=piece)
        settled[part] = recording.timestamp[part] - recording.timestamp[first] > _SETTLING / used
    return Observation(recording.timestamp, residual, external, settled, starts, used)
