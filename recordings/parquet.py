"""Recordings in Parquet."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from ..errors import InputError
from .layout import Layout, layout
from .table import Parsed

MAGIC = b"PAR1"


def open_parquet(path: Path, extra: Sequence[str], current: bool = True) -> tuple[pq.ParquetFile, Layout]:
    """Open and find the channels. Raises InputError for a broken file or missing columns."""
    try:
        file = pq.ParquetFile(path)
    except (pa.ArrowException, OSError) as error:
        raise InputError(f"{path}: broken Parquet ({_line(error)}); write the file again") from error
    return file, layout(file.schema_arrow.names, str(path), extra, current)


def parquet_tables(path: Path, file: pq.ParquetFile, found: Layout, rows: int) -> Iterator[Parsed]:
    """Batches of at most `rows` rows; row numbers count from 1.

    Raises InputError for columns that hold no numbers and for broken data.
    """
    names = [file.schema_arrow.names[k] for k in found.columns]
    first = 1
    try:
        for batch in file.iter_batches(batch_size=rows, columns=names):
            columns = [_numbers(path, name, batch.column(name)) for name in names]
            yield Parsed(np.column_stack(columns), np.arange(first, first + len(batch)), [])
            first += len(batch)
    except (pa.ArrowException, OSError) as error:
        raise InputError(f"{path}: row {first}: broken Parquet ({_line(error)}); write it again") from error


def _numbers(path: Path, name: str, column: pa.Array) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    kind = column.type
    if not (pa.types.is_floating(kind) or pa.types.is_integer(kind) or pa.types.is_boolean(kind)):
        raise InputError(f"{path}: column {name!r} holds {kind}, not numbers; write it as double")
    if pa.types.is_boolean(kind):
        column = column.cast(pa.int8())
    return np.asarray(column.cast(pa.float64(), safe=False).to_numpy(zero_copy_only=False), np.float64)


def _line(error: Exception) -> str:
    return str(error).splitlines()[0] if str(error) else type(error).__name__
