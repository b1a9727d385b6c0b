"""A whole run: motion in, recording and truth out."""

import csv
import io
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from ..errors import InputError
from ..robots import Robot
from .command import Position
from .controller import TICK
from .effects import DataFault
from .motions import Motion
from .plant import Plant
from .sensing import Rows
from .simulator import Simulator

Array = npt.NDArray[np.float64]
FIELDS = (
    "actual_q", "actual_qd", "actual_current", "target_q", "target_qd", "target_qdd", "target_current",
    "target_moment", "joint_temperatures", "actual_TCP_force",
)  # fmt: skip


@dataclass(frozen=True)
class Recording:
    """What the controller reported: RTDE field -> (T, N), (T,) for timestamp; T rows.

    cut: rows that are written only in part.
    """

    fields: dict[str, Array]
    cut: tuple[int, ...] = ()

    def __getitem__(self, name: str) -> Array:
        """Return a field by its RTDE name."""
        return self.fields[name]

    def header(self) -> list[str]:
        """Return the column names of the CSV."""
        wide = [f"{name}_{k}" for name in FIELDS for k in range(self.fields[name].shape[1])]
        return ["timestamp", *wide]

    def write_csv(self, path: Path | str) -> None:
        """Write comma-separated values under RTDE's names, six decimals.

        Raises InputError when the file cannot be written.
        """
        table = np.column_stack([self.fields["timestamp"], *[self.fields[name] for name in FIELDS]])
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(self.header())
        writer.writerows([_number(x) for x in row] for row in table.tolist())
        lines = text.getvalue().splitlines(keepends=True)
        for row in self.cut:
            if 0 <= row < len(table):
                lines[row + 1] = lines[row + 1][: len(lines[row + 1]) // 2] + "\n"
        try:
            Path(path).write_text("".join(lines), encoding="utf-8")
        except OSError as error:
            raise InputError(f"{path}: cannot be written: {error.strerror}") from None


@dataclass(frozen=True)
class Truth:
    """What nobody could record. rows: at the recording's instants; effects: name -> parameters."""

    rows: Rows
    effects: dict[str, object]


@dataclass(frozen=True)
class Run:
    """A recording and, apart from it, the truth."""

    recording: Recording
    truth: Truth


def simulate(robot: Robot, plant: Plant, motion: Motion, rate: float = 500.0, seed: int = 0) -> Run:
    """Send a motion through a robot and record it.

    rate: rows per second, a divisor of 500 (125 is what older recorders give). seed: of everything random;
    the same arguments give the same numbers. Raises InputError: a rate that does not divide 500, a motion
    with another number of joints than the robot, a plant that names a joint that the robot lacks.
    """
    every = round(1.0 / (TICK * rate)) if rate > 0 else 0
    if every < 1 or abs(every * TICK * rate - 1.0) > 1e-9:
        raise InputError(f"rate {rate:g} Hz: give 500 Hz divided by a whole number, such as 500 or 125")
    if motion.q.shape[1] != len(robot.joint):
        raise InputError(f"motion has {motion.q.shape[1]} joints, {robot.name} has {len(robot.joint)}")
    simulator = Simulator(robot, plant, motion.q[0], seed)
    path = zip(motion.q.tolist(), motion.qd.tolist(), motion.qdd.tolist(), strict=True)
    rows, fields = simulator.measure([simulator.advance(Position(q, qd, qdd)) for q, qd, qdd in path])
    fault = plant.data_fault or DataFault()
    rng = np.random.default_rng([seed, 100])
    keep = _instants(rows.time, every, fault, rng)
    picked = Rows(**{name: values[keep] for name, values in vars(rows).items()})
    recorded = {name: values[keep].copy() for name, values in fields.items()}
    _spoil(recorded, fault, rng)
    return Run(Recording(recorded, fault.cut), Truth(picked, plant.effects()))


def _instants(time: Array, every: int, fault: DataFault, rng: np.random.Generator) -> npt.NDArray[np.intp]:
    """Return which cycles are recorded."""
    keep = np.arange(0, len(time), every)
    if fault.late:
        steps = every + rng.poisson(fault.late / TICK, len(keep))
        keep = np.cumsum(steps) - steps[0]
        keep = keep[keep < len(time)]
    for start, end in fault.gaps:
        keep = keep[(time[keep] < start) | (time[keep] >= end)]
    return keep


def _spoil(fields: dict[str, Array], fault: DataFault, rng: np.random.Generator) -> None:
    """Put faults of the data into the fields, in place."""
    time = fields["timestamp"].copy()
    if fault.stamp_noise:
        fields["timestamp"] += fault.stamp_noise * rng.standard_normal(len(time))
    for stuck in fault.stuck:
        name, _, index = stuck.column.rpartition("_")
        if name not in FIELDS or not index.isdigit() or int(index) >= fields[name].shape[1]:
            raise InputError(
                f"plant: data_fault: no column {stuck.column}; give one such as actual_current_2"
            )
        rows = np.flatnonzero((time >= stuck.start) & (time < stuck.end))
        if len(rows):
            fields[name][rows, int(index)] = fields[name][rows[0], int(index)]
    for row in fault.absurd:
        if row < len(time):
            name = FIELDS[int(rng.integers(3))]
            fields[name][row] = 10.0 ** rng.uniform(150, 305, fields[name].shape[1])


def _number(value: float) -> str:
    return f"{value:.6f}" if abs(value) < 1e15 else f"{value:.6e}"
