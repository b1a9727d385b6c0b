"""The page's plots as data for plotly.js: dictionaries of traces and layout, colours by the page's names.

A colour such as --accent is a name that the page's style sheet gives a value, for light, dark and print.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..result import Proof, Region, Trace
from .variables import by_direction, label, readings

Array = NDArray[np.float64]
Plot = dict[str, Any]

#: Points of a line and of a cloud at most: what a plot of a thousand pixels can show.
LINE_POINTS, CLOUD_POINTS = 3000, 1500


@dataclass(frozen=True)
class Figure:
    """A plot: its place in the page, what it shows in words, and plotly's traces and layout."""

    name: str
    alt: str
    caption: str
    traces: tuple[Plot, ...]
    layout: Plot

    @property
    def data(self) -> Plot:
        """Return what plotly.js is given."""
        return {"data": list(self.traces), "layout": self.layout}


def thin_line(y: Array, most: int = LINE_POINTS) -> NDArray[np.int64]:
    """Return indices of at most `most` samples of y (n,): the least and the greatest of each stretch."""
    good = np.flatnonzero(np.isfinite(y))
    if len(good) <= most:
        return good
    edges = np.linspace(0, len(good), most // 2 + 1).astype(np.int64)
    keep = set[int]()
    for a, b in pairwise(edges):
        part = y[good[a:b]]
        keep |= {int(good[a + np.argmin(part)]), int(good[a + np.argmax(part)])}
    return np.array(sorted(keep), np.int64)


def thin_cloud(x: Array, y: Array, most: int = CLOUD_POINTS) -> NDArray[np.int64]:
    """Return indices of at most `most` points (n,): evenly spaced ones, and the outermost of both axes."""
    good = np.flatnonzero(np.isfinite(x) & np.isfinite(y))
    if len(good) <= most:
        return good
    even = good[np.linspace(0, len(good) - 1, most - 4).astype(np.int64)]
    outer = [good[f(v[good])] for v in (x, y) for f in (np.argmin, np.argmax)]
    return np.unique(np.concatenate([even, np.array(outer, np.int64)]))


def time_figure(
    trace: Trace, intervals: Sequence[Sequence[float]], caption: str, found: bool, most: int = LINE_POINTS
) -> Figure:
    """Return residuals of a joint over time, before and after, with stretches of time (s) marked.

    found: whether anything was added to the model; without, there is no after. caption: said after the
    recording's name.
    """
    lines = [_line(trace.time, trace.before, "before" if found else "model as it is", "--muted", most)]
    if found:
        lines.append(_line(trace.time, trace.after, "after", "--accent", most))
    layout = _layout("time / s", "unexplained torque / Nm")
    layout["shapes"] = [_marked(a, b) for a, b in intervals]
    layout["hovermode"] = "x"
    marks = f" {len(intervals)} stretches of time are marked." if intervals else ""
    after = f", with the findings {_rms(trace.after):.3g} Nm" if found else ""
    alt = (
        f"Unexplained torque of joint {trace.joint} over time in {trace.recording}: "
        f"rms {_rms(trace.before):.3g} Nm{after}.{marks}"
    )
    caption = f"Over time, in {trace.recording}. {caption}".strip()
    return Figure(f"time-{trace.joint}", alt, caption, tuple(lines), layout)


def region_figure(
    traces: Sequence[Trace],
    region: Region,
    caption: str,
    curve: tuple[str, Array, Array] | None = None,
    found: bool = True,
) -> Figure | None:
    """Return residuals against what locates them, with the fitted effect or the flexible curve over it.

    None where the variable is not among what traces hold, such as time.
    """
    parts = [readings(t, region.variable) for t in traces if t.joint == region.joint]
    some = [p for p in parts if p is not None and len(p.x)]
    if not some:
        return None
    x, before, effect = (np.concatenate([getattr(p, n) for p in some]) for n in ("x", "before", "effect"))
    clouds = [_cloud(x, before, "unexplained", "--muted", 0.45)]
    if found:
        clouds.append(_cloud(x, effect, "findings", "--accent", 0.9))
    if curve is not None and curve[0] == region.variable:
        clouds.append(_curve(curve[1], curve[2]))
    layout = _layout(label(region.variable), "unexplained torque / Nm")
    if by_direction(region.variable):
        layout["yaxis"]["title"]["text"] = "torque along motion / Nm"
    if np.isfinite([region.low, region.high]).all():
        layout["shapes"] = [_marked(region.low, region.high)]
    alt = f"Unexplained torque of joint {region.joint} against {label(region.variable)}. {caption}"
    return Figure(f"region-{region.joint}-{_slug(region.variable)}", alt, caption, tuple(clouds), layout)


def error_figure(proof: Proof, found: bool) -> Figure:
    """Return bars of the left-out error by joint, with 95 % intervals and the flexible ceiling."""
    bars = [_bars(proof.before, "before" if found else "model as it is", "--muted")]
    if found:
        bars.append(_bars(proof.after, "after, 95 %", "--accent", proof.interval))
    joints = np.arange(1, len(proof.before) + 1)
    ends = np.stack([joints - 0.42, joints + 0.42, np.full(len(joints), np.nan)], axis=1).ravel()
    line = _line_of(ends, np.repeat(proof.ceiling, 3), "flexible black box", "--ink")
    layout = _by_joint("error on data left out / Nm", len(joints))
    alt = "Error by joint on data that were left out of the fit, before and after; the table has the numbers."
    return Figure("error", alt, "", (*bars, line), layout)


def threshold_figure(proof: Proof) -> Figure:
    """Return bars of the detection threshold by joint, before and after, at the same false-alarm rate."""
    bars = (
        _bars(proof.threshold_before, "before", "--muted"),
        _bars(proof.threshold_after, "after", "--accent"),
    )
    layout = _by_joint("detection threshold / Nm", len(proof.threshold_before))
    alt = "Detection threshold by joint before and after; the table has the numbers."
    return Figure("threshold", alt, "", bars, layout)


def numbers(values: Array) -> list[float | None]:
    """Return numbers for JSON with five digits; what is not finite becomes null."""
    return [float(f"{v:.5g}") if np.isfinite(v) else None for v in values]


def _line(time: Array, y: Array, name: str, colour: str, most: int) -> Plot:
    keep = thin_line(y, most)
    return _line_of(time[keep], y[keep], name, colour)


def _line_of(x: Array, y: Array, name: str, colour: str) -> Plot:
    return {
        "type": "scatter",
        "mode": "lines",
        "name": name,
        "x": numbers(x),
        "y": numbers(y),
        "line": {"color": colour, "width": 1.6 if colour == "--ink" else 1.2},
        "hovertemplate": "%{y:.3g} Nm",
    }


def _cloud(x: Array, y: Array, name: str, colour: str, opacity: float) -> Plot:
    keep = thin_cloud(x, y)
    return {
        "type": "scatter",
        "mode": "markers",
        "name": name,
        "x": numbers(x[keep]),
        "y": numbers(y[keep]),
        "marker": {"color": colour, "size": 3.5, "opacity": opacity},
        "hovertemplate": "%{x:.3g}: %{y:.3g} Nm",
    }


def _curve(grid: Array, value: Array) -> Plot:
    curve = _line_of(grid, value, "flexible curve: not physics", "--ink")
    curve["line"] |= {"dash": "dash", "width": 2}
    return curve


def _bars(values: Array, name: str, colour: str, interval: Array | None = None) -> Plot:
    bars: Plot = {
        "type": "bar",
        "name": name,
        "x": list(range(1, len(values) + 1)),
        "y": numbers(values),
        "marker": {"color": colour},
        "hovertemplate": "joint %{x}: %{y:.3g} Nm",
    }
    if interval is not None:
        bars["error_y"] = {
            "type": "data",
            "symmetric": False,
            "array": numbers(interval[:, 1] - values),
            "arrayminus": numbers(values - interval[:, 0]),
            "color": "--ink",
            "thickness": 1.2,
            "width": 4,
        }
    return bars


def _marked(low: float, high: float) -> Plot:
    return {
        "type": "rect",
        "yref": "paper",
        "x0": float(low),
        "x1": float(high),
        "y0": 0,
        "y1": 1,
        "fillcolor": "--accent",
        "opacity": 0.13,
        "line": {"width": 0},
        "layer": "below",
    }


def _by_joint(y: str, count: int) -> Plot:
    layout = _layout("joint", y)
    layout["xaxis"] |= {"tickvals": list(range(1, count + 1)), "range": [0.4, count + 0.6], "showgrid": False}
    layout["yaxis"] |= {"rangemode": "tozero"}
    layout |= {"barmode": "group", "bargap": 0.35, "bargroupgap": 0.05}
    return layout


def _layout(x: str, y: str) -> Plot:
    axis = {
        "gridcolor": "--grid",
        "zerolinecolor": "--grid",
        "linecolor": "--grid",
        "automargin": True,
    }
    return {
        "xaxis": _titled(axis, x),
        "yaxis": _titled(axis, y),
        "font": {"family": "system-ui, sans-serif", "size": 12, "color": "--soft"},
        "paper_bgcolor": "rgba(0,0,0,0)",
        "plot_bgcolor": "rgba(0,0,0,0)",
        "legend": {"orientation": "h", "x": 0, "y": 1.02, "yanchor": "bottom", "itemsizing": "constant"},
        "modebar": {"bgcolor": "rgba(0,0,0,0)", "color": "--muted", "activecolor": "--accent"},
        "margin": {"l": 8, "r": 8, "t": 8, "b": 8},
        "hoverlabel": {"bgcolor": "--paper", "bordercolor": "--grid", "font": {"color": "--ink"}},
    }


def _titled(axis: Mapping[str, Any], text: str) -> Plot:
    return {**axis, "title": {"text": text, "standoff": 8}}


def _rms(values: Array) -> float:
    good = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(good**2))) if len(good) else float("nan")


def _slug(text: str) -> str:
    return "".join(c if c.isalnum() else "-" for c in text)
