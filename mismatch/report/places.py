"""Where it is: the residual of each joint that matters over time, and along what locates it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..result import Explanation, Region, Trace
from .figures import Figure, region_figure, time_figure
from .variables import in_time, words
from .wording import capital, intervals_text, percent, span

#: Joints shown at once; the others are folded away, with fewer points.
JOINTS, FOLDED_POINTS = 3, 1000
#: Regions plotted a joint.
REGIONS = 1
#: What findings name that adds nothing to the model.
NOT_PHYSICS = ("unknown", "data_fault")


@dataclass(frozen=True)
class Place:
    """A joint and the figures that show what is unexplained there."""

    joint: int
    figures: tuple[Figure, ...]


def named(e: Explanation) -> bool:
    """Return whether any physics was named, so that there is an after."""
    return any(f["effect"] not in NOT_PHYSICS for f in e.findings["findings"])


def places(e: Explanation) -> tuple[list[Place], list[Place]]:
    """Return the joints that matter most, and the others that have traces."""
    joints = [j for j in _order(e) if any(t.joint == j for t in e.traces)]
    first = [j for j in joints if _matters(e, j)][:JOINTS]
    shown = [_place(e, j, True) for j in first]
    return shown, [_place(e, j, False) for j in joints if j not in first]


def region_words(region: Region) -> str:
    """Return in words along which variable a joint's unexplained torque sits, and where on it."""
    share = percent(region.share)
    if in_time(region.variable):
        file = f" in {region.recording}" if region.recording else ""
        times = f", at {intervals_text(region.intervals)}{file}" if region.intervals else ""
        return f"{capital(share)} of what is unexplained comes and goes{times}."
    where = ""
    if np.isfinite([region.low, region.high]).all():
        where = f", mostly {span(region.low, region.high, region.unit)}"
    return f"{capital(share)} of what is unexplained goes with the {words(region.variable)}{where}."


def _order(e: Explanation) -> list[int]:
    """Return all joints, those with the largest share of findings first, then of regions, then the rest."""
    shares = dict.fromkeys(range(1, e.model.dof + 1), 0.0)
    for f in e.findings["findings"]:
        for j in f["joints"]:
            shares[j] = max(shares.get(j, 0.0), 1.0 + f["share"].get(str(j), 0.0))
    for r in e.regions:
        shares[r.joint] = max(shares.get(r.joint, 0.0), min(r.share, 1.0))
    return sorted(shares, key=lambda j: (-shares[j], j))


def _matters(e: Explanation, joint: int) -> bool:
    found = [j for f in e.findings["findings"] for j in f["joints"]]
    return joint in found or any(r.joint == joint for r in e.regions)


def _place(e: Explanation, joint: int, large: bool) -> Place:
    traces = [t for t in e.traces if t.joint == joint]
    regions = sorted((r for r in e.regions if r.joint == joint), key=lambda r: -r.share)
    trace = _telling(traces, regions)
    points = {} if large else {"most": FOLDED_POINTS}
    intervals = _intervals(e, trace, regions)
    marks = " ".join(region_words(r) for r in regions if in_time(r.variable) and r.intervals)
    marks = marks or ("Shaded: the longest stretches where it shows." if intervals else "")
    figures = [time_figure(trace, intervals, marks, named(e), **points)]
    for region in regions if large else ():
        drawn = region_figure(traces, region, region_words(region), e.curves.get(joint), named(e))
        figures += [drawn] if drawn and len(figures) <= REGIONS else []
    return Place(joint, tuple(figures))


def _telling(traces: Sequence[Trace], regions: Sequence[Region]) -> Trace:
    """Return the recording that a region points at, or the one with the largest residual."""
    marked = {r.recording for r in regions if r.intervals}
    some = [t for t in traces if t.recording in marked] or list(traces)

    def size(t: Trace) -> float:
        good = t.before[np.isfinite(t.before)]
        return float(np.mean(good**2)) if len(good) else 0.0

    return max(some, key=size)


def _intervals(e: Explanation, trace: Trace, regions: Sequence[Region]) -> list[tuple[float, float]]:
    """Return the stretches of time (s) to mark in a trace: the regions', else those of the findings."""
    own = [i for r in regions if r.recording in (None, trace.recording) for i in r.intervals]
    if not own and not any(r.intervals for r in regions):
        found = [f for f in e.findings["findings"] if trace.joint in f["joints"]]
        own = [(float(a), float(b)) for f in found for a, b in f.get("intervals", [])]
    if not len(trace.time):
        return []
    first, last = float(trace.time[0]), float(trace.time[-1])
    inside = [(max(a, first), min(b, last)) for a, b in own]
    return sorted({(a, b) for a, b in inside if a <= b})
