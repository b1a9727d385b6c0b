"""The experiments, spread over processes: the thesis' campaign, and what lies beyond it."""

from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict, dataclass, replace
from functools import partial
from multiprocessing import get_context
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from ..robots import Robot
from ..virtual import TICK
from .cells import REST, Cell
from .detectors import DETECTORS, Eyes, Samples, Watch, first
from .published import DELAY, ur_delay
from .reaction import Alarm
from .run import SETTLING, AfterContact, AtTime, Closed, Figures, Trace, drive, measure

Array = npt.NDArray[np.float64]
Progress = Callable[[int, int], None]
RunTask = Callable[[], "tuple[Row, Trace]"]
T = TypeVar("T")

#: Protections that are nothing but a published delay.
DELAYS = {"ur-least": 0, "ur-most": 1}
#: s that a robot without reaction pushes on, and in which a detection beyond the campaign has to come.
PUSH = 0.5


@dataclass(frozen=True)
class Row:
    """One run as a row of the table. model: what the detector knew, empty for what needs none."""

    cell: Cell
    strategy: int
    detector: str
    model: str
    figures: Figures
    tool_force: float

    def flat(self) -> dict[str, object]:
        """Return the row with plain columns, SI units."""
        cell, found = asdict(self.cell), asdict(self.figures)
        return {
            **cell,
            "speed": self.cell.speed,
            "strategy": self.strategy,
            "detector": self.detector,
            "model": self.model,
            **{("detecting_joint" if k == "joint" else k): v for k, v in found.items()},
            "force_at_detection": self.tool_force,
        }


def spread(tasks: Iterable[Callable[[], T]], workers: int, progress: Progress) -> list[T]:
    """Return the results of independent tasks in their order, from some processes; workers 1: here."""
    todo = list(tasks)
    if workers == 1:
        out = []
        for k, task in enumerate(todo, start=1):
            out.append(task())
            progress(k, len(todo))
        return out
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        futures = {pool.submit(task): k for k, task in enumerate(todo)}
        for done, _ in enumerate(as_completed(futures), start=1):
            progress(done, len(todo))
        return [f.result() for f in futures]


def closed(robot: Robot, cell: Cell, strategy: int, seen: Eyes, detector: str) -> tuple[Row, Trace]:
    """Run a cell with a detector in closed loop."""
    trace = drive(robot, cell, strategy, Closed(Watch(seen, (detector,))))
    return _row(trace, strategy, detector, seen.name), trace


def delayed(robot: Robot, cell: Cell, strategy: int, delay: float, name: str) -> tuple[Row, Trace]:
    """Run a cell with a reaction some s after the contact, whatever detected it."""
    trace = drive(robot, cell, strategy, AfterContact(delay, cell.joint))
    return _row(trace, strategy, name, ""), trace


def _row(trace: Trace, strategy: int, detector: str, model: str) -> Row:
    alarm = trace.alarm
    at = 0 if alarm is None else int(np.searchsorted(trace.time, alarm.time - 1e-9))
    return Row(trace.cell, strategy, detector, model, measure(trace), float(trace.force[at]))


def thesis_runs(robot: Robot, cells: list[Cell], seen: Eyes, detector: str) -> list[RunTask]:
    """Return the tasks of the thesis' campaign: every cell with every strategy."""
    return [partial(closed, robot, cell, s, seen, detector) for cell in cells for s in (1, 2, 3)]


def at_thesis_delays(robot: Robot, cells: list[Cell]) -> list[RunTask]:
    """Return the tasks of the same robot and foam with the thesis' detection delays."""
    return [
        partial(delayed, robot, c, s, 1e-3 * DELAY[c.joint, c.pace], "thesis-delay")
        for c in cells
        for s in (1, 2, 3)
    ]


def beyond(robot: Robot, cell: Cell, known: tuple[Eyes, ...]) -> list[Row]:
    """Return a row for every detector and model on one cell, strategy 2; UR's protection with strategy 1.

    The approach is the same in all of them, noise included, so one run that goes on in spite of all says
    when each would detect; the run is then repeated with the reaction at that time.
    """
    free = drive(robot, cell, None, AtTime(None), PUSH)
    rows: list[Row] = []
    done: dict[float, Row] = {}
    for seen in known:
        for name, alarm in alarms(free, seen).items():
            at = np.inf if alarm is None else alarm.time
            row = done[at] if at in done else done.setdefault(at, _repeat(robot, free, alarm))
            joint = 0 if alarm is None else alarm.joint
            figures = replace(row.figures, joint=joint)
            rows.append(replace(row, detector=name, model=seen.name, figures=figures))
    for name, preset in DELAYS.items():
        row, _ = delayed(robot, cell, 1, ur_delay(cell.joint, cell.pace, preset), name)
        rows.append(row)
    return rows


def _repeat(robot: Robot, free: Trace, alarm: Alarm | None) -> Row:
    """React to an alarm; what came before the contact, or never, has no figures of a reaction."""
    if alarm is not None and alarm.time >= free.onset:
        return _row(drive(robot, free.cell, 2, AtTime(alarm)), 2, "", "")
    row = _row(replace(free, alarm=alarm), 2, "", "")
    nothing = replace(row.figures, impulse=np.nan, peak=np.nan, stop_time=np.nan)
    return replace(row, figures=nothing, tool_force=float("nan"))


def alarms(free: Trace, seen: Eyes) -> dict[str, Alarm | None]:
    """Return when each detector first sounds in a run that goes on in spite of all."""
    watch = Watch(seen)
    scores = watch.run(Samples.of(free.fields))
    begin = round(SETTLING / TICK)
    out: dict[str, Alarm | None] = {}
    for name in DETECTORS:
        found = first(scores[name], begin)
        out[name] = Alarm(float(free.time[found[0]]), found[1], -1.0) if found else None
    return out


assert REST >= SETTLING
