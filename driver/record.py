"""Recording: a stretch of the RTDE stream as a table, and whether any of it is missing."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..errors import InputError
from .rtde import PORT, Rtde

Array = npt.NDArray[np.float64]

FIELDS = (
    "timestamp",
    "actual_q",
    "actual_qd",
    "actual_current",
    "target_q",
    "target_qd",
    "target_qdd",
    "target_current",
    "target_moment",
    "joint_temperatures",
    "actual_TCP_force",
)
"""What a recording of residuum holds."""


@dataclass(frozen=True)
class Recorded:
    """A recording of T rows: columns and table (T, columns), SI units as RTDE has them.

    lost: packages that the timestamps say are missing. repeated: packages with a timestamp that was there.
    """

    columns: tuple[str, ...]
    table: Array
    rate: float
    lost: int
    repeated: int

    def csv(self) -> str:
        """Return the table as text with comma and header."""
        rows = [",".join(self.columns)]
        rows += [f"{row[0]:.6f}," + ",".join(map(_short, row[1:])) for row in self.table.tolist()]
        return "\n".join(rows) + "\n"


def record(
    host: str,
    seconds: float,
    rate: float = 500.0,
    fields: Sequence[str] = FIELDS,
    port: int = PORT,
    progress: Callable[[int, int], None] = lambda _done, _all: None,
) -> Recorded:
    """Read `seconds` of the robot's time at `rate` Hz; the first field has to be the timestamp.

    progress: takes rows so far and rows wanted, every now and then.
    Raises InputError as `Rtde` does; then nothing was recorded.
    """
    wanted = max(round(seconds * rate), 1)
    with Rtde(host, fields, rate, port) as robot:
        table = np.empty((wanted, len(robot.columns)))
        done = 0
        for block in robot.rows():
            some = block[: wanted - done]
            table[done : done + len(some)] = some
            done += len(some)
            progress(done, wanted)
            if done == wanted:
                break
        lost, repeated = gaps(table[:, 0], rate)
        return Recorded(robot.columns, table, rate, lost, repeated)


def gaps(timestamp: Array, rate: float) -> tuple[int, int]:
    """Return how many packages are missing between timestamps (T,) s, and how many are there twice.

    Raises InputError when time goes backwards: the robot was started again.
    """
    steps = np.round(np.diff(timestamp) * rate)
    if (steps < 0.0).any():
        raise InputError("the robot's clock went backwards; it was restarted while recording")
    return int(np.maximum(steps - 1.0, 0.0).sum()), int((steps == 0.0).sum())


def _short(value: float) -> str:
    return f"{value:.9g}"
