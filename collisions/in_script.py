"""The generated URScript guard in closed loop with the virtual arm: interpreter and physics in lock step."""

from dataclasses import dataclass

import numpy as np

from ..codegen.generate import generate
from ..codegen.guard import INTEGERS
from ..codegen.motion import read_motion
from ..codegen.options import Options
from ..errors import InputError
from ..robots import Robot
from ..robots.model import Model
from ..virtual.server import Controller
from .cells import Cell, plant, scene
from .reaction import Alarm
from .run import AFTER, Figures, Trace, contact_force, measure

GUARDING, REACTING = 2, 3
#: The guard's own names of the strategies.
REACTIONS = {1: "hold", 2: "freedrive", 3: "retract"}
#: s until the guard has to be watching, and until the arm has to touch.
START, APPROACH = 5.0, 6.0


@dataclass(frozen=True)
class Guarded:
    """A run with the guard: what was measured, and the states (see docs/guard.md) that it told, in order."""

    figures: Figures
    states: tuple[int, ...]
    text: str


def motion_text(cell: Cell, speeds: tuple[float, ...]) -> str:
    """Return the motion that runs into the obstacle."""
    numbers = ", ".join(f"{x:.3f}" for x in speeds)
    return f"while True:\n  speedj([{numbers}], 1.4, 0.5)\nend\n"


def guard_run(robot: Robot, cell: Cell, strategy: int, model: Model, detector: str = "speed") -> Guarded:
    """Generate the guard of a model, run it on the virtual controller, and let the arm collide.

    Raises InputError when the guard refuses to start.
    """
    here = scene(robot, cell)
    motion = read_motion(motion_text(cell, here.speeds), "motion.script", "5.11")
    options = Options(reaction=REACTIONS[strategy], detector=detector, motion=motion)
    text = generate(model, options).files["collision_guard.script"]
    controller = Controller(
        robot, plant(cell.condition), start=tuple(here.start.tolist()), seed=1000 + cell.seed
    )
    controller.arm.simulator.add_obstacle(here.obstacle)
    controller.programs.start(text)
    figures, states = _follow(robot, cell, controller)
    return Guarded(figures, states, text)


def _follow(robot: Robot, cell: Cell, controller: Controller) -> tuple[Figures, tuple[int, ...]]:
    told: list[int] = []
    states, onset, end, alarm = [], np.nan, START + APPROACH, None
    while controller.arm.time < end:
        controller.tick()
        state, outputs = controller.arm.state, controller.world.outputs
        states.append(state)
        now = _integer(outputs.get(("integer", INTEGERS["state"]), 0))
        if now and (not told or told[-1] != now):
            told.append(now)
        if state.truth["external"].any() and np.isnan(onset):
            onset, end = state.time, state.time + AFTER
        if now >= REACTING and alarm is None:
            alarm = Alarm(state.time, _integer(outputs["integer", INTEGERS["joint"]]), 0.0)
    if GUARDING not in told:
        raise InputError(f"the guard refused: states {told}, reason {outputs}")
    trace = Trace(
        cell,
        np.array([s.time for s in states]),
        contact_force(
            robot,
            scene(robot, cell),
            np.array([s.truth["external"] for s in states]),
            np.array([s.truth["link_q"] for s in states]),
        ),
        onset,
        alarm,
        {name: np.array([s.rtde[name] for s in states]) for name in states[0].rtde},
    )
    return measure(trace), tuple(told)


def _integer(value: object) -> int:
    return value if isinstance(value, int) else 0
