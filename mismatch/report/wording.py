"""Findings in words: numbers with their errors, joints, names and equations as a reader wants them."""

import math
import re
from collections.abc import Iterable, Sequence

from latex2mathml.converter import convert
from markupsafe import Markup

from ...symbolic.effects import EFFECTS

#: What findings name that is no physics.
_NO_PHYSICS = {
    "data_fault": "the recording itself is at fault",
    "unknown": "something that the catalogue does not hold",
}
#: A space at which no line is broken.
NARROW = "\u202f"
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_OF_JOINT = re.compile(r"^joint_?(?P<before>[1-6])_|_(?:joint_?)?(?P<after>[1-6])$")
#: LaTeX between equations that stand side by side.
_BETWEEN = re.compile(r"([;,])\\(?:quad|qquad|\s)\s*")


def title(effect: str) -> str:
    """Return an effect's plain name, without a capital."""
    if effect in EFFECTS:
        return EFFECTS[effect].title
    return _NO_PHYSICS.get(effect, effect.replace("_", " "))


def capital(text: str) -> str:
    """Return a text with its first letter as a capital, unless it begins with a name: actual_q_2, run.csv."""
    first = text.partition(" ")[0].rstrip(".:;,")
    return text if {"_", "."} & set(first) else text[:1].upper() + text[1:]


def listed(items: Iterable[object], last: str = "and") -> str:
    """Return 'a, b and c'."""
    texts = [str(x) for x in items]
    if len(texts) < 2:
        return "".join(texts)
    return f"{', '.join(texts[:-1])} {last} {texts[-1]}"


def joints_text(joints: Sequence[int], dof: int = 6) -> str:
    """Return 'joint 2', 'joints 2 and 3', 'all joints'; joints count from 1."""
    if not joints:
        return "no joint"
    if len(joints) == dof > 1:
        return "all joints"
    return f"joint{'s' * (len(joints) > 1)} {listed(sorted(joints))}"


def percent(share: float) -> str:
    """Return a share in whole percent, without calling 99.7 % everything or 0.2 % nothing."""
    if not math.isfinite(share):
        return "–"
    if 0 < share < 0.01:
        return f"below 1{NARROW}%"
    if 0.99 < share < 1:
        return f"over 99{NARROW}%"
    return f"{100 * share:.0f}{NARROW}%".replace("-", "−")


def number(x: float, digits: int = 3) -> str:
    """Return a number with so many significant digits, written out where it is neither huge nor tiny."""
    if not math.isfinite(x):
        return "–"
    if x == 0:
        return "0"
    power = math.floor(math.log10(abs(x)))
    if -4 <= power < 6:
        return _fixed(x, max(digits - 1 - power, 0))
    return f"{_fixed(x / 10**power, digits - 1)} × 10{_raised(power)}"


def plain(x: float) -> str:
    """Return a number with at most three significant digits and no zeros behind them."""
    return f"{x:.3g}".replace("-", "−") if math.isfinite(x) and 1e-4 <= abs(x) < 1e6 else number(x)


def with_error(value: float, std: float | None, unit: str = "1") -> str:
    """Return 'value ± std unit': the standard deviation with two digits, the value to the same place."""
    if std is None or not math.isfinite(std) or std <= 0:
        text = number(value)
    else:
        power = math.floor(math.log10(max(abs(value), std)))
        scale = power if not -4 <= power < 6 else 0
        places = max(1 - math.floor(math.log10(std / 10.0**scale)), 0)
        text = f"{_fixed(value / 10.0**scale, places)}{NARROW}±{NARROW}{_fixed(std / 10.0**scale, places)}"
        text = f"({text}) × 10{_raised(scale)}" if scale else text
    return f"{text}{NARROW}{unit_text(unit)}".strip() + _degrees(value, unit)


def quantity(value: float | Sequence[float], std: float | Sequence[float | None] | None, unit: str) -> str:
    """Return a parameter, a number or a vector, with its error and unit."""
    if isinstance(value, int | float):
        return with_error(value, std if isinstance(std, int | float) else None, unit)
    each = list(std) if isinstance(std, Sequence) else [std] * len(value)
    texts = [with_error(v, s) for v, s in zip(value, each, strict=True)]
    return f"({', '.join(texts)}) {unit_text(unit)}".strip()


def unit_text(unit: str) -> str:
    """Return a unit as it is printed: kg m^2 becomes kg m², 1 becomes nothing."""
    if unit == "1":
        return ""
    return re.sub(r"\^(-?\d+)", lambda m: _raised(m[1]), unit).replace("deg C", "°C")


def span(low: float, high: float, unit: str = "1") -> str:
    """Return 'from low to high unit'."""
    return f"from {plain(low)} to {plain(high)}{NARROW}{unit_text(unit)}".strip()


def intervals_text(intervals: Sequence[Sequence[float]], most: int = 6) -> str:
    """Return stretches of time, in s, in words; the first few of many."""
    texts = [f"{_fixed(a, 1)}–{_fixed(b, 1)} s" for a, b in intervals[:most]]
    more = len(intervals) - most
    return listed([*texts, f"{more} more"] if more > 0 else texts)


def duration(seconds: float) -> str:
    """Return a length of time in s, min or h."""
    if seconds < 120:
        return f"{plain(seconds)}{NARROW}s"
    long = seconds >= 7200
    return f"{plain(seconds / 3600)}{NARROW}h" if long else f"{plain(seconds / 60)}{NARROW}min"


def parameter_name(effect: str, name: str) -> str:
    """Return what a parameter means: mu_2 of load_dependent_friction is a meaning and its joint."""
    known = EFFECTS[effect].parameters if effect in EFFECTS else {}
    found = _OF_JOINT.search(name)
    joint = "" if found is None or name in known else f", joint {found['before'] or found['after']}"
    bare = _OF_JOINT.sub("", name) if joint else name
    if bare not in known:
        return capital(bare.replace("_", " ")) + joint
    symbol = f" {bare}" if len(bare) < 4 else ""
    return capital(known[bare].meaning) + symbol + joint


def mathml(latex: str) -> list[Markup]:
    """Return equations that stand side by side in LaTeX as MathML blocks; text where it cannot be read."""
    return [_block(part) for part in _parts(latex) if part.strip()]


def _block(latex: str) -> Markup:
    try:
        return Markup(convert(latex, display="block"))
    except Exception:  # its errors share no base class, and an equation is no reason to have no page
        return Markup("<code>{}</code>").format(latex)


def _parts(latex: str) -> list[str]:
    """Split at separators outside of any bracket."""
    parts, depth, begin = list[str](), 0, 0
    for found in re.finditer(r"\\left|\\right|[{}()\[\]]|" + _BETWEEN.pattern, latex):
        text = found[0]
        if text in ("{", "(", "["):
            depth += 1
        elif text in ("}", ")", "]"):
            depth -= 1
        elif found[1] and depth == 0:
            parts.append(latex[begin : found.start()])
            begin = found.end()
    return [*parts, latex[begin:]]


def _degrees(value: float, unit: str) -> str:
    return f" ({number(math.degrees(value), 2)}°)" if unit == "rad" else ""


def _fixed(x: float, places: int) -> str:
    return f"{x:.{places}f}".replace("-", "−")


def _raised(power: int | str) -> str:
    return str(power).translate(_SUPERSCRIPT)
