"""The catalogue of effects is whole: names, terms, rivals, words."""

from pathlib import Path

import pytest
import sympy as sp

from residuum.symbolic.effects import EFFECTS
from residuum.symbolic.terms import CATALOGUE

NAMES = [
    "payload",
    "link_inertial",
    "base_tilt",
    "rotor_inertia",
    "drive_gain",
    "coulomb_friction",
    "viscous_friction",
    "friction_asymmetry",
    "current_offset",
    "stribeck",
    "nonlinear_viscous",
    "load_dependent_friction",
    "temperature_dependent_friction",
    "presliding_hysteresis",
    "joint_elasticity",
    "torque_ripple",
    "backlash",
    "position_dependent_friction",
    "cable_spring",
    "encoder_offset",
    "time_delay",
    "velocity_lag",
    "external_contact",
    "frozen_joint_coupling",
    "dropped_coupling",
]


def test_every_name_of_findings_is_an_effect_and_no_other() -> None:
    assert sorted(EFFECTS) == sorted(NAMES)


def test_every_term_belongs_to_the_effect_that_it_names() -> None:
    for term in CATALOGUE.values():
        assert term.name in EFFECTS[term.effect].terms
    for effect in EFFECTS.values():
        assert {CATALOGUE[t].effect for t in effect.terms} <= {effect.name}


@pytest.mark.parametrize("name", NAMES)
def test_an_effect_says_all_that_a_report_needs(name) -> None:
    effect = EFFECTS[name]
    assert effect.equation
    assert set(effect.rivals) <= set(EFFECTS) - {name}
    assert effect.rivals
    for text in (effect.title, effect.source, effect.signature, effect.motion, effect.remedy):
        assert len(text) > 5 and not text.endswith(".")
    for parameter in effect.parameters.values():
        assert parameter.unit and parameter.plausible is not None
        assert parameter.plausible[0] < parameter.plausible[1]


def test_every_linear_parameter_has_a_prior_and_defaults_lie_in_theirs() -> None:
    for term in CATALOGUE.values():
        for name, parameter in term.parameters.items():
            assert parameter.plausible or name not in term.linear_in
            if parameter.plausible and parameter.default is not None:
                assert parameter.plausible[0] <= parameter.default <= parameter.plausible[1]


def test_equations_are_printed_from_the_expressions() -> None:
    assert EFFECTS["coulomb_friction"].equation == r"F_{c} \operatorname{sgn}(\dot q)"
    assert r"z \leftarrow" in EFFECTS["presliding_hysteresis"].equation
    for name, effect in EFFECTS.items():
        assert effect.terms or effect.written, name
        assert effect.equation.count("{") == effect.equation.count("}")


def test_expressions_hold_known_symbols_only() -> None:
    for term in CATALOGUE.values():
        known = {"q", "qd", "load", "temperature", *term.parameters, *term.state}
        assert {x.name for x in term.expression.free_symbols} <= known
        clock = {"dt", "started"}
        for update in term.state.values():
            assert {x.name for x in sp.sympify(update).free_symbols} <= known | clock


def test_the_page_names_every_term_and_effect() -> None:
    page = (Path(__file__).resolve().parents[2] / "docs" / "terms.md").read_text()
    for name in CATALOGUE:
        assert f"`{name}`" in page
    for name in EFFECTS:
        assert name in page
