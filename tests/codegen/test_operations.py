"""How few operations: the project's targets, and that the algebra changes no value."""

import numpy as np
import pytest

from residuum.codegen.algebra import simplify
from residuum.codegen.functions import operation_count, symbolic_model
from residuum.codegen.listing import Builder, Instruction, evaluate
from residuum.robots import load_robot
from residuum.symbolic.nominal import nominal_model


def model(dof: int, wrist: str = "locked"):
    return symbolic_model(nominal_model(*load_robot("ur5e"), dof, wrist=wrist))


@pytest.mark.parametrize(
    ("dof", "wrist", "limit"), [(3, "absent", 71), (3, "locked", 90), (6, "locked", 239)]
)
def test_published_parameters(dof, wrist, limit) -> None:
    assert operation_count(model(dof, wrist).without_rotors()) <= limit


@pytest.mark.parametrize(("dof", "limit"), [(3, 104), (6, 423)])
def test_every_base_parameter_nonzero(dof, limit) -> None:
    full = model(dof).with_all_parameters()
    assert all(v.value for k, v in full.model.base.items())
    assert operation_count(full) <= limit


@pytest.mark.parametrize(("dof", "limit"), [(3, 71), (6, 239)])
def test_rotors_fit_in_too(dof, limit) -> None:
    assert operation_count(model(dof, "absent")) <= limit


def test_model_page_prints_the_counts(generated) -> None:
    tree = generated("ur5e", 6)
    count = tree.listings["momentum_and_beta"].operations
    assert f"| momentum and beta, as generated | {count} |" in tree.files["model.md"]


def test_algebra_keeps_every_function(generated) -> None:
    random = np.random.default_rng(0)
    for listing in generated("ur10e", 4).listings.values():
        shorter = simplify(listing)
        assert shorter.operations <= listing.operations
        values = {name: random.uniform(-2, 2, size) for name, size in listing.inputs.items()}
        before, after = evaluate(listing, values), evaluate(shorter, values)
        for name in before:
            assert np.allclose(before[name], after[name], rtol=1e-12, atol=1e-12)


def test_algebra_finds_what_a_person_would() -> None:
    """x*y + x*z - w*(y + z) is (x - w)*(y + z): 5 operations become 3."""
    builder = Builder()
    x, y, z, w = (builder.add(Instruction("input", (0, i))) for i in range(4))

    def put(op, *args):
        return builder.add(Instruction(op, args))

    total = put("sub", put("add", put("mul", x, y), put("mul", x, z)), put("mul", w, put("add", y, z)))
    listing = builder.listing("f", {"v": 4}, {"out": ((1,), (total,))})
    assert listing.operations == 6
    assert simplify(listing).operations == 3
