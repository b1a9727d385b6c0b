"""Explanations made by hand, one for each verdict: what the page has to cope with, without a search."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from residuum.mismatch.result import Explanation, NextMotion, Proof, Region, RuledOut, Source, Trace
from residuum.robots import load_robot
from residuum.symbolic.effects import EFFECTS
from residuum.symbolic.nominal import nominal_model

DOF = 6
RECORDING = "cell3_monday.csv"
BEFORE = np.array([0.92, 2.41, 1.63, 0.21, 0.18, 0.11])
SCHEME = "leave one block of 10 s out, 75 blocks; rms of each joint's low-passed torque error where it moves"


@cache
def _model():
    return nominal_model(*load_robot("ur5e"), DOF)


def trace(joint: int, effect: str = "none", seconds: float = 120.0, rate: float = 125.0) -> Trace:
    """A joint that goes to and fro, with noise and one effect."""
    rng = np.random.default_rng(joint)
    t = np.arange(0.0, seconds, 1 / rate)
    q = 1.2 * np.sin(0.7 * t + joint) + 0.3 * np.sin(2.1 * t)
    qd = np.gradient(q, t)
    load = 30 * np.cos(q + 0.4) + 4 * np.sin(0.31 * t)
    added = {
        "none": np.zeros_like(t),
        "load_dependent_friction": 0.07 * np.abs(load) * np.tanh(qd / 0.02),
        "external_contact": 6.0 * ((t > 41.2) & (t < 44.0)),
        "unknown": 1.5 * np.exp(-(((q - 0.8) / 0.15) ** 2)),
    }[effect]
    noise = np.convolve(rng.normal(0, 1.0, len(t)), np.ones(20) / 20, "same") * 1.5
    since = np.zeros_like(t)
    for k in range(1, len(t)):
        since[k] = 0.0 if qd[k] * qd[k - 1] < 0 else since[k - 1] + 1 / rate
    temperature = 28 + 6 * (1 - np.exp(-t / 300))
    return Trace(RECORDING, joint, t, added + noise, noise, added, q, qd, load, temperature, since)


def finding(effect: str, joints: list[int], **more: Any) -> dict[str, Any]:
    """A finding of findings.json."""
    equation = EFFECTS[effect].equation if effect in EFFECTS else ""
    plain: dict[str, Any] = {
        "effect": effect,
        "joints": joints,
        "indistinguishable_from": [],
        "confidence": 0.97,
        "parameters": {},
        "equation": equation,
        "share": {str(j): 0.83 - 0.1 * k for k, j in enumerate(joints)},
        "next_motion": None,
    }
    return plain | more


def explanation(verdict: str, sentence: str, findings: list[dict[str, Any]], **more: Any) -> Explanation:
    """An explanation with sensible numbers around some findings."""
    named = any(f["effect"] not in ("unknown", "data_fault") for f in findings)
    moved = {j for f in findings for j in f["joints"]} if named else set()
    after = np.array([b * (0.35 if j in moved else 1.0) for j, b in enumerate(BEFORE, start=1)])
    interval = np.stack([0.9 * after, 1.12 * after], axis=1)
    ceiling = 0.93 * after
    with np.errstate(all="ignore"):
        reached = np.where(after < BEFORE, (BEFORE - after) / (BEFORE - ceiling), np.nan)
    regions = tuple(more.pop("regions", ()))
    whole = {
        "schema": 1,
        "verdict": verdict,
        "findings": findings,
        "where": [{"joint": r.joint, "share": r.share} for r in regions],
        "fit": {"unit": "Nm", "scheme": SCHEME, "before": BEFORE.tolist(), "after": after.tolist()},
        "placebo_rate": 0.004,
    }
    plain = Explanation(
        robot="UR5e",
        sources=(
            Source(RECORDING, 754.0, 500.0, False, ("3 samples repeated, dropped",)),
            Source("cell3_healthy.csv", 600.0, 500.0, True, ()),
        ),
        findings=whole,
        sentence=sentence,
        model=_model(),
        proof=Proof(SCHEME, BEFORE, after, interval, ceiling, reached, 4.1 * BEFORE, 4.1 * after, 1.0),
        regions=regions,
        traces=tuple(trace(j) for j in range(1, DOF + 1)),
        ruled_out=(
            RuledOut("position_dependent_friction", 2, "adds 0.05 % once load-dependent friction is in"),
            RuledOut("payload", None, "joints 1 and 4 to 6 do not change with it"),
        ),
        curves={},
        cannot=("drive gains: without a known load they cannot be told from masses",),
        next_motion=None,
    )
    return replace(plain, **more)


def with_effect(effect: str, joints: list[int]) -> tuple[Trace, ...]:
    """Traces of all joints, some with an effect."""
    return tuple(trace(j, effect if j in joints else "none") for j in range(1, DOF + 1))


def one_finding() -> Explanation:
    """Friction that grows with the load, on joints 2 and 3."""
    found = finding(
        "load_dependent_friction",
        [2, 3],
        parameters={
            "mu_2": {"value": 0.0712, "std": 0.0021, "unit": "1"},
            "mu_3": {"value": 0.0654, "std": 0.0034, "unit": "1"},
        },
    )
    return explanation(
        "explained",
        "Friction of joints 2 and 3 grows with the torque that they carry, by 7 % of it; "
        "the model has it constant.",
        [found],
        regions=(
            Region(2, "load sign", 0.81, 18.0, 34.0, "Nm", RECORDING, ((3.0, 9.0), (20.5, 26.0))),
            Region(3, "load sign", 0.74, 20.0, 34.0, "Nm"),
        ),
        traces=with_effect("load_dependent_friction", [2, 3]),
    )


def two_findings() -> Explanation:
    """A payload that may be a link's mass, and a contact for some seconds."""
    payload = finding(
        "payload",
        [1, 2, 3, 4, 5, 6],
        indistinguishable_from=["link_inertial", "base_tilt"],
        parameters={
            "mass": {"value": 1.503, "std": 0.021, "unit": "kg"},
            "centre_of_mass": {"value": [0.001, -0.012, 0.051], "std": [0.002, 0.002, 0.004], "unit": "m"},
        },
        next_motion="turn the wrist while the arm stands still, and hold several poses",
        confidence=0.88,
    )
    contact = finding("external_contact", [2], intervals=[[41.2, 44.0]], confidence=0.995)
    return explanation(
        "partly_explained",
        "About 1.5 kg too much hangs at the flange or on the forearm, and from 41.2 to 44.0 s something "
        "touched the arm.",
        [payload, contact],
        regions=(
            Region(2, "t", 0.4, 41.2, 44.0, "s", RECORDING, ((41.2, 44.0),)),
            Region(1, "q", 0.3, -0.5, 0.5, "rad"),
        ),
        traces=with_effect("external_contact", [2]),
    )


