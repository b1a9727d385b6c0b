"""The motions that are known to show what others hide, as waypoints around recorded poses.

One function a motion: (room, joint) -> Experiment. What each is for stands in the catalogue of effects.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from .room import Room

Array = NDArray[np.float64]

#: Minutes that an experiment lasts, by as many rounds as it takes.
MINUTES = 3.0
#: Minutes of warming up, and by how much a joint then is warmer, K (assumed).
WARM_MINUTES, WARMER = 15.0, 8.0
#: kg; a load whose mass and place are known, within the rating of every UR arm (UR3e: 3 kg).
LOAD = 2.0
#: rad/s^2: of ordinary moves (UR's default for movej), and of hard ones.
_GENTLE, _HARD = 1.4, 5.0
_STEP = 0.05  # rad between poses whose height is looked at
_SHRINK = (1.0, 0.75, 0.5, 0.35, 0.2, 0.1)


@dataclass(frozen=True, eq=False)
class Step:
    """A move to a pose (N,) rad, joints in step, the farthest at `speed` rad/s; then `dwell` s of rest."""

    pose: Array
    speed: float
    acceleration: float = _GENTLE
    dwell: float = 0.3


@dataclass(frozen=True, eq=False)
class Experiment:
    """Steps that end where they begin. text: what is done, in words. centre (N,): recorded pose around which.

    warmer: K by which the joints are warmer at its end. load: kg that is known and held all the while.
    """

    name: str
    text: str
    steps: tuple[Step, ...]
    centre: Array
    minutes: float = MINUTES
    warmer: float = 0.0
    load: float = 0.0

    @property
    def waypoints(self) -> Array:
        """Poses (K, N), rad."""
        return np.stack([s.pose for s in self.steps])

    @property
    def speed(self) -> float:
        """Largest speed, rad/s."""
        return max(s.speed for s in self.steps)


def ramps(room: Room, joint: int) -> Experiment:
    """Creep and walk: one joint to and fro at constant speeds, each for some seconds."""
    speeds = (0.005, 0.012, 0.025, 0.05, 0.1, 0.2, 0.5)
    ends = [_inside(room, joint, max(0.03, min(4 * v, 1.0))) for v in speeds]
    steps = [x for v, end in zip(speeds, ends, strict=True) for x in (Step(end, v), Step(room.home, v))]
    return _experiment(
        room,
        "slow_ramps",
        f"slow ramps of joint {joint + 1} at 0.005 to 0.5 rad/s, to and fro",
        room.home,
        steps,
    )


def sweep(room: Room, joint: int) -> Experiment:
    """Go through the whole range at several constant speeds."""
    low, high = _ends(room, joint)
    speeds = [share * float(room.top[joint]) for share in (0.3, 0.6, 1.0)]
    steps = [x for v in speeds for x in (Step(high, v), Step(low, v))]
    text = f"joint {joint + 1} through its range at {_listed(speeds)} rad/s, both ways"
    return _experiment(room, "full_range_sweep", text, low, steps)


def creep(room: Room, joint: int) -> Experiment:
    """Turn slowly and steadily: torque that follows the motor's angle shows as a frequency."""
    low, high = _move(room.home, joint, _clipped(room, joint, -0.4)), _inside(room, joint, 0.4)
    steps = [x for v in (0.05, 0.1, 0.2) for x in (Step(high, v), Step(low, v))]
    text = f"joint {joint + 1} slowly and steadily over 0.8 rad at 0.05, 0.1 and 0.2 rad/s"
    return _experiment(room, "slow_constant_speed", text, low, steps)


def reversals(room: Room, joint: int) -> Experiment:
    """Turn back after many different ways, at two speeds; all longer than what every gear slides (2 mrad)."""
    steps = list[Step]()
    for width in (0.003, 0.006, 0.012, 0.025, 0.05, 0.1):
        for speed in (0.03, 0.15):
            there = _inside(room, joint, width)
            steps += [Step(there, speed, dwell=0.0), Step(room.home, speed, dwell=0.0)] * 2
    text = f"many small reversals of joint {joint + 1}, 0.003 to 0.1 rad wide"
    return _experiment(room, "small_reversals", text, room.home, steps)


def still(room: Room, joint: int) -> Experiment:
    """Rest at poses over the full range, reached from either side."""
    low, high = _ends(room, joint)
    angles = np.linspace(low[joint], high[joint], 9)
    order = [*angles[1:], *angles[-2::-1]]
    steps = [Step(_move(room.home, joint, a), 0.8, dwell=1.0) for a in order]
    text = f"rest at 9 angles over the range of joint {joint + 1}, reached from either side"
    return _experiment(room, "still_poses", text, low, steps)


def wrist(room: Room, joint: int) -> Experiment:
    """Turn the last two joints while the arm stands."""
    last = room.dof - 1
    steps = list[Step]()
    for k in {max(last - 1, 0), last}:
        low, high = _ends(room, k)
        angles = [high[k], room.home[k], low[k], room.home[k]]
        steps += [Step(_move(room.home, k, a), 0.7, dwell=1.0) for a in angles]
    return _experiment(
        room, "wrist_turned", "the wrist turned through its range at a fixed arm", room.home, steps
    )


def around(room: Room, joint: int) -> Experiment:
    """Turn joint 1 with the arm out, with stops."""
    arm = room.stretched
    angles = np.linspace(room.low[0], room.high[0], 7)
    steps = [Step(_move(arm, 0, a), 0.5, dwell=1.0) for a in [*angles[1:], *angles[-2::-1]]]
    text = "joint 1 through its range with the arm out, with stops"
    return replace(_experiment(room, "joint_1_arm_out", text, _move(arm, 0, angles[0]), steps), centre=arm)


