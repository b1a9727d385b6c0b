"""What model.md says about a model."""

from collections.abc import Mapping, Sequence

import numpy as np
import sympy as sp

from ..robots.model import Model
from ..symbolic.base_parameters import base_parameters
from ..symbolic.nominal import robot_arm
from ..symbolic.terms import CATALOGUE
from .functions import operation_count
from .guard import guard_size
from .latex import equations, latex, symbol_latex, term_latex, update_latex
from .listing import Listing
from .memory import STEP, for_numpy
from .symbolic_model import JointTerm, SymbolicModel

#: What a row of the operations' table is called, where the function's name does not say it.
_COUNTED = {STEP: "core with the terms that remember"}
#: Share of the rated torque that stands in for a threshold until one is fitted.
UNFITTED_THRESHOLD = 0.2


def page_context(
    symbolic: SymbolicModel,
    found: Mapping[str, Listing],
    guard: str,
    further_counts: Sequence[tuple[str, int]] = (),
) -> dict[str, object]:
    """Return what model.md shows on top of what all templates share."""
    model = symbolic.model
    return {
        "locked": ", ".join(f"{np.rad2deg(a):g} deg" for a in model.locked_angles),
        "joints": model.joint,
        "gravity": model.gravity,
        "threshold_note": _threshold_note(model),
        "equations": equations(symbolic.dynamics),
        "terms": [_term_row(t) for t in symbolic.terms],
        "parameters": _parameter_rows(model),
        "sources": list(model.source.items()),
        "counts": [*_counts(symbolic, found), *further_counts],
        "script": guard_size(guard),
    }


def _threshold_note(model: Model) -> str:
    if model.thresholds is None:
        share = f"{UNFITTED_THRESHOLD:.0%}"
        return f"Thresholds are a stand-in, {share} of the rated torque, until `residuum fit` finds them."
    rate = model.thresholds.false_alarms_per_hour
    return "Thresholds: " + (f"{rate:g} false alarms per hour. " if rate else "") + model.thresholds.source


def _term_row(term: JointTerm) -> dict[str, object]:
    entry, values, std = CATALOGUE[term.data.name], term.values, term.data.std
    shown = [
        f"{n} = {values[n]:.6g}"
        + (f" +- {std[n]:.2g}" if n in std else "")
        + (f" {p.unit}" if p.unit != "1" else "")
        for n, p in entry.parameters.items()
    ]
    updates = {term.states[n]: sp.sympify(update).xreplace(term.renamed) for n, update in entry.state.items()}
    texts = [term_latex(term.expression), *update_latex(updates)]
    return {
        "joint": term.data.joint,
        "name": entry.name,
        "latex": r",\ ".join(texts).replace("|", r"\vert "),
        "parameters": "; ".join(shown),
        "source": term.data.source or entry.source,
    }


def _parameter_rows(model: Model) -> list[dict[str, object]]:
    meaning = (
        {} if model.variant == "thesis" else {s.name: m for s, m in base_parameters(robot_arm(model)).items()}
    )
    rows = []
    for name, value in model.base.items():
        text = value.source
        if name in meaning:
            text = f"${latex(meaning[name])}$; {value.source}"
        rows.append(
            {
                "latex": symbol_latex(name),
                "value": value.value,
                "std": "-" if value.std is None else f"{value.std:.2g}",
                "unit": value.unit,
                "meaning": text,
            }
        )
    return rows


def _counts(symbolic: SymbolicModel, found: Mapping[str, Listing]) -> Sequence[tuple[str, int]]:
    """Count this model and the cases that the project's tables compare."""
    rows = [("momentum and beta, as generated", found["momentum_and_beta"].operations)]
    rows += [
        (_COUNTED.get(name, name.replace("_", " ")), found[name].operations)
        for name in found
        if name != "momentum_and_beta" and not for_numpy(name)
    ]
    if symbolic.model.variant == "full":
        rows += [
            ("momentum and beta without rotors", operation_count(symbolic.without_rotors())),
            (
                "momentum and beta, every base parameter nonzero",
                operation_count(symbolic.with_all_parameters()),
            ),
        ]
    return rows
