"""Recordings as clean pieces of bounded length, placed where the work is done."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..recordings import Recording, read_chunks
from ..recordings.audit import clean
from ..recordings.recording import concatenate
from ..robots.model import Input
from .schedule import Scheduler

#: Rows a piece: 200 s at 500 Hz. A file's last piece may be half as long again.
ROWS = 100_000


@dataclass(frozen=True)
class Piece:
    """A clean part of one recording. run: which file; dropped: what the audit left out, in words."""

    run: int
    recording: Recording
    dropped: tuple[str, ...]


@dataclass(frozen=True)
class Placed:
    """A recording whose pieces stand with the scheduler; first, last: timestamps in s; rows: kept ones."""

    source: Input
    handles: tuple[Any, ...]
    first: float
    last: float
    rows: int
    dropped: tuple[str, ...]

    @property
    def duration(self) -> float:
        """Seconds from the first to the last row."""
        return self.last - self.first


def place(paths: Sequence[Path], scheduler: Scheduler) -> list[Placed]:
    """Read, audit and place recordings, ordered by name and content so that the order given does not matter.

    Raises InputError for a file that cannot be read or whose audit refuses it, or that is given twice.
    """
    inputs: list[Input] = []

    def items() -> Iterator[tuple[int, bool, Recording]]:
        for run, path in enumerate(paths):
            for part in _long_parts(path):
                first = len(inputs) == run
                if first:
                    inputs.append(Input(name=path.name, sha256=part.source.sha256 if part.source else ""))
                yield run, first, part

    handles = scheduler.place(prepare, items())
    found = scheduler.map(describe, handles)
    placed = []
    for run, source in enumerate(inputs):
        own = [(h, d) for h, d in zip(handles, found, strict=True) if d[0] == run]
        for (_, before), (_, after) in pairwise(own):
            if after[1] <= before[2]:
                raise InputError(f"{source.name}: time starts again at {after[1]:g} s: split the file there")
        placed.append(
            Placed(
                source, tuple(h for h, _ in own), own[0][1][1], own[-1][1][2],
                sum(d[3] for _, d in own), tuple(x for _, d in own for x in d[4]),
            )
        )  # fmt: skip
    placed.sort(key=lambda p: (p.source.name, p.source.sha256))
    for one, two in pairwise(placed):
        if one.source.sha256 == two.source.sha256:
            raise InputError(f"{two.source.name}: is given twice; leave one out")
    return placed


def prepare(item: tuple[int, bool, Recording]) -> Piece:
    """Audit a piece and keep what a fit uses. Raises InputError when the audit refuses it.

    The delay of current behind motion is looked for in a file's first piece, as in the audit of a whole file.
    """
    run, first, recording = item
    good, report = clean(recording, with_clock=first)
    report.require()
    return Piece(run, good.lean(), tuple(f.text for f in report.findings if f.severity == "dropped"))


def describe(piece: Piece) -> tuple[int, float, float, int, tuple[str, ...]]:
    """Return run, first and last timestamp (s), rows and what was dropped."""
    time = piece.recording.timestamp
    return piece.run, float(time[0]), float(time[-1]), len(time), piece.dropped


def _long_parts(path: Path) -> Iterator[Recording]:
    """Pieces of a file, a short last one joined to the one before."""
    held: Recording | None = None
    for part in read_chunks(path, rows=ROWS):
        if held is None:
            held = part
        elif len(part) < ROWS // 2:
            held = concatenate([held, part])
        else:
            yield held
            held = part
    if held is not None:
        yield held
