"""The URScript programs of a model: the guard, the probe and the snapshot."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from jinja2 import Environment

from ..errors import InputError
from ..robots.model import Model
from ..symbolic.terms import TEMPERATURE
from ..urscript import Functions, RecordedWorld, parse
from ..urscript.nodes import Assign, walk
from .languages import URSCRIPT, Body, body
from .listing import Listing
from .memory import STEP
from .options import RTDE_VALUE, Options
from .symbolic_model import SymbolicModel

#: What is generated beside the observers.
SCRIPTS = ("collision_guard.script", "probe.script", "snapshot.script")
#: Meaning of output integer register 24.
STATES = {
    1: "measuring at rest",
    2: "guarding",
    3: "stopping",
    4: "retracting",
    5: "holding",
    6: "freedrive",
    7: "refused to guard",
    8: "motion finished",
}
#: Meaning of output integer register 25.
REASONS = {
    1: "the controller's step is not 2 ms",
    2: "PolyScope is older than the program",
    3: "another payload is set than the model knows of",
    4: "the robot moves",
    5: "joint angles disagree, so the registers are not what they should be",
    6: "a motor current is beyond what the joint can carry",
    7: "no motor current changes, so the readings are not alive",
    8: "the residual at rest is beyond its threshold",
    9: "the robot did not come to rest after the stop",
}
#: Output integer registers: what -> address.
INTEGERS = {
    "state": 24,
    "reason": 25,
    "joint": 26,
    "detectors": 27,
    "frame": 28,
    "sample": 29,
    "collisions": 30,
    "layout": 31,
}
#: Output float registers, one a joint from these addresses on.
FLOATS = {"residual": 24, "limit": 30, "speed": 36, "score": 42}
#: Output boolean registers.
BOOLEANS = {"guarding": 64, "collision": 65}
#: Bits of output integer register 27.
DETECTOR_BITS = {"static": 1, "speed": 2, "cusum": 4, "velocity": 8}
#: Raised when the meaning of a register changes.
LAYOUT = 1
#: The last second is kept in so many samples, so many frames apart.
SAMPLES, SPACING = 50, 10
#: Rest in frames before motion: the residual settles (8 time constants at 25 1/s), then it is averaged.
SETTLING, AVERAGING = 160, 90
#: Largest plausible current over that at rated torque.
CURRENT_MARGIN = 1.5
#: CUSUM: what is subtracted (share of the limit) and what it may add up to (s of one limit).
#: With limits at the extremes of 13 free motions of a UR10e the sum stays below 0.004 s.
CUSUM_DRIFT, CUSUM_TIME = 0.8, 0.01
#: Allowed difference of target and actual speed, rad/s; 0.029 is the most in a UR3e recording at 1.5 rad/s.
SPEED_DEVIATION = 0.06
#: Votes of three (speed, cusum, velocity) that are a collision.
VOTES = 2
#: How far the set payload may be from the model's, kg.
PAYLOAD_TOLERANCE = 0.05
#: Probe: steps that the registers are watched, and how often a step the equations are evaluated.
PROBE_FRAMES, PROBE_REPEATS = 2500, (0, 1, 2, 4, 8)
#: Longest output expression that is not given a name.
_PLAIN = 12


@dataclass(frozen=True)
class Size:
    """Of the guard: bytes, assignments in the whole text, most operations of a step in the interpreter."""

    size_in_bytes: int
    assignments: int
    operations: int


def guard_scripts(
    environment: Environment,
    shared: Mapping[str, object],
    symbolic: SymbolicModel,
    found: Mapping[str, Listing],
    options: Options,
) -> dict[str, str]:
    """Return file name -> text of the URScript programs.

    Raises InputError where the model's thresholds are no limits.
    """
    model = symbolic.model
    step = found.get(STEP, found["core"])
    core = body(step, URSCRIPT)
    context: dict[str, object] = {
        **shared,
        **_choices(options),
        **_constants(model),
        "inputs": core.inputs,
        "arguments": list(step.inputs),
        "statements": core.statements,
        "outputs": _named_outputs(core),
        "temperature_used": symbolic.uses(TEMPERATURE),
    }
    if model.thresholds is not None and min(model.thresholds.static) <= 0:
        raise InputError("thresholds: static must be above 0 Nm on every joint")
    texts = {name: environment.get_template(f"model/{name}.jinja").render(context) for name in SCRIPTS}
    return {name: re.sub(r"\n{3,}", "\n\n", text) for name, text in texts.items()}


def guard_size(text: str) -> Size:
    """Measure a guard; steps in which a sample of the last second is kept cost most and are counted."""
    still = [[0.0] * 6]
    functions = Functions(text, world=RecordedWorld(still, still, still))
    counts = [functions.operations]
    for _ in range(SPACING):
        functions.call("rs_watch")
        counts.append(functions.operations)
    assignments = sum(isinstance(node, Assign) for node in walk(*parse(text).body))
    return Size(len(text.encode()), assignments, max(b - a for a, b in pairwise(counts)))


def _choices(options: Options) -> dict[str, object]:
    motion = options.motion
    return {
        "modbus": options.current_source == "modbus",
        "reaction": options.reaction,
        "detector": options.detector,
        "uses_cusum": options.detector in ("cusum", "vote"),
        "uses_velocity": options.detector in ("velocity", "vote"),
        "bias": options.bias,
        "payload": options.payload,
        "polyscope": options.target,
        "minor": options.version.minor,
        "dashboard": options.version.major == 5,
        "rtde_value": options.version.reached(*RTDE_VALUE),
        "resume": options.resume,
        "resume_input": options.resume_input,
        "definitions": motion.definitions if motion else "",
        "motion": motion.body if motion else "",
    }


def _constants(model: Model) -> dict[str, object]:
    return {
        "joints": range(1, model.dof + 1),
        "zeros": ["0.0"] * model.dof,
        "six_zeros": ["0.0"] * 6,
        "most_current": [CURRENT_MARGIN * j.max_torque / j.drive_gain for j in model.joint],
        "cusum_drift": CUSUM_DRIFT,
        "cusum_time": CUSUM_TIME,
        "deviations": [SPEED_DEVIATION] * model.dof,
        "votes": VOTES,
        "payload_tolerance": PAYLOAD_TOLERANCE,
        "settling": SETTLING,
        "averaging": AVERAGING,
        "samples": SAMPLES,
        "spacing": SPACING,
        "integers": INTEGERS,
        "floats": FLOATS,
        "booleans": BOOLEANS,
        "bits": DETECTOR_BITS,
        "layout": LAYOUT,
        "probe_frames": PROBE_FRAMES,
        "probe_repeats": PROBE_REPEATS,
        "states": STATES,
        "reasons": REASONS,
    }


def _named_outputs(core: Body) -> Sequence[tuple[str, str]]:
    """Give (name, expression) of each result; what is short already keeps its text, as (text, "")."""
    named = []
    for label, texts in core.outputs.items():
        for k, text in enumerate(texts, start=1):
            named.append((text, "") if len(text) <= _PLAIN else (f"{label}{k}", text))
    return named
