"""Cutting programs out of a script port's stream."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from residuum.virtual.server.framing import LARGEST, Framer, TooLarge

ONE = "def one():\n  x = 1\nend\n"
TWO = "sec two():\n  y = 2\nend\n"


def test_programs_come_out_in_order_and_comments_do_not() -> None:
    assert list(Framer().feed(f"# hello\n{ONE}\n{TWO}power on\n".encode())) == [ONE, TWO, "power on"]


@given(st.lists(st.integers(1, 60)))
def test_pieces_of_any_size_give_the_same(cuts) -> None:
    framer, data, found = Framer(), (ONE + TWO).encode(), []
    for size in cuts:
        found += framer.feed(data[:size])
        data = data[size:]
    found += framer.feed(data)
    assert found == [ONE, TWO]


def test_column_one_of_client_libraries_belongs_to_the_program() -> None:
    text = "def one():\n    global a = # offset\n0    global b = 1\n# note\nend\n"
    assert list(Framer().feed(text.encode())) == [text]


def test_a_program_without_its_last_newline_comes_at_the_end() -> None:
    framer = Framer()
    assert list(framer.feed(ONE.encode().rstrip())) == []
    assert list(framer.close()) == [ONE]
    assert framer.unfinished is None


def test_a_cut_program_is_known_by_its_first_line() -> None:
    framer = Framer()
    assert list(framer.feed(b"def one():\n  x = ")) == []
    assert list(framer.close()) == []
    assert framer.unfinished == "def one():"


def test_carriage_returns_are_dropped() -> None:
    assert list(Framer().feed(ONE.replace("\n", "\r\n").encode())) == [ONE]


def test_a_flood_ends() -> None:
    framer = Framer()
    with pytest.raises(TooLarge):
        list(framer.feed(b"def one():\n" + b" " * LARGEST))


@given(st.binary(max_size=300))
def test_garbage_gives_lines_and_never_an_exception(data) -> None:
    assert all(isinstance(text, str) for text in Framer().feed(data))
