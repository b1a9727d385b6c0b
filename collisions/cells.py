"""Where the experiments take place: pose, direction, speed and obstacle of every cell."""

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from ..robots import Robot
from ..virtual import Obstacle, Plant, clamped_hand, effects, foam
from ..virtual.plant import Thermal
from ..virtual.server.kinematics import Kinematics
from .published import PACES, SPEEDS

Array = npt.NDArray[np.float64]

#: rad; an arm reaching forward, bent, above its table, tool down: the flange is 0.6 m from joint 1's axis.
POSE = (0.0, -1.2, 1.2, -1.4, -1.5708, 0.0)
#: rad/s^2 of the approach: the default of movej.
ACCELERATION = 1.4
#: s at rest before the approach, and rad of the joint's way before it touches.
REST, WAY = 0.6, 0.30
#: m, in the flange frame: the point that touches. Off the axis, or joint 6 would move nothing.
TOUCH = (0.1, 0.0, 0.0)
OBSTACLES = ("foam", "soft", "clamped")
#: rad/s of joints 4-6, where the thesis has none: what gives a tool speed like joint 3's.
WRIST_SPEEDS = {"slow": 0.5, "fast": 1.0}
#: kg and m of the payload, deg C of cold and hot joints, and what friction loses per K (mismatch facts).
PAYLOAD, PAYLOAD_CENTRE = 2.0, (0.0, 0.0, 0.05)
COLD, HOT = 25.0, 60.0
COULOMB_PER_K, VISCOUS_PER_K = -0.005, -0.015


@dataclass(frozen=True)
class Cell:
    """One experiment: joint 1..6, pace, obstacle, condition of the robot, and the seed of the repeat.

    obstacle: "foam", "clamped" or "soft" (a tenth of the foam's stiffness and damping).
    """

    joint: int
    pace: str
    obstacle: str = "foam"
    condition: str = "warm"
    seed: int = 0

    @property
    def speed(self) -> float:
        """Joint speed of the approach, rad/s."""
        return SPEEDS.get((self.joint, self.pace), WRIST_SPEEDS[self.pace])


@dataclass(frozen=True)
class Scene:
    """What a cell looks like: start pose (6,) rad, speeds (6,) rad/s, obstacle; m/s of the touching point."""

    start: Array
    speeds: tuple[float, ...]
    obstacle: Obstacle
    tool_speed: float = field(default=0.0)


def scene(robot: Robot, cell: Cell) -> Scene:
    """Return the scene of a cell: the obstacle's face meets the point squarely after WAY rad.

    Repeats begin up to 0.02 rad apart in all joints, drawn by the cell's seed.
    """
    start = np.array(POSE) + np.random.default_rng([cell.seed, 5]).uniform(-0.02, 0.02, 6)
    kinematics, tool = Kinematics(robot), np.eye(4)
    tool[:3, 3] = TOUCH
    there, step = start.copy(), 1e-5
    there[cell.joint - 1] += WAY
    onward = there.copy()
    onward[cell.joint - 1] += step
    place = kinematics.forward(there, tool)[:3, 3]
    lever = (kinematics.forward(onward, tool)[:3, 3] - place) / step
    arm = float(np.linalg.norm(lever))
    normal = -lever / arm
    speeds = [0.0] * 6
    speeds[cell.joint - 1] = cell.speed
    face = _obstacle(cell.obstacle, tuple(place.tolist()), tuple(normal.tolist()))
    return Scene(start, tuple(speeds), face, arm * cell.speed)


def _obstacle(kind: str, place: tuple[float, float, float], normal: tuple[float, float, float]) -> Obstacle:
    if kind == "clamped":
        return clamped_hand(place, normal, point=TOUCH)
    face = foam(place, normal, point=TOUCH)
    if kind == "soft":
        return face.model_copy(
            update={"stiffness": 0.1 * face.stiffness, "damping": 0.1 * face.damping, "thickness": None}
        )
    return face


def plant(condition: str) -> Plant:
    """Return the robot in a condition: warm, payload (unknown to its controller), cold or hot.

    Cold and hot joints have friction that depends on temperature; a warm one is at its reference.
    """
    if condition == "payload":
        return Plant(payload=effects.Payload(mass=PAYLOAD, centre_of_mass=PAYLOAD_CENTRE))
    if condition in ("cold", "hot"):
        start = (COLD if condition == "cold" else HOT,) * 6
        heat = tuple(
            effects.TemperatureDependentFriction(joint=j, coulomb=COULOMB_PER_K, viscous=VISCOUS_PER_K)
            for j in range(1, 7)
        )
        return Plant(thermal=Thermal(start=start), temperature_dependent_friction=heat)
    return Plant()


def thesis_cells(repeats: int, obstacle: str = "foam") -> list[Cell]:
    """Return the thesis' cells: joints 1-3, two speeds, each `repeats` times."""
    return [Cell(j, pace, obstacle, seed=k) for pace in PACES for j in (1, 2, 3) for k in range(repeats)]


def further_cells(joints: tuple[int, ...], conditions: tuple[str, ...]) -> list[Cell]:
    """Return the cells beyond: every joint and pace once; foam in each condition."""
    scenes = [("foam", c) for c in conditions] + [("clamped", "warm"), ("soft", "warm")]
    return [Cell(j, pace, *where) for where in scenes for pace in PACES for j in joints]
