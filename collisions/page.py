"""The report as one self-contained HTML file: force, speed and external torque, delays, impulses."""

from collections.abc import Mapping, Sequence
from html import escape

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from .campaign import Row
from .published import DELAY, IMPULSE, PACES, STOP_TIME
from .run import Trace

COLOURS = {1: "#c0392b", 2: "#0b6bcb", 3: "#1e8449"}
GREY = "#9aa5b1"
#: s before and after the contact that are drawn.
BEFORE, BEYOND = 0.2, 1.0
_STYLE = (
    "body{font-family:system-ui,sans-serif;max-width:1100px;margin:2em auto;padding:0 1em}"
    "table{border-collapse:collapse;font-size:14px;margin:1em 0}td,th{border:1px solid #ccc;padding:3px 8px;"
    "text-align:right}pre{white-space:pre-wrap}"
)


def page(text: str, rows: Sequence[Row], traces: Mapping[tuple[int, str, int], Trace]) -> str:
    """Return the page. text: the Markdown of the tables; traces: one of each (joint, pace, strategy)."""
    figures = [*(runs_figure(traces, pace) for pace in PACES), bars(rows)]
    drawn = [
        f.to_html(full_html=False, include_plotlyjs="inline" if k == 0 else False)
        for k, f in enumerate(figures)
    ]
    return (
        "<!doctype html><html lang='en'><head><meta charset='utf-8'><title>residuum collide</title>"
        f"<style>{_STYLE}</style></head><body>{html(text)}{''.join(drawn)}</body></html>\n"
    )


def runs_figure(traces: Mapping[tuple[int, str, int], Trace], pace: str) -> go.Figure:
    """Draw contact force and joint speed around the contact, a column a joint, a colour a strategy."""
    joints = sorted({j for j, p, _ in traces if p == pace}) or [1]
    titles = [f"joint {j}" for j in joints]
    figure = make_subplots(2, len(joints), shared_xaxes=True, subplot_titles=titles, vertical_spacing=0.06)
    for (joint, of, strategy), trace in traces.items():
        if of != pace:
            continue
        since = trace.time - trace.onset
        shown = (since >= -BEFORE) & (since <= BEYOND)
        speed = trace.fields["actual_qd"][:, joint - 1]
        column = joints.index(joint) + 1
        for line, values in ((1, trace.force), (2, speed)):
            figure.add_scatter(
                x=1e3 * since[shown],
                y=values[shown],
                name=f"S{strategy}",
                legendgroup=str(strategy),
                showlegend=line == 1 and column == 1,
                line={"color": COLOURS[strategy], "width": 1.5},
                row=line,
                col=column,
            )
        if trace.alarm is not None and strategy == 1:
            at = 1e3 * (trace.alarm.time - trace.onset)
            figure.add_vline(x=at, line={"color": GREY, "dash": "dot"}, row="all", col=column)
    figure.update_yaxes(title_text="contact force, N", row=1, col=1)
    figure.update_yaxes(title_text="joint speed, rad/s", row=2, col=1)
    figure.update_xaxes(title_text="ms after contact", row=2)
    figure.update_layout(title=f"One run of each cell, {pace}; dotted: detection", height=560)
    return figure


def bars(rows: Sequence[Row]) -> go.Figure:
    """Draw delay, impulse and stop time, ours beside the thesis'."""
    labels = [f"J{j} {p}" for p in PACES for j in (1, 2, 3)]
    keys = [(j, p) for p in PACES for j in (1, 2, 3)]
    figure = make_subplots(
        1, 3, subplot_titles=["detection delay, ms", "impulse (strategy 2), Ns", "stop time (strategy 2), ms"]
    )
    theirs = [[DELAY[k] for k in keys], [IMPULSE[k][1] for k in keys], [STOP_TIME[k][1] for k in keys]]
    for column, published in enumerate(theirs, start=1):
        ours = [_mean(rows, k, column) for k in keys]
        for name, values, colour in (("ours", ours, COLOURS[2]), ("Gylling 2019", published, GREY)):
            figure.add_bar(
                x=labels, y=values, name=name, marker_color=colour, legendgroup=name,
                showlegend=column == 1, row=1, col=column,
            )  # fmt: skip
    figure.update_layout(title="Beside the thesis", height=380, barmode="group")
    return figure


def _mean(rows: Sequence[Row], key: tuple[int, str], column: int) -> float | None:
    here = [row for row in rows if (row.cell.joint, row.cell.pace) == key]
    if column == 1:
        values = [1e3 * row.figures.delay for row in here]
    else:
        second = [row.figures for row in here if row.strategy == 2]
        values = [x.impulse if column == 2 else 1e3 * x.stop_time for x in second]
    good = [v for v in values if not np.isnan(v)]
    return float(np.mean(good)) if good else None


def html(text: str) -> str:
    """Return the Markdown that `tables` writes as HTML: headings, tables, paragraphs."""
    parts = []
    for block in text.strip().split("\n\n"):
        lines = block.strip().split("\n")
        if lines[0].startswith("#"):
            level = len(lines[0]) - len(lines[0].lstrip("#"))
            parts.append(f"<h{level}>{escape(lines.pop(0).lstrip('# '))}</h{level}>")
        if lines and lines[0].startswith("|"):
            parts.append(_table(lines))
        elif lines:
            parts.append(f"<p>{escape(' '.join(lines)).replace('**', '')}</p>")
    return "\n".join(parts)


def _table(lines: Sequence[str]) -> str:
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
    head = "".join(f"<th>{escape(x)}</th>" for x in rows[0])
    body = "".join(
        "<tr>" + "".join(f"<td>{escape(x.replace('**', ''))}</td>" for x in row) + "</tr>" for row in rows[2:]
    )
    return f"<table><tr>{head}</tr>{body}</table>"
