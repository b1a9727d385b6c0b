"""Bytes of a recording: hash, decompression, encoding, and blocks of whole lines with their numbers."""

import codecs
import gzip
import hashlib
import io
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import BinaryIO

from ..errors import InputError

BLOCK = 1 << 22
LONGEST_LINE = 1 << 20

_BOMS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF32_LE, "utf-32-le"),
    (codecs.BOM_UTF32_BE, "utf-32-be"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)


@dataclass(frozen=True)
class Block:
    """Whole lines of a file, each ending in a line feed; `first` is the number of the first of them.

    `cut` says that the last line of the file had no line end, so that its last cell may be cut.
    `read` is the number of bytes on disk consumed so far.
    """

    first: int
    data: bytes
    cut: bool
    read: int


def sha256(path: Path) -> str:
    """Hash of the bytes on disk. Raises InputError when the file cannot be read."""
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); give an existing file") from error


def magic(path: Path) -> bytes:
    """First four bytes."""
    with path.open("rb") as file:
        return file.read(4)


def blocks(path: Path, size: int = BLOCK) -> Iterator[Block]:
    r"""Give the lines of a text file in blocks of about `size` bytes.

    gzip or not; UTF-8, or UTF-16 and UTF-32 with a byte order mark. Line ends become a line feed:
    `\r\n`, and a lone `\r` in files that have no line feed.
    Raises InputError for broken compression and for lines over a megabyte.
    """
    first, rest = 1, b""
    with path.open("rb") as raw:
        for data in _line_feeds(_utf8(_chunks(path, raw, size))):
            whole, end, rest = (rest + data).rpartition(b"\n")
            if len(rest) > LONGEST_LINE:
                line = first + whole.count(b"\n") + bool(end)
                raise InputError(f"{path}: line {line} is longer than 1 MB; this is not a table of text")
            if end:
                yield Block(first, whole + end, False, raw.tell())
                first += whole.count(b"\n") + 1
        if rest:
            yield Block(first, rest + b"\n", True, raw.tell())


def _chunks(path: Path, raw: BinaryIO, size: int) -> Iterator[bytes]:
    packed = raw.read(2) == b"\x1f\x8b"
    raw.seek(0)
    stream: io.BufferedIOBase = gzip.GzipFile(fileobj=raw) if packed else raw  # type: ignore[assignment]
    try:
        while data := stream.read(size):
            yield data
    except (EOFError, gzip.BadGzipFile, zlib.error) as error:
        raise InputError(f"{path}: broken gzip data ({error}); copy or compress the file again") from error


def _utf8(chunks: Iterator[bytes]) -> Iterator[bytes]:
    head = next(chunks, b"")
    bom, encoding = next(((b, e) for b, e in _BOMS if head.startswith(b)), (b"", "utf-8"))
    head = head[len(bom) :]
    if encoding == "utf-8":  # numbers are ASCII: no need to decode, and broken text harms its own row only
        yield head
        yield from chunks
        return
    decoder = codecs.getincrementaldecoder(encoding)(errors="replace")
    yield decoder.decode(head).encode()
    for chunk in chunks:
        yield decoder.decode(chunk).encode()
    yield decoder.decode(b"", final=True).encode()


def _line_feeds(chunks: Iterator[bytes]) -> Iterator[bytes]:
    head = next(chunks, b"")
    lone = b"\r" in head and b"\n" not in head
    held = b""  # a carriage return at the end of a chunk may belong to a line feed in the next
    for chunk in chain((head,), chunks):
        data = held + chunk
        held = b"\r" if data.endswith(b"\r") and not lone else b""
        data = data[: len(data) - len(held)]
        yield data.replace(b"\r", b"\n") if lone else data.replace(b"\r\n", b"\n")
    yield held
