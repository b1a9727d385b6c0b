"""A finding's numbers: physical parameters with units and standard deviations, from its coefficients."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from ..robots.model import Model
from ..symbolic.terms import CATALOGUE
from .candidates import Candidate
from .evidence import Evidence
from .naming import Scored
from .rows import Rows
from .selection import Directions, eliminate

Array = NDArray[np.float64]

#: Share by which a drive gain may be off when nothing has shown it (sources differ by 4-50 %).
GAIN_DOUBT = 0.15
#: Prior width of a payload's mass (kg), first moments (kg m) and inertias (kg m^2).
PAYLOAD = np.array([10.0, 3.0, 3.0, 3.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0])

#: What is mixed of two neighbouring values: its name and unit.
_MIXED = {"backlash": ("gap", "rad"), "joint_elasticity": ("stiffness", "Nm/rad")}

#: Share by which a swing between two stiffnesses misses its own when it is mixed of them (test_windup.py).
MIXING = 0.04

Quantity = Mapping[str, Any]


def quantity(value: float, std: float | None, unit: str) -> Quantity:
    """Return a number as findings.json has it, six digits."""
    return {
        "value": float(f"{value:.6g}"),
        "std": None if std is None or not np.isfinite(std) else float(f"{std:.3g}"),
        "unit": unit,
    }


def parameters_of(evidence: Evidence, before: Directions, found: Scored, model: Model) -> dict[str, Quantity]:
    """Return the physical parameters of a finding, nonlinear values as they stand on their grid."""
    c, size, std = found.candidate, found.size, found.std
    if c.effect == "payload":
        return _payload(evidence, before, model)
    if c.effect == "link_inertial":
        return _link(evidence, c, size, std)
    simple = {
        "encoder_offset": ("offset", -1.0, "rad"),
        "time_delay": ("delay", 1.0, "s"),
        "rotor_inertia": ("inertia", 1.0, "kg m^2"),
        "frozen_joint_coupling": ("share", 1.0, "1"),
        "dropped_coupling": ("share", 1.0, "1"),
    }
    if (
        c.effect == "drive_gain"
    ):  # the column is -torque: (1 + error) K i = torque makes it error / (1 + error)
        part = 1 - float(size[0])
        return {"error": quantity(size[0] / part, std[0] / part**2, "1")}
    if c.effect in simple:
        name, sign, unit = simple[c.effect]
        return {name: quantity(sign * size[0], std[0], unit)}
    if c.effect in _MIXED and c.values:  # two values in the proportion that their coefficients have
        (name, unit), ends, total = _MIXED[c.effect], np.array([v for _, v in c.values]), float(size.sum())
        value = float(np.clip(size @ ends / total, ends.min(), ends.max()))
        own = MIXING * value if c.whole else 0.0
        return {
            name: quantity(value, float(np.hypot(np.linalg.norm((ends - value) * std) / total, own)), unit)
        }
    if c.effect == "joint_elasticity":
        return {"stiffness": quantity(1 / size[0], std[0] / size[0] ** 2, "Nm/rad")}
    if c.effect == "base_tilt":
        return {n: quantity(size[k], std[k], "rad") for k, n in enumerate(("roll", "pitch"))}
    part = found.between / abs(float(size[0])) if found.between else 1.0
    return _term(c, part * size, part * std)


def _term(c: Candidate, size: Array, std: Array) -> dict[str, Quantity]:
    entry = CATALOGUE[c.terms[0]]
    units = {n: p.unit for n, p in entry.parameters.items()}
    found = {n: quantity(size[k], std[k], units[n]) for k, n in enumerate(entry.linear_in)}
    if c.effect == "cable_spring":
        found["constant"] = quantity(size[1], std[1], "Nm")
    for name, value in c.values:
        if name != "width":
            found[name] = quantity(value, None, units[name])
    return found


def _payload(evidence: Evidence, before: Directions, model: Model) -> dict[str, Quantity]:
    vectors = sparse.csc_matrix(payload_directions(evidence))
    own = Directions(vectors, PAYLOAD, np.zeros(10, bool))
    return payload_numbers(*eliminate(evidence.sums, before, own, None).solve(range(10)), model)


def payload_directions(evidence: Evidence) -> Array:
    """Return what a payload's ten parameters at the last frame are in the parameter space (P, 10)."""
    links = evidence.setup.physics.map.links[:, -10:]
    vectors = np.zeros((evidence.setup.space.size, 10))
    vectors[: len(links)] = links
    return vectors


def payload_columns(evidence: Evidence, rows: Rows) -> Array:
    """Return the columns (n, N, 10) of a payload's ten parameters."""
    space, lifted = evidence.setup.space, payload_directions(evidence)
    return np.stack([rows.columns[j] @ lifted[space.indices[j]] for j in range(space.dof)], axis=1)


def payload_numbers(value: Array, covariance: Array, model: Model) -> dict[str, Quantity]:
    """Return mass and centre of mass at the flange, in the frame of the last joint; the gains' doubt is in.

    value (10,): kg, kg m, kg m^2 in the last joint's turned frame; covariance (10, 10).
    """
    doubts = [j.drive_gain_std / j.drive_gain if j.drive_gain_std else GAIN_DOUBT for j in model.joint]
    doubt = float(np.sqrt(np.mean(np.square(doubts))))
    mass, spread = float(value[0]), float(np.sqrt(covariance[0, 0] + (doubt * value[0]) ** 2))
    tip = model.joint[-1]
    centre = value[1:4] / mass - np.array([tip.a, 0.0, tip.d])
    slope = np.hstack([-value[1:4, None] / mass**2, np.eye(3) / mass])  # (3, 4) of mass and first moments
    scatter = np.sqrt(np.diag(slope @ covariance[:4, :4] @ slope.T))
    return {
        "mass": quantity(mass, spread, "kg"),
        "centre_of_mass": {
            "value": [float(f"{x:.4g}") for x in centre],
            "std": [float(f"{x:.3g}") for x in scatter],
            "unit": "m",
        },
    }


def _link(evidence: Evidence, c: Candidate, size: Array, std: Array) -> dict[str, Quantity]:
    """Return the three base parameters that changed most surely: a link's own numbers are not seen alone."""
    names = evidence.setup.space.base
    vectors = evidence.found.directions.vectors[:, list(c.columns)].toarray()[: len(names)]
    change = vectors @ size
    spread = np.sqrt((vectors**2) @ std**2)
    sure = np.abs(change) / np.maximum(spread, 1e-12)
    order = np.argsort(-sure)[:3]
    unit = {k: "kg m" if n.startswith("M") else "kg m^2" for k, n in enumerate(names)}
    return {names[k]: quantity(change[k], spread[k], unit[k]) for k in order if sure[k] > 2}
