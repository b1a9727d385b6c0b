"""Write the two recordings of the README: a simulated UR5e that moves freely, and one that is pushed.

The virtual robot has the friction of a UR5e's factory sheet, current noise and quantisation as real
logs have them, and shares no formula with the derivation. Run it again and the files are the same.

    python examples/make_recordings.py
"""

import gzip
import io
from pathlib import Path

import numpy as np

from residuum.robots import load_robot
from residuum.virtual import Contact, Plant, Recording, simulate
from residuum.virtual.motions import fourier

FOLDER = Path(__file__).parent
CHANNELS = ("actual_q", "actual_qd", "actual_current", "joint_temperatures")


def write(path: Path, recording: Recording) -> None:
    """Write the channels that the examples need, compressed, without a date."""
    names = ["timestamp", *(f"{channel}_{i}" for channel in CHANNELS for i in range(6))]
    table = np.column_stack([recording["timestamp"], *(recording[channel] for channel in CHANNELS)])
    text = io.StringIO()
    np.savetxt(text, table, fmt="%.5f", delimiter=",", header=",".join(names), comments="")
    path.write_bytes(gzip.compress(text.getvalue().encode(), mtime=0))
    print(f"{path.name}: {len(table)} rows")


def main() -> None:
    """Simulate and write both."""
    robot, _ = load_robot("ur5e")
    free = simulate(robot, Plant(), fourier(robot, 40.0, seed=7), rate=125.0, seed=7)
    write(FOLDER / "ur5e_free.csv.gz", free.recording)
    push = Plant(external_contact=(Contact(start=9.0, end=10.0, force=(0.0, 40.0, 0.0)),))
    pushed = simulate(robot, push, fourier(robot, 15.0, seed=3), rate=125.0, seed=3)
    write(FOLDER / "ur5e_pushed.csv.gz", pushed.recording)


if __name__ == "__main__":
    main()
