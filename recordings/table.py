"""Lines of text to numbers, in bulk when they are sound and one by one where they are not."""

import csv
import re
from dataclasses import dataclass

import numpy as np
import pyarrow as pa
from pyarrow import csv as pa_csv

from .recording import FloatArray, IntArray

BLANK = " "
NULLS = ("", "nan", "NaN", "NAN", "-nan", "null", "NULL", "None", "none", "NA", "N/A", "n/a")
_SMALL = 4096
_NUMBER = re.compile(r"[+-]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|inf(?:inity)?)", re.ASCII | re.IGNORECASE)
_BLANKS = re.compile(rb"[ \t]+")


@dataclass(frozen=True)
class Format:
    """How a line becomes cells.

    `delimiter`: one character; blank stands for any run of blanks and tabs. `decimal`: the decimal point.
    `width`: number of cells in a row. `columns`: indices of those that are wanted.
    """

    delimiter: str
    decimal: str
    width: int
    columns: tuple[int, ...]


@dataclass(frozen=True)
class Parsed:
    """Rows that could be read: `table` (k, columns) and their line numbers `rows` (k,).

    `bad` lists (line number, reason) of those that could not. A missing value is NaN.
    """

    table: FloatArray
    rows: IntArray
    bad: list[tuple[int, str]]


def parse(data: bytes, first: int, form: Format) -> Parsed:
    """Parse whole lines, the first of which is line `first`; each is then in `rows`, in `bad`, or blank."""
    numbers = np.arange(first, first + data.count(b"\n"))
    if form.delimiter == BLANK and any(mark in data for mark in (b"\t", b"  ", b" \n", b"\n ")):
        data = b"\n".join(line.strip(b" ") for line in _BLANKS.sub(b" ", data).split(b"\n"))
    if b"\n\n" in data or data.startswith(b"\n"):
        lines = data.split(b"\n")[:-1]
        numbers = numbers[[bool(line) for line in lines]]
        data = b"".join(line + b"\n" for line in lines if line)
    return _join(_halves(data, numbers, form), len(form.columns))


def _halves(data: bytes, numbers: IntArray, form: Format) -> list[Parsed]:
    """Try in bulk; where that fails, halve, so that one broken line costs few others the quick way."""
    table = _bulk(data, form)
    if table is not None and len(table) == len(numbers):
        return [Parsed(table, numbers, [])]
    if len(data) <= _SMALL or len(numbers) <= 1:
        return [_one_by_one(data, numbers, form)]
    middle = data.find(b"\n", len(data) // 2) + 1
    if middle in (0, len(data)):
        middle = data.rfind(b"\n", 0, len(data) - 1) + 1
    head = data[:middle]
    above = head.count(b"\n")
    return _halves(head, numbers[:above], form) + _halves(data[middle:], numbers[above:], form)


def _bulk(data: bytes, form: Format) -> FloatArray | None:
    """Parse all lines at once, or give None when one of them is unsound.

    Quotes, NULs and stray returns are not tried: there the quick parser could see other rows than an editor.
    """
    if any(mark in data for mark in (b'"', b"\0", b"\r")):
        return None
    names = [str(k) for k in range(form.width)]
    wanted = [names[k] for k in form.columns]
    try:
        table = pa_csv.read_csv(
            pa.py_buffer(data),
            pa_csv.ReadOptions(column_names=names, block_size=max(len(data), 1)),
            pa_csv.ParseOptions(delimiter=form.delimiter, quote_char=False, ignore_empty_lines=False),
            pa_csv.ConvertOptions(
                column_types=dict.fromkeys(wanted, pa.float64()),
                include_columns=wanted,
                null_values=NULLS,
                decimal_point=form.decimal,
                check_utf8=False,
            ),
        )
    except (pa.ArrowInvalid, pa.ArrowKeyError):
        return None
    return np.column_stack([table.column(name).to_numpy() for name in wanted])


def _one_by_one(data: bytes, numbers: IntArray, form: Format) -> Parsed:
    good: list[list[float]] = []
    rows: list[int] = []
    bad: list[tuple[int, str]] = []
    for number, line in zip(numbers.tolist(), data.decode("utf-8", "replace").split("\n"), strict=False):
        if not line.strip():
            continue
        cells = split(line, form.delimiter)
        if len(cells) != form.width:
            bad.append((number, "too few cells" if len(cells) < form.width else "too many cells"))
            continue
        values = [_number(cells[k], form.decimal) for k in form.columns]
        if None in values:
            bad.append((number, "text in a numeric cell"))
        else:
            good.append([v for v in values if v is not None])
            rows.append(number)
    return Parsed(np.array(good).reshape(-1, len(form.columns)), np.array(rows, np.int64), bad)


def split(line: str, delimiter: str) -> list[str]:
    """Cells of one line without their blanks; quotes as CSV has them."""
    if delimiter == BLANK:
        return [cell.strip('"') for cell in line.split()]
    if '"' not in line:
        return [cell.strip() for cell in line.split(delimiter)]
    try:
        return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))]
    except (csv.Error, StopIteration):
        return []


def _number(cell: str, decimal: str) -> float | None:
    if cell in NULLS:
        return float("nan")
    text = cell.replace(decimal, ".") if decimal != "." and "." not in cell else cell
    return float(text) if _NUMBER.fullmatch(text) else None


def _join(parts: list[Parsed], width: int) -> Parsed:
    if len(parts) == 1:
        return parts[0]
    tables = [p.table for p in parts] or [np.empty((0, width))]
    rows = [p.rows for p in parts]
    return Parsed(np.concatenate(tables), np.concatenate(rows), [b for p in parts for b in p.bad])
