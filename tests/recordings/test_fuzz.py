"""Thousands of broken files: no other exception than InputError, and no cell in a wrong column."""

import random
import re
import warnings

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from residuum.errors import InputError
from residuum.recordings import read
from residuum.recordings.audit import clean

NAMES = ["timestamp", *(f"actual_{c}_{j}" for c in ("q", "current") for j in range(2)), "payload"]
NUMBER = re.compile(r"[+-]?((\d+\.?\d*|\.\d+)(e[+-]?\d+)?|inf(inity)?|nan|)", re.ASCII | re.IGNORECASE)
GARBAGE = [
    *(
        b"\0",
        b"\xff",
        b"\xef\xbb\xbf",
        b"\r",
        b"\r\n",
        b'"',
        b"'",
        b"nan",
        b"1e305",
        b"-1e999",
        b"\n\n",
        b",,",
        b";",
    ),
    *(b" ", b"\t", b"inf", b"0x1f", b"1_0", "é".encode("latin-1"), "٣".encode(), b"--", b"1.2.3", b"#"),
]


def good(rng: random.Random, delimiter: str) -> bytes:
    rows = [[f"{0.01 * k:.3f}", *(f"{rng.uniform(-3, 3):.4f}" for _ in NAMES[1:])] for k in range(40)]
    return "".join(delimiter.join(row) + "\n" for row in [NAMES, *rows]).encode()


def mutate(data: bytes, rng: random.Random) -> bytes:
    kind = rng.randrange(9)
    at = rng.randrange(len(data) + 1)
    if kind == 0:
        return data[:at]
    if kind == 1:
        return data[:at] + data[at + rng.randrange(1, 30) :]
    if kind in (2, 3):
        return data[:at] + rng.choice(GARBAGE) + data[at:]
    if kind == 4:
        return data[:at] + bytes([rng.randrange(256)]) + data[at + 1 :]
    lines = data.split(b"\n")
    k = rng.randrange(len(lines))
    if kind == 5:
        lines.insert(k, rng.choice(lines))
    elif kind == 6:
        cells = lines[k].split(b",")
        rng.shuffle(cells)
        lines[k] = b",".join(cells)
    elif kind == 7:
        lines[k] = lines[k].replace(b",", rng.choice([b";", b" ", b"\t", b",,"]))
    else:
        return rng.choice(
            [data.replace(b"\n", b"\r\n"), data.decode("latin-1").encode("utf-16"), b"\n" + data]
        )
    return b"\n".join(lines)


def check(data: bytes, path) -> bool:
    """Read `data`; every row given must stand, cell for cell, in the line that it names."""
    path.write_bytes(data)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            got = read(path)
        except InputError as error:
            assert "\n" not in str(error)
            return False
        clean(got)[1].as_dict()
    text = (
        data.decode("utf-16", "replace")
        if data[:2] == b"\xff\xfe"
        else data.decode("utf-8", "replace").lstrip("\ufeff")
    )
    lines = re.split("\r\n|\n" if "\n" in text else "\r", text)
    delimiter = got.source.delimiter
    head = cells_of(next(line for line in lines if line.strip()).lstrip("# "), delimiter)
    columns = {"timestamp": got.timestamp}
    columns |= {f"actual_q_{j}": got.q[:, j] for j in range(got.joints)}
    columns |= {f"actual_current_{j}": got.current[:, j] for j in range(got.joints)}
    columns |= {name: v for name, v in got.others.items() if v.ndim == 1}
    for k, row in enumerate(got.rows):
        cells = cells_of(lines[row - 1], delimiter)
        assert len(cells) == len(head), lines[row - 1]
        for name, values in columns.items():
            cell = cells[head.index(name)]
            assert NUMBER.fullmatch(cell), cell
            np.testing.assert_equal(values[k], float(cell or "nan"))
    return True


def cells_of(line: str, delimiter: str) -> list[str]:
    cells = line.split() if delimiter == "blank" else line.split(delimiter)
    return [c.strip().strip('"') for c in cells]


def run(cases: int, seed: int, path) -> int:
    rng = random.Random(seed)
    readable = 0
    for _ in range(cases):
        data = good(rng, rng.choice([",", ",", ";", " "]))
        for _ in range(rng.randrange(1, 4)):
            data = mutate(data, rng)
        readable += check(data, path)
    return readable


def test_some_hundred_broken_files(tmp_path):
    assert run(300, 1, tmp_path / "f.csv") > 30  # the oracle must have something to compare


@pytest.mark.slow
def test_thousands_of_broken_files(tmp_path):
    assert run(6000, 2, tmp_path / "f.csv") > 600


@settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.binary(max_size=400))
def test_any_bytes_after_a_header(tmp_path, data):
    check(",".join(NAMES).encode() + b"\n" + data, tmp_path / "h.csv")


@settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.binary(max_size=400))
def test_any_bytes(tmp_path, data):
    path = tmp_path / "b.csv"
    path.write_bytes(data)
    with pytest.raises(InputError):
        read(path)