def unknown() -> Explanation:
    """Something at one angle of joint 4 that the catalogue does not hold."""
    grid = np.linspace(-1.4, 1.4, 40)
    return explanation(
        "unexplained",
        "Something acts on joint 4 near 0.8 rad, whichever way it turns; it fits no known cause.",
        [finding("unknown", [4], confidence=0.9)],
        regions=(Region(4, "q", 0.62, 0.6, 1.0, "rad"),),
        traces=with_effect("unknown", [4]),
        curves={4: ("q", grid, 1.4 * np.exp(-(((grid - 0.8) / 0.18) ** 2)))},
    )


def nothing_missing() -> Explanation:
    """A robot that matches its model."""
    return explanation("nothing_missing", "Nothing is missing: the model fits these recordings.", [])


def bad_data() -> Explanation:
    """A recording from which nothing follows."""
    none = np.zeros(DOF)
    empty = Proof("nothing was fitted", none, none, np.zeros((DOF, 2)), none, none * np.nan, none, none, 1.0)
    notes = (
        "actual_q_2 never changes while the current does: the encoder's channel is stuck",
        "41 % of the samples are missing",
    )
    fault = finding("data_fault", [3], intervals=[[0.0, 3.0]], share={}, next_motion="check the encoder")
    return explanation(
        "bad_data",
        "This recording cannot be explained: the angle of joint 3 is stuck.",
        [fault],
        sources=(Source("short.csv", 3.0, 125.0, False, notes),),
        proof=empty,
        traces=(),
        ruled_out=(),
        cannot=("short.csv: the angle of joint 3 is stuck",),
    )


def with_next_motion() -> Explanation:
    """Two rivals, and the motion that would part them."""
    names = "\n".join(
        f"  movej([{0.1 * k:.1f}, -1.2, 1.1, -1.4, -1.5, 0.0], a=1.2, v=0.5)" for k in range(40)
    )
    motion = NextMotion(
        "reverse joint 2 over 0.002, 0.01 and 0.05 rad, each slow and fast",
        np.array([[0.0, -1.2, 1.1, -1.4, -1.5, 0.0], [0.5, -1.2, 1.1, -1.4, -1.5, 0.3]]),
        0.5,
        f"def settle():\n{names}\nend\n",
        {"late sign on joint 2 | presliding on joint 2": 3.4},
    )
    found = finding(
        "presliding_hysteresis",
        [2],
        indistinguishable_from=["velocity_lag"],
        parameters={"zs": {"value": 0.0123, "std": 0.0031, "unit": "rad"}},
        next_motion=motion.text,
        confidence=0.71,
    )
    return explanation(
        "explained",
        "After each reversal joint 2 takes 0.012 rad to build up its friction, or it builds up late.",
        [found],
        regions=(Region(2, "since", 0.66, 0.0, 0.2, "s"),),
        next_motion=motion,
    )


#: Every kind of explanation by name.
ALL = {
    "one_finding": one_finding,
    "two_findings": two_findings,
    "unknown": unknown,
    "nothing_missing": nothing_missing,
    "bad_data": bad_data,
    "with_next_motion": with_next_motion,
}
