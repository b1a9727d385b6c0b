import gzip
import hashlib
import warnings

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from residuum.errors import InputError
from residuum.recordings import Recording, read, read_chunks, speeds

HEAD = "timestamp,actual_q_0,actual_current_0\n"


def table(tmp_path, text, name="t.csv"):
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


@pytest.mark.parametrize("delimiter", [",", ";", " ", "\t", "   "])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_every_delimiter_and_line_end_gives_the_same(make, write, delimiter, end):
    made = make(seconds=1)
    got = read(write(made, delimiter=delimiter, end=end))
    for name in ("timestamp", "q", "qd", "current"):
        np.testing.assert_array_equal(getattr(got, name), getattr(made, name))
    np.testing.assert_array_equal(got.rows, made.rows)
    assert got.source.delimiter == (delimiter if delimiter in ",;" else "blank")
    assert not got.dropped


def test_gzip_and_provenance(make, write, tmp_path):
    plain = write(make(seconds=1))
    packed = table(tmp_path, gzip.compress(plain.read_bytes()), "t.csv.gz")
    got = read(packed)
    np.testing.assert_array_equal(got.q, read(plain).q)
    assert got.source.file == "t.csv.gz"
    assert got.source.sha256 == hashlib.sha256(packed.read_bytes()).hexdigest()


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-32"])
def test_byte_order_marks(tmp_path, encoding):
    got = read(table(tmp_path, (HEAD + "1,2,3\n4,5,6\n").encode(encoding)))
    np.testing.assert_array_equal(got.q, [[2], [5]])


def test_parquet(make, tmp_path):
    made = make(seconds=1)
    columns = {"timestamp": made.timestamp, "note": ["x"] * len(made)}
    for j in range(6):
        columns |= {f"actual_q_{j}": made.q[:, j], f"actual_current_{j}": made.current[:, j]}
    path = tmp_path / "r.parquet"
    pq.write_table(pa.table(columns), path)
    got = read(path)
    np.testing.assert_array_equal(got.current, made.current)
    np.testing.assert_array_equal(got.rows, np.arange(1, len(made) + 1))
    assert got.qd is None
    assert [len(c) for c in read_chunks(path, rows=64)] == [64, 36]


def test_parquet_with_text_for_a_number(tmp_path):
    path = tmp_path / "r.parquet"
    pq.write_table(pa.table({"timestamp": ["a"], "actual_q_0": [1.0], "actual_current_0": [1.0]}), path)
    with pytest.raises(InputError, match="timestamp"):
        read(path)
    path.write_bytes(path.read_bytes()[:60])
    with pytest.raises(InputError, match="Parquet"):
        read(path)


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("1,2", "too few cells"),
        ("1,2,3,4", "too many cells"),
        ("1,x,3", "text in a numeric cell"),
        ("1,2\0,3", "text in a numeric cell"),
        ("1,1_0,3", "text in a numeric cell"),
        ("1,0x1,3", "text in a numeric cell"),
        ("1,2\r3,4", "text in a numeric cell"),
        ('1,"2,3', "too few cells"),
        ("timestamp,actual_q_0,actual_current_0", "text in a numeric cell"),
    ],
)
def test_broken_rows_are_dropped_and_said(tmp_path, line, reason):
    got = read(table(tmp_path, f"{HEAD}0,1,2\n{line}\n\n5,6,7\n"))
    np.testing.assert_array_equal(got.rows, [2, 5])
    np.testing.assert_array_equal(got.q[:, 0], [1, 6])
    assert [(d.reason, d.rows.tolist()) for d in got.dropped] == [(reason, [3])]


def test_a_cut_last_line_is_dropped(tmp_path):
    got = read(table(tmp_path, HEAD + "0,1,2\n3,4,55"))
    np.testing.assert_array_equal(got.rows, [2])
    assert got.dropped[0].rows.tolist() == [3]


def test_empty_cells_quotes_and_decimal_commas(tmp_path):
    got = read(table(tmp_path, HEAD + '0,,2\n"1","2","3"\n'))
    assert np.isnan(got.q[0, 0])
    assert got.current[1, 0] == 3
    got = read(table(tmp_path, HEAD.replace(",", ";") + "0,5;1,25;-2e-1\n1;2;3\n"))
    np.testing.assert_array_equal(got.q[:, 0], [1.25, 2.0])


