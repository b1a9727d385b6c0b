"""Whatever stands in a model's list of terms is generated in all three languages, and is SymPy's value."""

import mpmath as mp
import numpy as np
import pytest

from residuum.codegen.generate import generate
from residuum.codegen.load import CLibrary, c_compiler, compile_c, load_text
from residuum.errors import InputError
from residuum.robots import load_robot
from residuum.robots.model import TermData
from residuum.symbolic.chain import Chain
from residuum.symbolic.nominal import nominal_model
from residuum.symbolic.reference import lambdify
from residuum.symbolic.terms import CATALOGUE
from residuum.urscript.run import Functions

POINTWISE = {name: term for name, term in CATALOGUE.items() if not term.state}


def all_terms(dof: int) -> tuple[TermData, ...]:
    """Every term without state on every joint, with numbers of its own; the others: test_memory.py."""
    random = np.random.default_rng(0)
    return tuple(
        TermData(
            name=name,
            joint=joint,
            parameters={p: float(random.uniform(0.1, 2.0)) for p in term.parameters if p != "width"},
        )
        for joint in range(1, dof + 1)
        for name, term in POINTWISE.items()
    )


@pytest.fixture(scope="module")
def tree():
    return generate(nominal_model(*load_robot("ur5e"), 3).model_copy(update={"term": all_terms(3)}))


def states(count: int = 30):
    random = np.random.default_rng(1)
    for _ in range(count):
        q, qd = random.uniform(-3, 3, 3), random.uniform(-3, 3, 3)
        yield q, qd, random.uniform(-80, 80, 3), random.uniform(15, 60, 3)


def exact(tree, q, qd, load, temperature) -> list[float]:
    inputs = {"q": q, "qd": qd, "load": load, "temperature": temperature}
    values = {f"{name}{i + 1}": column[i] for name, column in inputs.items() for i in range(3)}
    result = []
    with mp.workdps(50):
        for joint in (1, 2, 3):
            expression = tree.model.friction(joint)
            numbers = {
                s: mp.mpf(float(tree.model.values.get(s, values.get(s.name))))
                for s in expression.free_symbols
            }
            result.append(float(lambdify(list(numbers), expression, Chain())(*numbers.values())))
    return result


def test_numpy_is_sympys_value(tree) -> None:
    module = load_text(tree.files["observer.py"])
    for state in states():
        assert np.allclose(module.friction(*state), exact(tree, *state), rtol=1e-12, atol=1e-12)


@pytest.mark.skipif(c_compiler() is None, reason="no C compiler")
def test_c_is_sympys_value(tree, tmp_path) -> None:
    for name, text in tree.files.items():
        (tmp_path / name).write_text(text)
    compile_c(tmp_path, tmp_path / "observer.so")
    library = CLibrary(tmp_path / "observer.so", tree.model.model.name, tree.listings)
    for state in states():
        assert np.allclose(
            library.call("friction", *state)["friction"], exact(tree, *state), rtol=1e-12, atol=1e-12
        )


def test_urscript_carries_gravity_as_load_and_is_sympys_value(tree) -> None:
    module = load_text(tree.files["observer.py"])
    script = Functions(tree.files["collision_guard.script"])
    for q, qd, _, temperature in states():
        found = script.call("rs_core", list(q), list(qd), list(temperature))[6:]
        expected = exact(tree, q, qd, module.gravity(q), temperature)
        assert np.allclose(found, expected, rtol=1e-9, atol=1e-9)


def test_defaults_are_gravity_and_the_reference_temperature(tree) -> None:
    module = load_text(tree.files["observer.py"])
    q, qd = np.full(3, 0.4), np.full(3, 0.7)
    given = module.friction(q, qd, module.gravity(q), module.REFERENCE_TEMPERATURE)
    assert np.array_equal(module.friction(q, qd), given)


def test_page_shows_every_term_with_its_unit(tree) -> None:
    page = tree.files["model.md"]
    for name, term in POINTWISE.items():
        assert f"| 2 | {name} |" in page
        for parameter in term.parameters.values():
            assert parameter.unit == "1" or parameter.unit in page


def test_smooth_sign_costs_a_division_and_says_its_width(tree) -> None:
    kinds = tree.listings["friction"].operations_by_kind()
    assert kinds["div"] >= 3
    assert "np.tanh" not in tree.files["observer.py"]
    assert "w = 0.005 rad/s" in tree.files["observer.py"]


@pytest.mark.parametrize(
    ("term", "words"),
    [
        (TermData(name="coulom", joint=1), "did you mean coulomb"),
        (TermData(name="coulomb", joint=1), "parameter Fc is missing"),
        (TermData(name="coulomb", joint=1, parameters={"Fc": 1.0, "Fd": 2.0}), "no parameter Fd"),
    ],
)
def test_wrong_terms_are_named(term, words) -> None:
    model = nominal_model(*load_robot("ur5e"), 2).model_copy(update={"term": (term,)})
    with pytest.raises(InputError, match=words):
        generate(model)


def test_friction_terms_vanish_with_their_coefficients() -> None:
    for term in CATALOGUE.values():
        zero = dict.fromkeys(term.linear_in, 0)
        assert term.expression.subs(zero) == 0
        assert term.linear_in
