"""From a fitted baseline to the model that the other commands read."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..robots.model import Covariance, FitRecord, Model, TermData, Thresholds, Value
from .baseline import Baseline

#: A parameter counts as identified when the recordings cut its variance to less than half the prior's.
IDENTIFIED = 0.5
#: Numbers are written with this many digits: more than any recording can show, fewer than sums round off.
_DIGITS = 10


@dataclass(frozen=True)
class GainFit:
    """Drive gains (N,) in Nm/A with standard deviation (N,; None: not measured), and from what they are."""

    value: tuple[float, ...]
    std: tuple[float | None, ...]
    source: str


def build_model(found: Baseline, gains: GainFit, thresholds: Thresholds | None) -> Model:
    """Return the fitted model with covariance, held-out errors and inputs by hash."""
    joints = tuple(
        j.model_copy(update={"drive_gain": _short(g), "drive_gain_std": None if s is None else _short(s)})
        for j, g, s in zip(found.nominal.joint, gains.value, gains.std, strict=True)
    )
    return found.nominal.model_copy(
        update={
            "joint": joints,
            "base": _base(found),
            "term": _terms(found),
            "thresholds": thresholds,
            "fit": _record(found, gains),
            "covariance": _covariance(found),
            "source": found.nominal.source
            | {"torque_constant": gains.source, "fit": "residuum fit; see [fit]"},
            "inputs": (*found.nominal.inputs, *(p.source for p in found.placed)),
        }
    )


def _short(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")


def _base(found: Baseline) -> dict[str, Value]:
    values = {}
    for k, name in enumerate(found.recipe.regressor.base):
        published = found.nominal.base[name]
        seen = found.share[k] > IDENTIFIED
        width = found.problem.prior.std[k]
        source = (
            f"identified; prior {published.value:.4g} +- {width:.2g}"
            if seen
            else f"published as prior, {published.value:.4g} +- {width:.2g}: hardly shown by this motion"
        )
        values[name] = Value(
            value=_short(found.fitted.estimate.theta[k]),
            unit=published.unit,
            std=_short(found.std[k]),
            source=source,
        )
    return values


def _terms(found: Baseline) -> tuple[TermData, ...]:
    """Join the columns of one term on one joint."""
    width = len(found.recipe.regressor.base)
    searched = {(s.request.name, s.request.joints[0]): s for s in found.searched}
    data: dict[tuple[str, int], TermData] = {}
    for k, column in enumerate(found.recipe.regressor.terms):
        key = column.term, column.joint
        old = data.get(key, TermData(name=column.term, joint=column.joint))
        parameters = old.parameters | {n: _short(v) for n, v in column.values}
        parameters |= {column.parameter: _short(found.fitted.estimate.theta[width + k])}
        std = old.std | {column.parameter: _short(found.std[width + k])}
        if key in searched and np.isfinite(searched[key].std):
            std |= {searched[key].request.values[-1][0]: _short(searched[key].std)}
        source = "identified" if found.share[width + k] > IDENTIFIED else "not shown by this motion"
        if key in searched and searched[key].at_bound:
            source += f"; {searched[key].request.values[-1][0]} is at the border of its search"
        data[key] = TermData(
            name=column.term, joint=column.joint, parameters=parameters, std=std, source=source
        )
    return tuple(sorted(data.values(), key=lambda t: t.joint))


def _covariance(found: Baseline) -> Covariance:
    rows = tuple(" ".join(f"{x:.8g}" for x in row[: k + 1]) for k, row in enumerate(found.fitted.covariance))
    return Covariance(names=tuple(found.names), rows=rows)


def _record(found: Baseline, gains: GainFit) -> FitRecord:
    recipe, noise = found.recipe, found.fitted.noise
    one = len(found.placed) == 1
    notes = list(found.notes)
    if found.fitted.estimate.moved:
        notes.append(
            f"moved by {found.fitted.estimate.moved:.2g} standard deviations in all so that friction"
            " dissipates and some full set of physical links and rotors has these base parameters"
        )
    return FitRecord(
        scheme="weighted least squares, Huber weights, published values as prior",
        form=recipe.form, cutoff=recipe.cutoff, order=recipe.order, zero_phase=recipe.zero_phase,
        folds=len(found.fitted.folds),
        left_out="a tenth of the recording at a time" if one else "a recording at a time",
        held_out_percent=_row(found.held_out.percent()), held_out_rms=_row(found.held_out.rms()),
        noise=_row(noise.sigma), residual_memory=_row(noise.inflation * found.step),
        parameters=len(found.names), directions=found.directions, gains=gains.source, notes=tuple(notes),
    )  # fmt: skip


def _row(values: NDArray[np.float64]) -> tuple[float, ...]:
    return tuple(float(f"{v:.6g}") for v in values)
