"""One answer beside its truth: right, right in its class, wrong, abstained or missed."""

from dataclasses import dataclass
from typing import Any, Literal

from .families import NO_NAME, ON_A_JOINT, family
from .parameters import errors

Outcome = Literal["right", "right_in_class", "wrong", "abstained", "missed", "clean", "named"]
SIZES = (0.2, 0.35, 0.5, 1.0)  # the last one: and more
EDGES = (0.2646, 0.4183, 0.7071)  # geometric means between them


@dataclass(frozen=True)
class Verdict:
    """What one case came to.

    outcome: of the first name when something of the catalogue was hidden; else clean, abstained or named.
    wrong: any name that nothing hidden has. joints: whether the right name sits where it should (None: not
    scored). found: how many of the hidden effects were named. errors: relative, by parameter. size, visible:
    effect rms over residual rms, of all of it and of what the baseline of such a case leaves. confidence: of
    the first name.
    """

    case: str
    kind: str
    robot: str
    reference: bool
    rate: int
    effects: tuple[str, ...]
    size: float
    visible: float
    outcome: Outcome
    first: str
    wrong: bool
    joints: bool | None
    found: int
    errors: dict[str, float]
    confidence: float | None = None
    seconds: float | None = None
    failure: str = ""

    @property
    def bin(self) -> float:
        """The nominal size that the case counts for."""
        return nominal(self.size)

    @property
    def right(self) -> bool:
        """Whether the first name is that of something hidden."""
        return self.outcome == "right"


def nominal(size: float) -> float:
    """Return the nominal size that a size counts for."""
    return SIZES[sum(size >= edge for edge in EDGES)]


def judge(truth: dict[str, Any], answer: dict[str, Any], seconds: float | None = None) -> Verdict:
    """Return the verdict on one answer (the content of findings.json) beside the sealed truth."""
    findings = answer.get("findings", [])
    named = [f for f in findings if f["effect"] not in NO_NAME]
    hidden = truth["effects"] if truth["kind"] == "catalogue" else []
    wrong = any(not _is_right(f, hidden) and not _in_class(f, hidden) for f in named)
    outcome = _outcome(named, findings, hidden, truth["kind"])
    first = named[0] if named else (findings[0] if findings else None)
    match = _match(named[0], hidden) if named else None
    return Verdict(
        case=truth["case"],
        kind=truth["kind"],
        robot=truth["robot"],
        reference=truth["reference"],
        rate=truth["rate"],
        effects=tuple(e["effect"] for e in truth["effects"]),
        size=max((e["size"] for e in truth["effects"]), default=0.0),
        visible=_visible(truth),
        outcome=outcome,
        first=first["effect"] if first else "nothing",
        wrong=wrong,
        joints=_joints(named[0], match) if match else None,
        found=sum(any(_is_right(f, [e]) for f in named) for e in hidden),
        errors=errors(match, named[0]) if match else {},
        confidence=named[0]["confidence"] if named else None,
        seconds=seconds,
        failure=answer.get("error", ""),
    )


def _visible(truth: dict[str, Any]) -> float:
    """Return the size that is left beside what is fitted anyway: without a reference, Coulomb and viscous."""
    shares = truth["beside_friction"] if not truth["reference"] else [1.0] * len(truth["ratio"])
    return float(max((r * s for r, s in zip(truth["ratio"], shares, strict=False)), default=0.0))


def _outcome(
    named: list[dict[str, Any]], findings: list[dict[str, Any]], hidden: list[dict[str, Any]], kind: str
) -> Outcome:
    if kind != "catalogue":
        return "named" if named else ("abstained" if findings else "clean")
    if not named:
        return "abstained" if findings else "missed"
    if _is_right(named[0], hidden):
        return "right"
    return "right_in_class" if _in_class(named[0], hidden) else "wrong"


def _is_right(finding: dict[str, Any], hidden: list[dict[str, Any]]) -> bool:
    return family(finding["effect"]) in {family(e["effect"]) for e in hidden}


def _in_class(finding: dict[str, Any], hidden: list[dict[str, Any]]) -> bool:
    """Return whether a finding could not be told from what is hidden, or is what comes along with it."""
    names = {family(name) for name in finding.get("indistinguishable_from", [])}
    along = {family(name) for e in hidden for name in e.get("also", [])}
    return bool(names & {family(e["effect"]) for e in hidden}) or family(finding["effect"]) in along


def _match(finding: dict[str, Any], hidden: list[dict[str, Any]]) -> dict[str, Any] | None:
    """Return the hidden effect that a finding is right about; of the exact name if there is one."""
    same = [e for e in hidden if family(e["effect"]) == family(finding["effect"])]
    return next((e for e in same if e["effect"] == finding["effect"]), same[0] if same else None)


def _joints(finding: dict[str, Any], truth: dict[str, Any]) -> bool | None:
    if truth["effect"] not in ON_A_JOINT:
        return None
    return sorted(finding["joints"]) == sorted(truth["joints"])
