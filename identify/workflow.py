"""The whole of `residuum fit`: gains where they can be seen, baseline, thresholds, model."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

from ..robots import Robot
from ..robots.model import Model
from .baseline import Baseline, Options, fit_placed
from .free_motion import free_motion_thresholds
from .gains import fit_gains, unseen_gains
from .model_file import GainFit, build_model
from .pieces import place
from .schedule import Scheduler, scheduler

#: Bytes of recordings below which processes take longer to start than they save.
_WORTH_PROCESSES = 30e6


@dataclass(frozen=True)
class Task:
    """What to fit. payload: kg in the `loaded` recordings; trusted_masses: %; false_alarms: per hour."""

    recordings: tuple[Path, ...]
    robot: Robot
    robot_hash: str
    dof: int
    options: Options = field(default_factory=Options)
    loaded: tuple[Path, ...] = ()
    payload: float | None = None
    trusted_masses: float | None = None
    false_alarms: float | None = None
    scheduler: str | None = None
    workers: int | None = None


def run(task: Task, progress: Callable[[str], None] = lambda _: None) -> tuple[Baseline, Model]:
    """Fit and return the baseline and its model; `progress` is told what begins.

    Raises InputError for recordings that cannot be used.
    """
    small = sum(p.stat().st_size for p in task.recordings if p.is_file()) < _WORTH_PROCESSES
    workers = task.workers or (1 if small else None)
    with scheduler(task.scheduler, workers) as place_of_work:
        return _run(task, place_of_work, progress)


def _run(task: Task, at: Scheduler, progress: Callable[[str], None]) -> tuple[Baseline, Model]:
    progress("reading and auditing")
    placed = place(task.recordings, at)
    options = task.options
    progress("fitting")
    found = fit_placed(placed, task.robot, task.robot_hash, task.dof, options, at)
    gains: GainFit = unseen_gains(found.nominal)
    if task.loaded or task.trusted_masses:
        progress("fitting drive gains")
        gains = fit_gains(found, place(task.loaded, at), task.payload, task.trusted_masses, at)
        found = fit_placed(
            placed, task.robot, task.robot_hash, task.dof, replace(options, gains=gains.value), at
        )
    model = build_model(found, gains, None)
    if task.false_alarms is None:
        return found, model
    progress("fitting thresholds")
    handles = [h for p in placed for h in p.handles]
    thresholds = free_motion_thresholds(model, handles, task.false_alarms, found.held_out, at)
    return found, build_model(found, gains, thresholds)
