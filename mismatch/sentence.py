"""The answer in a sentence."""

from collections.abc import Mapping, Sequence
from typing import Any

from .quantities import Quantity
from .report.wording import joints_text, title

#: Findings up to which all are told with their numbers; of more, so many: the others by name and joints.
_FEW, _FIRST = 4, 2


def sentence(verdict: str, findings: Sequence[Mapping[str, Any]], reference: bool = False) -> str:
    """Return the answer in a sentence; reference: it says what has changed since reference recordings."""
    if verdict == "nothing_missing" and reference:
        return "Nothing has changed by more than noise, or than reference recordings differ among themselves."
    if verdict == "nothing_missing":
        return "Nothing is missing: the model explains these recordings to within their noise."
    if verdict == "bad_data":
        return "These recordings cannot be used: nothing was concluded from them."
    named = [f for f in findings if f["effect"] != "unknown"]
    unknown = sorted({j for f in findings if f["effect"] == "unknown" for j in f["joints"]})
    full = _FIRST if len(named) > _FEW else _FEW
    parts = [
        f"{title(f['effect'])}{_held(f)} on {joints_text(f['joints'])}{_numbers(f['parameters'])}"
        for f in named[:full]
    ]
    rest = dict[str, set[int]]()
    for f in named[full:]:
        rest.setdefault(f["effect"], set()).update(f["joints"])
    parts += [f"{title(effect)} on {joints_text(sorted(joints))}" for effect, joints in rest.items()]
    if unknown:
        parts.append(f"{title('unknown')} on {joints_text(unknown)}")
    return "Missing from the model: " + "; and ".join(parts) + "."


def _held(finding: Mapping[str, Any]) -> str:
    count = len(finding.get("intervals", ())) if finding["effect"] == "payload" else 0
    return f", held in {count} stretch{'es' * (count > 1)} of time," if count else ""


def _numbers(parameters: Mapping[str, Quantity]) -> str:
    shown = []
    for name, x in list(parameters.items())[:2]:
        if isinstance(x["value"], float):
            spread = "" if x["std"] is None else f" ± {x['std']:.2g}"
            unit = "" if x["unit"] == "1" else f" {x['unit']}"
            shown.append(f"{name} {x['value']:.3g}{spread}{unit}")
    return f" ({', '.join(shown)})" if shown else ""