def test_huge_numbers_are_read_as_they_are(tmp_path):
    assert read(table(tmp_path, HEAD + "0,1e305,-1e-320\n")).q[0, 0] == 1e305


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "empty"),
        ("\n\n", "empty"),
        (HEAD, "no rows"),
        (HEAD + "a,b,c\n", "line 2"),
        ("0,1,2\n3,4,5\n", "no column names"),
        ("time,actual_q_0,actual_current_0\n1,2,3\n", "timestamp"),
        ("timestamp,actual_q_0\n1,2\n", "actual_current_0"),
        ("timestamp,actual_q_0,actual_q_2,actual_current_0\n1,2,3,4\n", "actual_q_1"),
        ("timestamp,actual_q_0,actual_q_0,actual_current_0\n1,2,3,4\n", "actual_q_0.* 2 times"),
        (b"\x00\x01\x02" * 1000, "no column names"),
        (b"x" * (6 << 20), "longer than 1 MB"),
        (b"\x1f\x8b\x08broken", "gzip"),
    ],
)
def test_unusable_files_say_why_in_one_line(tmp_path, text, says):
    path = table(tmp_path, text)
    with pytest.raises(InputError, match=says) as error:
        read(path)
    assert "\n" not in str(error.value)
    assert "t.csv" in str(error.value)


def test_missing_files_and_folders(tmp_path):
    for path in (tmp_path / "none.csv", tmp_path):
        with pytest.raises(InputError):
            read(path)


def test_other_columns_are_ignored_and_extra_ones_kept(tmp_path):
    head = "_id,timestamp,actual_q_0,actual_current_0,payload,counts,payload_cog_1\n"
    path = table(tmp_path, head + "2021:10,1,2,3,4,5,6\n")
    got = read(path, extra=["counts"])
    assert got.others["counts"].tolist() == [5]
    assert got.others["payload"].tolist() == [4]
    assert got.ignored == ("payload_cog_1",)
    with pytest.raises(InputError, match="nothing"):
        read(path, extra=["nothing"])


@pytest.mark.parametrize("rows", [1, 7, 100, 1000])
def test_pieces_make_the_whole(make, write, rows):
    path = write(make(seconds=3))
    text = path.read_text().splitlines()
    text[50], text[200] = "broken", text[200] + ",1"
    path.write_text("\n".join(text) + "\n")
    whole, pieces = read(path), list(read_chunks(path, rows=rows))
    assert all(len(p) == rows for p in pieces[:-1])
    np.testing.assert_array_equal(np.concatenate([p.q for p in pieces]), whole.q)
    np.testing.assert_array_equal(np.concatenate([p.rows for p in pieces]), whole.rows)
    assert sorted(n for p in pieces for d in p.dropped for n in d.rows) == [51, 201]


def test_progress_ends_at_one(make, write):
    seen = []
    read(write(make(seconds=1)), progress=seen.append)
    assert seen[-1] == 1.0


def test_recordings_are_frozen_and_shapes_agree(make):
    made = make(seconds=1)
    with pytest.raises(ValueError, match="read-only"):
        made.q[0, 0] = 1
    with pytest.raises(ValueError, match="shape"):
        Recording("x", made.timestamp, made.q, made.current[:-1])


def test_speeds_follow_non_uniform_time(make):
    made = make(seconds=2)
    assert speeds(made) is made.qd
    time = np.sort(np.random.default_rng(0).uniform(0, 2, 400))
    parabola = Recording("x", time, np.column_stack([time**2]), np.column_stack([time]))
    np.testing.assert_allclose(speeds(parabola)[:, 0], 2 * time, atol=1e-9)
    with pytest.raises(ValueError, match="increase"):
        speeds(parabola.take(np.array([3, 2, 1])))


def test_real_recordings(shared):
    wave = read(shared / "ur3e_one_joint" / "shoulder_lift_wave.csv")
    assert (len(wave), wave.source.delimiter, wave.rows[0]) == (6887, "blank", 3)
    many = read(shared / "awkward" / "ur3e_174_columns.csv")
    assert many.q[0, 5] == 12.60121382
    assert many.joint_temperatures[0, 0] == 34.4375
    with pytest.raises(InputError, match="timestamp"):
        read(shared / "ur5e_one_joint" / "joint_1.csv")


@pytest.mark.slow
def test_memory_stays_flat(tmp_path):
    pa_memory = pa.total_allocated_bytes()
    body = ("0.001," + ",".join(["0.123456"] * 12) + "\n") * 1000
    names = ",".join(["timestamp", *(f"actual_{c}_{j}" for c in ("q", "current") for j in range(6))])
    path = tmp_path / "big.csv"
    with path.open("w") as file:
        file.write(names + "\n")
        for _ in range(1000):
            file.write(body)
    import tracemalloc

    tracemalloc.start()
    count = sum(len(c) for c in read_chunks(path, rows=10_000))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert count == 1_000_000
    assert peak < 64e6  # the whole table is 104 MB
    assert pa.total_allocated_bytes() - pa_memory < 64e6


def test_no_warnings_on_hostile_numbers(tmp_path):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        read(table(tmp_path, HEAD + "1e999,-1e999,1e400\n1e308,-1e308,nan\n"))
