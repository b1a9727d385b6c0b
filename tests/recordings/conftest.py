from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from residuum.recordings import Recording

SHARED = Path(__file__).resolve().parents[2].parent / "shared" / "recordings"


@pytest.fixture
def shared() -> Path:
    if not SHARED.is_dir():
        pytest.skip("the shared real recordings are not beside this checkout")
    return SHARED


def motion(seconds: float = 20.0, rate: float = 100.0, joints: int = 6, seed: int = 0, delay: float = 0.0):
    """A sound recording: sums of sines, noisy currents of inertia, gravity and friction, `delay` late."""
    rng = np.random.default_rng(seed)
    time = np.arange(round(seconds * rate)) / rate

    def at(t):
        size, pace = rng_sizes, rng_paces
        phase = t[:, None] * pace + np.arange(joints)
        return size * np.sin(phase), size * pace * np.cos(phase), -size * pace**2 * np.sin(phase)

    rng_sizes, rng_paces = rng.uniform(0.4, 1.0, joints), rng.uniform(0.7, 1.6, joints)
    q, qd, _ = at(time)
    late_q, late_qd, late_qdd = at(time - delay)
    target = 3 * np.sin(late_q) + 0.8 * late_qdd
    current = target + 0.6 * np.tanh(late_qd / 0.02) + 0.3 * late_qd + 0.05 * rng.normal(size=q.shape)
    target_now = 3 * np.sin(q) + 0.8 * at(time)[2]
    return Recording(
        name="sound.csv", timestamp=time + 100.0, q=q + 2e-5 * rng.normal(size=q.shape), qd=qd,
        current=current, target_current=target_now, rows=np.arange(2, len(time) + 2),
    )  # fmt: skip


@pytest.fixture
def make() -> Callable[..., Recording]:
    return motion


@pytest.fixture
def changed() -> Callable[..., Recording]:
    """Change cells: changed(recording, q=((rows, joint), value)) sets q[rows, joint] = value."""

    def change(recording: Recording, **cells) -> Recording:
        arrays = {}
        for name, (where, value) in cells.items():
            arrays[name] = np.array(getattr(recording, name))
            arrays[name][where] = value
        return replace(recording, **arrays)

    return change


@pytest.fixture
def write(tmp_path: Path) -> Callable[..., Path]:
    def to_file(recording: Recording, name: str = "r.csv", delimiter: str = ",", end: str = "\n") -> Path:
        path = tmp_path / name
        path.write_text(as_text(recording, delimiter, end), newline="")
        return path

    return to_file


def as_text(recording: Recording, delimiter: str = ",", end: str = "\n") -> str:
    n = recording.joints
    names = ["timestamp", *(f"actual_{c}_{j}" for c in ("q", "qd", "current") for j in range(n))]
    table = np.column_stack([recording.timestamp, recording.q, recording.qd, recording.current])
    lines = [delimiter.join(names), *(delimiter.join(repr(float(v)) for v in row) for row in table)]
    return end.join(lines) + end
