"""Read recordings from CSV (comma, semicolon, blanks; gzip) and Parquet, whole or in pieces."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np

from ..errors import InputError
from .layout import Layout, layout
from .parquet import MAGIC, open_parquet, parquet_tables
from .recording import Dropped, FloatArray, IntArray, Recording, Source, concatenate
from .sniff import header
from .source import Block, blocks, magic, sha256
from .table import BLANK, Format, Parsed, parse

Progress = Callable[[float], None]

CUT = "last line has no line end and may be cut"
ROWS = 100_000


def read(
    path: str | Path, extra: Sequence[str] = (), progress: Progress | None = None, current: bool = True
) -> Recording:
    """Read a recording whole.

    Needed columns: `timestamp`, `actual_q_0..`, `actual_current_0..`; every other RTDE channel is taken when
    all its columns are there, and further columns are ignored unless `extra` names them (they then stand in
    `Recording.others`). Rows with the wrong number of cells or with text for a number are left out and
    listed in `Recording.dropped`; an empty cell is NaN. With `current` False the measured currents are
    neither needed nor read, and `Recording.current` is zero. `progress` is called with the share read, 0..1.

    Raises InputError, one line with file, row or column and remedy, when nothing can be made of the file.
    """
    return concatenate(list(read_chunks(path, extra=extra, progress=progress, current=current)))


def read_chunks(
    path: str | Path,
    rows: int = ROWS,
    extra: Sequence[str] = (),
    progress: Progress | None = None,
    current: bool = True,
) -> Iterator[Recording]:
    """Read a recording in pieces of `rows` samples (the last may be shorter), in order and with flat memory.

    Arguments, columns and errors as for `read`; errors further down in the file come when they are reached.
    A row left out is listed in the piece during which it was met. At least one piece is given.
    """
    path = Path(path)
    if path.is_dir():
        raise InputError(f"{path}: is a folder; give the recordings in it")
    digest = sha256(path)
    if magic(path) == MAGIC:
        file, found = open_parquet(path, extra, current)
        tables = parquet_tables(path, file, found, rows)
        source = Source(path.name, digest, "parquet")
    else:
        start, rest = header(blocks(path), str(path))
        found = layout(start.names, str(path), extra, current)
        form = Format(start.delimiter, start.decimal, found.width, found.columns)
        tables = _text_tables(rest, form, progress, path.stat().st_size)
        source = Source(path.name, digest, "blank" if start.delimiter == BLANK else start.delimiter)
    return _pieces(path, tables, found, source, rows)


def _text_tables(
    rest: Iterator[Block], form: Format, progress: Progress | None, size: int
) -> Iterator[Parsed]:
    for block in rest:
        parsed = parse(block.data, block.first, form)
        if progress:
            progress(block.read / size)
        yield _without_cut(parsed) if block.cut else parsed


def _without_cut(parsed: Parsed) -> Parsed:
    """Leave the very last line out: a number cut in two still looks like one."""
    if not len(parsed.rows) or (parsed.bad and parsed.bad[-1][0] > parsed.rows[-1]):
        return parsed
    bad = [*parsed.bad, (int(parsed.rows[-1]), CUT)]
    return Parsed(parsed.table[:-1], parsed.rows[:-1], bad)


def _pieces(
    path: Path, tables: Iterator[Parsed], found: Layout, source: Source, rows: int
) -> Iterator[Recording]:
    held: list[Parsed] = []
    bad: list[tuple[int, str]] = []
    example: tuple[int, str] | None = None
    given = 0
    for parsed in tables:
        held.append(parsed)
        bad += parsed.bad
        example = example or next(iter(parsed.bad), None)
        table, lines = _stack(held, len(found.columns))
        whole = len(lines) - len(lines) % rows
        for at in range(0, whole, rows):
            piece = slice(at, at + rows)
            yield found.recording(path.name, source, table[piece], lines[piece], _grouped(bad))
            bad, given = [], given + 1
        held = [Parsed(table[whole:], lines[whole:], [])]
    table, lines = _stack(held, len(found.columns))
    if len(lines) or (given and bad):
        yield found.recording(path.name, source, table, lines, _grouped(bad))
    elif not given:
        why = f"no row can be read (line {example[0]}: {example[1]})" if example else "there are no rows"
        raise InputError(f"{path}: {why}; record again")


def _stack(held: list[Parsed], width: int) -> tuple[FloatArray, IntArray]:
    if len(held) == 1:
        return held[0].table, held[0].rows
    tables = [np.empty((0, width)), *(p.table for p in held)]
    return np.concatenate(tables), np.concatenate([np.empty(0, np.int64), *(p.rows for p in held)])


def _grouped(bad: list[tuple[int, str]]) -> tuple[Dropped, ...]:
    reasons = dict.fromkeys(reason for _, reason in bad)
    return tuple(Dropped(r, np.array([n for n, reason in bad if reason == r], np.int64)) for r in reasons)
