"""The header line of a text table: its delimiter and column names."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain

from ..errors import InputError
from .channels import TIMESTAMP
from .source import Block
from .table import BLANK, split

_DELIMITERS = (",", ";", BLANK)
_SHOWN = 40


@dataclass(frozen=True)
class Header:
    """Column `names` and how cells are separated; see `table.Format`."""

    names: tuple[str, ...]
    delimiter: str
    decimal: str


def header(blocks: Iterator[Block], where: str) -> tuple[Header, Iterator[Block]]:
    """Read the header from the first line that is not blank; give it and the blocks that follow it.

    Raises InputError when the file is empty or its first line names no columns.
    """
    for block in blocks:
        lines = block.data.split(b"\n", block.data.count(b"\n"))
        for k, line in enumerate(lines[:-1]):
            if line.strip():
                names, delimiter = _names(line.decode("utf-8", "replace"), f"{where}, line {block.first + k}")
                after = b"\n".join(lines[k + 1 :])
                rest = Block(block.first + k + 1, after, block.cut, block.read)
                sound = (rest,) if after else ()
                return Header(names, delimiter, _decimal(lines[k + 1 :], delimiter)), chain(sound, blocks)
    raise InputError(f"{where}: the file is empty; record again")


def _names(line: str, where: str) -> tuple[tuple[str, ...], str]:
    """Split the header: the delimiter is the one that isolates `timestamp`, or else makes most columns."""
    line = line.lstrip("# ")
    cells = {d: tuple(split(line, d)) for d in _DELIMITERS}
    right = [d for d in _DELIMITERS if TIMESTAMP.name in cells[d]]
    delimiter = right[0] if right else max(_DELIMITERS, key=lambda d: len(cells[d]))
    if not any(_is_name(cell) for cell in cells[delimiter]):
        shown = "".join(c if c.isprintable() else "?" for c in line[:_SHOWN])
        raise InputError(
            f"{where}: no column names but {shown!r}; begin with timestamp,actual_q_0,... as RTDE does"
        )
    return cells[delimiter], delimiter


def _is_name(cell: str) -> bool:
    return cell.isascii() and cell.replace("_", "a").isalnum() and cell[0].isalpha() and cell.lower() != "nan"


def _decimal(lines: Sequence[bytes], delimiter: str) -> str:
    """Give a comma when cells are separated by semicolons and the first row has commas but no points."""
    first = next((line for line in lines if line.strip()), b"")
    return "," if delimiter == ";" and b"," in first and b"." not in first else "."
