"""Parameters of an answer beside the true ones, where both have the same meaning."""

from math import hypot, nan
from typing import Any

import numpy as np

#: Effect -> parameter of the finding -> parameter of the truth (joint side, SI).
SAME = {
    "payload": {"mass": "mass", "centre_of_mass": "centre_of_mass"},
    "rotor_inertia": {"inertia": "inertia", "share": "share"},
    "drive_gain": {"error": "error"},
    "coulomb_friction": {"Fc": "torque", "torque": "torque"},
    "viscous_friction": {"Fv": "damping", "damping": "damping"},
    "friction_asymmetry": {"Fa": "torque", "c": "torque", "torque": "torque"},
    "current_offset": {"c": "torque", "Fa": "torque", "torque": "torque"},
    "stribeck": {"Fs": "torque", "vs": "speed", "torque": "torque"},
    "load_dependent_friction": {"mu": "mu"},
    "presliding_hysteresis": {"zs": "travel", "travel": "travel"},
    "joint_elasticity": {"stiffness": "stiffness", "K": "stiffness"},
    "backlash": {"gap": "gap"},
    "cable_spring": {"k": "stiffness", "stiffness": "stiffness"},
    "encoder_offset": {"offset": "offset"},
    "time_delay": {"d": "delay", "delay": "delay"},
    "velocity_lag": {"lag": "lag"},
    "position_dependent_friction": {"amplitude": "amplitude"},
    "torque_ripple": {"amplitude": "amplitude"},
    "base_tilt": {"tilt": "tilt"},
}
#: Sign conventions differ here (what is off: the sensor or the robot), so sizes are compared.
SIZE_ALONE = {"encoder_offset", "friction_asymmetry", "current_offset"}


def errors(truth: dict[str, Any], finding: dict[str, Any]) -> dict[str, float]:
    """Return relative errors |found - true| / |true| by "effect.parameter", vectors by their norms."""
    effect = truth["effect"]
    found = _derived(effect, {k: v["value"] for k, v in finding.get("parameters", {}).items()})
    true = _derived(effect, dict(truth["parameters"]))
    result: dict[str, float] = {}
    for theirs, ours in SAME.get(effect, {}).items():
        if theirs in found and ours in true:
            error = _relative(found[theirs], true[ours], effect in SIZE_ALONE)
            if np.isfinite(error):
                result.setdefault(f"{effect}.{ours}", error)
    return result


def _derived(effect: str, values: dict[str, Any]) -> dict[str, Any]:
    """Add what is compared as one: an amplitude of sine and cosine, a tilt of roll and pitch."""
    pairs = {
        "position_dependent_friction": (("A", "B"), ("sine", "cosine")),
        "torque_ripple": (("A", "B"),),
    }
    for a, b in pairs.get(effect, ()):
        if a in values and b in values:
            values["amplitude"] = float(np.max(np.hypot(values[a], values[b])))
    if effect == "torque_ripple" and "torque" in values:
        values["amplitude"] = float(np.max(np.abs(values["torque"])))
    if effect == "base_tilt" and {"roll", "pitch"} <= set(values):
        values["tilt"] = hypot(values["roll"], values["pitch"])
    return values


def _relative(found: Any, true: Any, sizes: bool) -> float:
    a, b = np.asarray(found, dtype=float), np.asarray(true, dtype=float)
    if a.shape != b.shape or not b.any():
        return nan
    if sizes:
        a, b = np.abs(a), np.abs(b)
    return float(np.linalg.norm(a - b) / np.linalg.norm(b))
