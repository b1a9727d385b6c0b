"""Write examples/ur5e_simulated.csv.gz: 15 s of a simulated UR5e, and a push at 9 s.

The virtual robot has the friction of a UR5e's factory sheet, current noise and quantisation as real
logs have them, and shares no formula with the derivation. Run it again and the file is the same.

    python examples/make_recording.py
"""

import gzip
import tempfile
from pathlib import Path

from residuum.robots import load_robot
from residuum.virtual import Contact, Plant, simulate
from residuum.virtual.motions import fourier

FILE = Path(__file__).with_name("ur5e_simulated.csv.gz")


def main() -> None:
    """Simulate and write."""
    robot, _ = load_robot("ur5e")
    push = Contact(start=9.0, end=10.0, force=(0.0, 40.0, 0.0))
    run = simulate(robot, Plant(external_contact=(push,)), fourier(robot, 15.0, seed=3), rate=125.0, seed=3)
    with tempfile.TemporaryDirectory() as folder:
        plain = Path(folder) / "run.csv"
        run.recording.write_csv(plain)
        FILE.write_bytes(gzip.compress(plain.read_bytes(), mtime=0))
    print(f"{FILE.name}: {len(run.recording['timestamp'])} rows, pushed from {push.start} to {push.end} s")


if __name__ == "__main__":
    main()
