"""An amplifier's dead band looks like friction's level where torque always turns round with the motion."""

from .evidence import Evidence
from .judging import Judged
from .naming import APART, worth
from .plausibility import curve_over
from .sharpen import without


def hidden_amplifiers(weighed: Evidence, judged: Judged) -> tuple[str, ...]:
    """Say on which joints a level of friction was named that the amplifier's dead band explains as well.

    weighed: by what the names leave. On a wrist, which carries little, that is the rule.
    """
    found = list[str]()
    for k, a in enumerate(judged.accepted):
        c = a.score.candidate
        if c.effect != "coulomb_friction" or c.joint is None:
            continue
        model, drive = without(judged, k), curve_over(weighed, "drive sign", c.joint)
        if worth(weighed, model, drive) > worth(weighed, model, c) - APART:
            found.append(
                f"whether joint {c.joint + 1}'s friction changed or its amplifier's dead band: its "
                "torque turns round with its motion (brake harder, or carry a load)"
            )
    return tuple(found)
