"""Straight-line code computes what CasADi computes, to the last bit."""

from __future__ import annotations

import math
from typing import Any

import casadi as ca
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from residuum.urscript import Functions

INPUTS = 4
BINARY = {ca.OP_ADD: "+", ca.OP_SUB: "-", ca.OP_MUL: "*", ca.OP_DIV: "/"}
UNARY = {
    ca.OP_NEG: "-{0}",
    ca.OP_SIN: "sin({0})",
    ca.OP_COS: "cos({0})",
    ca.OP_TAN: "tan({0})",
    ca.OP_ATAN: "atan({0})",
    ca.OP_SQRT: "sqrt({0})",
    ca.OP_SQ: "({0} * {0})",
    ca.OP_TWICE: "(2.0 * {0})",
    ca.OP_INV: "(1.0 / {0})",
    ca.OP_FABS: "norm({0})",
}


def listing(function: ca.Function) -> str:
    """The instructions of a CasADi function, one assignment each."""
    lines = [f"y{i} = 0.0" for i in range(function.nnz_out())]
    for k in range(function.n_instructions()):
        operation = function.instruction_id(k)
        into, args = function.instruction_output(k), function.instruction_input(k)
        if operation == ca.OP_INPUT:
            lines.append(f"w{into[0]} = x[{args[1]}]")
        elif operation == ca.OP_OUTPUT:
            lines.append(f"y{into[1]} = w{args[0]}")
        elif operation == ca.OP_CONST:
            lines.append(f"w{into[0]} = {float(function.instruction_constant(k))!r}")
        elif operation in BINARY:
            lines.append(f"w{into[0]} = w{args[0]} {BINARY[operation]} w{args[1]}")
        else:
            lines.append(f"w{into[0]} = " + UNARY[operation].format(f"w{args[0]}"))
    returned = ", ".join(f"y{i}" for i in range(function.nnz_out()))
    body = "\n".join(f"  {line}" for line in lines)
    return f"def f(x):\n{body}\n  return [{returned}]\nend\n"


def combine(draw: Any, pool: list[ca.SX]) -> ca.SX:
    """One more expression out of those there are."""
    pick = st.integers(0, len(pool) - 1)
    a, b = pool[draw(pick)], pool[draw(pick)]
    makers = [
        lambda: a + b,
        lambda: a - b,
        lambda: a * b,
        lambda: a / (1.5 + ca.sin(b)),
        lambda: ca.sin(a) * draw(st.floats(-10, 10)),
        lambda: ca.cos(a - b),
        lambda: -a,
        lambda: ca.sqrt(1 + b * b),
        lambda: ca.atan(a),
        lambda: ca.fabs(a) - 2 * b,
    ]
    return draw(st.sampled_from(makers))()


@st.composite
def functions(draw: Any) -> ca.Function:
    x = ca.SX.sym("x", INPUTS)
    pool = list(ca.vertsplit(x))
    for _ in range(draw(st.integers(1, 40))):
        pool.append(combine(draw, pool))
    return ca.Function("f", [x], [ca.vertcat(*pool[-3:])], {"cse": True})


# CasADi's own libm may round differently from ours in the last place, and that grows through subtraction.
@settings(max_examples=100, deadline=None)
@given(functions(), st.lists(st.floats(-3, 3), min_size=INPUTS, max_size=INPUTS))
def test_casadi_listings_evaluate_alike(function: ca.Function, x: list[float]) -> None:
    expected = function(x).full().ravel().tolist()
    found = Functions(listing(function)).call("f", x)
    for ours, theirs in zip(found, expected, strict=True):
        assert ours == theirs or abs(ours - theirs) <= math.ulp(theirs)


@given(st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=3, max_size=3))
def test_floats_are_doubles_in_source_order(values: list[float]) -> None:
    a, b, c = values
    found = FLOATS.call("f", a, b, c)
    assert found == [a + b + c, a + (b + c), a - b - c, a * b * c] or any(map(math.isnan, found))


FLOATS = Functions("def f(a, b, c): return [a + b + c, a + (b + c), a - b - c, a * b * c] end")


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_printed_floats_come_back(value: float) -> None:
    assert Functions(f"def f(): return {value!r} end").call("f") == value


@pytest.mark.parametrize("n", [3, 5])
def test_matrix_products(n: int) -> None:
    rows = [[float(i * n + j) for j in range(n)] for i in range(n)]
    product = Functions("def f(a, b): return a * b end").call("f", rows, rows)
    assert product == [[sum(rows[i][k] * rows[k][j] for k in range(n)) for j in range(n)] for i in range(n)]
