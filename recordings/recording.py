"""One recording as a frozen value: arrays in SI units and where every row came from."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from .channels import FIELDS

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]
BoolArray = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class Source:
    """Where a recording was read from.

    `file` is the name without its folder, `sha256` that of the bytes as they lie on disk (compressed
    ones included), `delimiter` is `,`, `;`, `blank` or `parquet`.
    """

    file: str
    sha256: str
    delimiter: str


@dataclass(frozen=True, eq=False)
class Dropped:
    """Rows that reading left out: `rows` are line numbers, `reason` says why, for all of them."""

    reason: str
    rows: IntArray


@dataclass(frozen=True, eq=False)
class Recording:
    """T samples of N joints (N = 6, or fewer when the file has fewer); read-only arrays.

    `name`: for messages; the file name if it was read.
    `timestamp` (T,) s, as recorded; `q` (T, N) rad; `current` (T, N) A.
    `qd` (T, N) rad/s, `target_q` (T, N) rad, `target_qd` (T, N) rad/s, `target_qdd` (T, N) rad/s^2,
    `target_current` (T, N) A, `target_moment` (T, N) Nm, `joint_temperatures` (T, N) deg C,
    `actual_TCP_force` (T, 6) N and Nm: None when not recorded.
    `others`: every further RTDE channel by its RTDE name, (T,) or (T, width), units as in RTDE.
    `rows` (T,): line number in the source file, as an editor counts (row number for Parquet).
    `dropped`: rows that reading left out. `ignored`: columns of channels that were not complete.

    Raises ValueError when the shapes do not agree.
    """

    name: str
    timestamp: FloatArray
    q: FloatArray
    current: FloatArray
    qd: FloatArray | None = None
    target_q: FloatArray | None = None
    target_qd: FloatArray | None = None
    target_qdd: FloatArray | None = None
    target_current: FloatArray | None = None
    target_moment: FloatArray | None = None
    joint_temperatures: FloatArray | None = None
    actual_TCP_force: FloatArray | None = None  # noqa: N815 - RTDE's name
    others: Mapping[str, FloatArray] = field(default_factory=dict)
    rows: IntArray = field(default_factory=lambda: np.empty(0, np.int64))
    source: Source | None = None
    dropped: tuple[Dropped, ...] = ()
    ignored: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not self.rows.size:
            object.__setattr__(self, "rows", np.arange(1, len(self.timestamp) + 1, dtype=np.int64))
        for name in (*FIELDS, "rows"):
            if (value := getattr(self, name)) is not None:
                object.__setattr__(self, name, self._checked(name, value))
        object.__setattr__(
            self, "others", {name: self._checked(name, value) for name, value in self.others.items()}
        )

    def _checked(self, name: str, value: npt.NDArray[np.generic]) -> npt.NDArray[np.generic]:
        per_joint = name in FIELDS and FIELDS[name].width == 0
        wrong_width = per_joint and value.shape[1:] != self.q.shape[1:]
        if value.shape[0] != len(self.timestamp) or wrong_width:
            raise ValueError(f"{self.name}: {name} has shape {value.shape}, q has {self.q.shape}")
        frozen = value.view()
        frozen.flags.writeable = False
        return frozen

    def __len__(self) -> int:
        return len(self.timestamp)

    @property
    def joints(self) -> int:
        """N."""
        return int(self.q.shape[1])

    @property
    def duration(self) -> float:
        """Last timestamp less the first, s; 0 when there is no row."""
        return float(self.timestamp[-1] - self.timestamp[0]) if len(self) else 0.0

    @property
    def rate(self) -> float:
        """Samples per second, by the median step; 0 when there are fewer than two rows."""
        return 1 / float(np.median(np.diff(self.timestamp))) if len(self) > 1 else 0.0

    def arrays(self) -> dict[str, FloatArray]:
        """Give the named channels that are there by field name: `timestamp`, `q`, `current`, `qd`, ..."""
        return {name: getattr(self, name) for name in FIELDS if getattr(self, name) is not None}

    def take(self, index: BoolArray | IntArray | slice) -> "Recording":
        """Keep the samples that `index` selects, as NumPy indexing does along the first axis."""
        changes: dict[str, Any] = {name: value[index] for name, value in self.arrays().items()}
        others = {name: value[index] for name, value in self.others.items()}
        return replace(self, rows=self.rows[index], others=others, **changes)

    def without(self, names: Sequence[str]) -> "Recording":
        """Leave out the optional fields `names`."""
        changes: dict[str, Any] = dict.fromkeys(names)
        return replace(self, **changes)

    def lean(self) -> "Recording":
        """Leave out what no fit uses: most targets, tool forces, other channels, and what reading dropped."""
        return replace(self.without(_UNUSED), others={}, dropped=())


#: Optional fields that no fit uses.
_UNUSED = ("target_q", "target_qdd", "target_current", "target_moment", "actual_TCP_force")


def concatenate(parts: Sequence[Recording]) -> Recording:
    """Join pieces of one file in order; name, source and the channels are those of the first."""
    first = parts[0]
    if len(parts) == 1:
        return first
    names = (*first.arrays(), "rows")
    merged: dict[str, Any] = {name: np.concatenate([getattr(p, name) for p in parts]) for name in names}
    others = {name: np.concatenate([p.others[name] for p in parts]) for name in first.others}
    return replace(first, others=others, dropped=_merge_dropped(parts), **merged)


def _merge_dropped(parts: Sequence[Recording]) -> tuple[Dropped, ...]:
    by_reason: dict[str, list[IntArray]] = {}
    for part in parts:
        for dropped in part.dropped:
            by_reason.setdefault(dropped.reason, []).append(dropped.rows)
    return tuple(Dropped(reason, np.concatenate(rows)) for reason, rows in by_reason.items())


assert {f.name for f in fields(Recording)} >= set(FIELDS), "every named channel is a field"