def together(room: Room, joint: int) -> Experiment:
    """Move all joints fast, then one alone over the same angles."""
    speed = float(room.top.min())
    all_of = [Step(p, speed, 2 * _GENTLE) for p in room.poses[1:]]
    alone = [Step(_move(room.home, joint, p[joint]), speed, 2 * _GENTLE) for p in room.poses[1:]]
    steps = [*all_of, Step(room.home, speed, 2 * _GENTLE), *alone]
    return _experiment(
        room,
        "together_and_alone",
        f"all joints fast together, then joint {joint + 1} alone",
        room.home,
        steps,
    )


def accelerate(room: Room, joint: int) -> Experiment:
    """Accelerate hard at different poses."""
    steps, speed = list[Step](), float(room.top[joint])
    for pose in room.poses:
        there = _move(pose, joint, pose[joint] + (0.3 if pose[joint] < room.home[joint] else -0.3))
        steps += [Step(pose, 0.8), *[Step(x, speed, _HARD, 0.1) for x in (there, pose)] * 2]
    text = f"joint {joint + 1} accelerated hard at {len(room.poses)} poses"
    return _experiment(room, "accelerate_at_poses", text, room.home, steps)


def ring(room: Room, joint: int) -> Experiment:
    """Stop short and wait."""
    angles = (0.06, 0.12, 0.06, 0.0, 0.12, 0.0)
    steps = [Step(_inside(room, joint, a), 0.6, _HARD, 0.5) for a in angles]
    return _experiment(
        room, "stop_and_ring", f"short fast moves of joint {joint + 1} with hard stops", room.home, steps
    )


def warm(room: Room, joint: int) -> Experiment:
    """Repeat one path from cold to warm."""
    text = f"joint {joint + 1} over the same path for {WARM_MINUTES:g} minutes, begun with a cold robot"
    return replace(sweep(room, joint), name="cold_and_warm", text=text, minutes=WARM_MINUTES, warmer=WARMER)


def loaded(room: Room, joint: int) -> Experiment:
    """Carry a known load over a path that is known without it."""
    low, high = _ends(room, joint)
    middle = Step(room.home, 0.5, dwell=1.5)
    steps = [
        Step(high, 0.5, dwell=1.5),
        middle,
        Step(low, 0.5, dwell=1.5),
        *[Step(p, 0.8) for p in room.poses],
    ]
    text = (
        f"joint {joint + 1} through its range and the arm between {len(room.poses)} poses with a load of "
        f"{LOAD:g} kg whose mass and centre are known"
    )
    return replace(_experiment(room, "known_load", text, room.home, steps), load=LOAD)


#: Those that exercise one joint, and those that are the same whatever joint is asked for.
OF_A_JOINT: Sequence[Callable[[Room, int], Experiment]] = (
    ramps, sweep, creep, reversals, still, accelerate, ring, together, warm, loaded,
)  # fmt: skip
OF_THE_ARM: Sequence[Callable[[Room, int], Experiment]] = (wrist, around)


def library(room: Room, joints: Sequence[int]) -> Iterator[Experiment]:
    """Give every motion for some joints (0-based) that stays as high as the recordings did.

    One that would come lower is drawn in towards its centre, and left out where that does not help.
    """
    for make in OF_A_JOINT:
        for joint in joints:
            yield from _lifted(room, make(room, joint))
    for make in OF_THE_ARM:
        yield from _lifted(room, make(room, 0))


def path(steps: Sequence[Step], spacing: float = _STEP) -> Array:
    """Return poses (T, N) along a closed path, at most `spacing` rad apart."""
    poses = [s.pose for s in (*steps, steps[0])]
    found = [poses[0][None]]
    for a, b in pairwise(poses):
        count = max(2, int(np.ceil(np.max(np.abs(b - a)) / spacing)) + 1)
        found.append(a + np.linspace(0, 1, count)[1:, None] * (b - a))
    return np.concatenate(found)


def _lifted(room: Room, experiment: Experiment) -> Iterator[Experiment]:
    centre = experiment.centre
    for share in _SHRINK:
        steps = tuple(replace(s, pose=centre + share * (s.pose - centre)) for s in experiment.steps)
        if room.clear(path(steps)):
            yield replace(experiment, steps=steps)
            return


def _experiment(room: Room, name: str, text: str, first: Array, steps: Sequence[Step]) -> Experiment:
    """Begin at a pose, with a rest."""
    return Experiment(name, text, (Step(first, 0.5, dwell=0.5), *steps), room.home)


def _move(pose: Array, joint: int, angle: float) -> Array:
    found = pose.copy()
    found[joint] = angle
    return found


def _clipped(room: Room, joint: int, way: float) -> float:
    return float(np.clip(room.home[joint] + way, room.low[joint], room.high[joint]))


def _inside(room: Room, joint: int, way: float) -> Array:
    """Return home with one joint moved by some rad, the other way where its range ends."""
    fits = room.home[joint] + way <= room.high[joint]
    return _move(room.home, joint, _clipped(room, joint, way if fits else -way))


def _ends(room: Room, joint: int) -> tuple[Array, Array]:
    return _move(room.home, joint, room.low[joint]), _move(room.home, joint, room.high[joint])


def _listed(speeds: Sequence[float]) -> str:
    return ", ".join(f"{v:.2g}" for v in speeds)
