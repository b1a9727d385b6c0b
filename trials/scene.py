"""What an effect is drawn in, and a drawn effect: one number that sizes it, and the plant it makes."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from ..robots import Robot
from ..virtual import Motion, Plant
from .healthy import Friction

Array = npt.NDArray[np.float64]
Fields = dict[str, Any]  # of a Plant


@dataclass(frozen=True)
class Scene:
    """Robot, the motions of the observed recordings, its usual friction, and the case's chance."""

    robot: Robot
    motions: tuple[Motion, ...]
    usual: Friction
    rng: np.random.Generator
    reference: bool

    def joint(self) -> int:
        """Return a joint 1..N."""
        return int(self.rng.integers(1, len(self.robot.joint) + 1))

    def sign(self) -> float:
        """Return -1 or 1."""
        return float(self.rng.choice([-1.0, 1.0]))

    def level(self, joint: int) -> float:
        """Return the usual Coulomb level (Nm) of joint 1..N."""
        return float(self.usual.level[joint - 1])

    def passed(self, joint: int) -> float:
        """Return an angle (rad) that joint 1..N passes while it moves."""
        q = np.concatenate([m.q[:, joint - 1] for m in self.motions])
        qd = np.concatenate([m.qd[:, joint - 1] for m in self.motions])
        moving = q[np.abs(qd) > 0.05]
        return float(self.rng.choice(moving if len(moving) else q))


@dataclass(frozen=True)
class Drawn:
    """An effect whose size is one number between low and high.

    joints: 1..N that it sits on, empty for one that moves all. build: (size, recording 0..) -> fields of a
    Plant to add. truth: size -> the parameters by name. episodic: it acts in some intervals only. notes: what
    the truth holds besides; also: effects that come along with it.
    """

    name: str
    joints: tuple[int, ...]
    start: float
    low: float
    high: float
    build: Callable[[float, int], Fields]
    truth: Callable[[float], dict[str, Any]]
    episodic: bool = False
    notes: dict[str, Any] = field(default_factory=dict)

    def bound(self, size: float) -> float:
        """Return the nearest plausible size."""
        return min(max(size, self.low), self.high)


def add(plant: Plant, fields: Fields) -> Plant:
    """Return the plant with effects added: lists grow, single entries are set."""
    update: Fields = {}
    for name, value in fields.items():
        if name == "outside":
            update[name] = plant.outside.model_copy(update=value)
        else:
            old = getattr(plant, name)
            update[name] = (*old, *value) if isinstance(old, tuple) else value
    data = {key: getattr(plant, key) for key in type(plant).model_fields} | update
    return Plant(**data)
