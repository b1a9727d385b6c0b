"""The RTDE protocol without sockets. Layouts are written out by hand from UR's guide."""

import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from residuum.virtual.server.fields import FORMATS, INPUTS, OUTPUTS
from residuum.virtual.server.packets import BrokenStream
from residuum.virtual.server.session import Session


def ask(kind: str, payload: bytes = b"") -> bytes:
    return struct.pack(">HB", 3 + len(payload), ord(kind)) + payload


def outputs(rate: float, names: str) -> bytes:
    return ask("O", struct.pack(">d", rate) + names.encode())


@pytest.fixture
def written():
    return []


@pytest.fixture
def session(written):
    return Session((5, 21, 0, 0), {}, written.append)


def test_versions(session) -> None:
    assert list(session.feed(ask("V", b"\0\2"))) == [ask("V", b"\1")]
    assert list(session.feed(ask("V", b"\0\7"))) == [ask("V", b"\0")]
    assert list(session.feed(ask("v"))) == [ask("v", struct.pack(">4I", 5, 21, 0, 0))]


def test_outputs_give_types_in_order(session) -> None:
    (answer,) = session.feed(outputs(500.0, "timestamp,actual_q,safety_status,runtime_state,joint_mode,"))
    assert answer == ask("O", b"\1DOUBLE,VECTOR6D,INT32,UINT32,VECTOR6INT32")


def test_an_unknown_output_is_named_and_nothing_is_set_up(session) -> None:
    (answer,) = session.feed(outputs(500.0, "timestamp,nonsense"))
    assert answer == ask("O", b"\0DOUBLE,NOT_FOUND")
    assert list(session.feed(ask("S"))) == [ask("S", b"\1")]
    assert not session.due()


def test_a_field_of_a_newer_controller_is_not_found(written) -> None:
    for version, found in (((5, 21, 0, 0), b"NOT_FOUND"), ((5, 25, 1, 0), b"VECTOR6D")):
        (answer,) = Session(version, {}, written.append).feed(outputs(500.0, "actual_current_as_torque"))
        assert answer.endswith(found)


@pytest.mark.parametrize(("rate", "every"), [(500.0, 1), (125.0, 4), (250.0, 2), (1000.0, 1), (1.0, 500)])
def test_rates_by_the_robots_clock(session, rate, every) -> None:
    list(session.feed(outputs(rate, "timestamp") + ask("S")))
    due = [session.due() for _ in range(1000)]
    assert due == [k % every == 0 for k in range(1000)]


def test_pause_and_start(session) -> None:
    list(session.feed(outputs(500.0, "timestamp") + ask("S")))
    assert session.due()
    assert list(session.feed(ask("P"))) == [ask("P", b"\1")]
    assert not session.due()
    list(session.feed(ask("S")))
    assert session.due()


def test_inputs_are_written_without_a_start(session, written) -> None:
    answers = list(session.feed(ask("I", b"input_int_register_0,input_double_register_3,")))
    assert answers == [ask("I", b"\1INT32,DOUBLE")]
    assert list(session.feed(ask("U", struct.pack(">Bid", 1, -7, 0.25)))) == []
    assert written == [{"input_int_register_0": (-7,), "input_double_register_3": (0.25,)}]


def test_recipes_are_numbered_by_connection(session, written) -> None:
    list(session.feed(ask("I", b"input_int_register_0")))
    assert list(session.feed(ask("I", b"input_int_register_0,external_force_torque"))) == [
        ask("I", b"\2INT32,VECTOR6D")
    ]
    list(session.feed(ask("U", struct.pack(">Bi6d", 2, 1, *range(6)))))
    assert written[0]["external_force_torque"] == (0, 1, 2, 3, 4, 5)


def test_an_input_has_one_writer_until_it_goes(written) -> None:
    owners: dict[str, Session] = {}
    first, second = (Session((5, 21, 0, 0), owners, written.append) for _ in range(2))
    list(first.feed(ask("I", b"input_int_register_20")))
    request = ask("I", b"input_int_register_20,input_int_register_21")
    assert list(second.feed(request)) == [ask("I", b"\0IN_USE,INT32")]
    first.close()
    assert list(second.feed(request)) == [ask("I", b"\1INT32,INT32")]


@pytest.mark.parametrize(
    "payload", [b"", b"\1", b"\2" + bytes(4), b"\1" + bytes(5), b"\1" + struct.pack(">d", float("nan"))]
)
def test_wrong_data_is_told_and_not_written(session, written, payload) -> None:
    list(session.feed(ask("I", b"input_double_register_0")))
    (answer,) = session.feed(ask("U", payload))
    assert answer[2:3] == b"M" and b"input recipe" in answer
    assert written == []


def test_more_than_a_recipe_holds_is_cut(session, written) -> None:
    list(session.feed(ask("I", b"input_double_register_0")))
    assert list(session.feed(ask("U", struct.pack(">Bdd", 1, 0.5, 9.0)))) == []
    assert written == [{"input_double_register_0": (0.5,)}]


def test_half_packages_wait(session) -> None:
    request = ask("v")
    assert list(session.feed(request[:2])) == []
    assert list(session.feed(request[2:])) != []


@given(st.lists(st.binary(max_size=50), max_size=8))
def test_garbage_is_answered_or_dropped(pieces) -> None:
    session = Session((5, 21, 0, 0), {}, lambda _values: None)
    try:
        for piece in pieces:
            assert all(len(reply) >= 3 for reply in session.feed(piece))
    except BrokenStream as error:
        assert str(error)


def test_every_field_has_a_layout_and_a_value(controller) -> None:
    for name, kind in OUTPUTS.items():
        assert len(controller.snapshot.packed(name)) == FORMATS[kind].size, name
    assert set(INPUTS.values()) <= set(FORMATS)
