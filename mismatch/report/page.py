"""The report: one HTML page that holds everything it shows. Values in, text out; nothing is written here."""

import json
from collections.abc import Mapping
from functools import cache
from typing import Any

from jinja2 import Environment
from markupsafe import Markup
from plotly.offline import get_plotlyjs

from ...templates import renderer
from ..result import Explanation
from . import wording as w
from .figures import Figure, error_figure, threshold_figure
from .places import named, places, region_words
from .sections import (
    advice,
    by_joint,
    detection,
    facts,
    finding_rows,
    next_motion,
    reached,
    ruled_out,
    sources,
)

#: What a verdict is called, and the tone of its colour in the style sheet.
VERDICTS: Mapping[str, tuple[str, str]] = {
    "nothing_missing": ("Nothing is missing", "good"),
    "explained": ("Explained", "accent"),
    "partly_explained": ("Partly explained", "partly"),
    "unexplained": ("Not explained", "open"),
    "bad_data": ("Recording unfit", "bad"),
}


#: Letters from which on a sentence is set smaller, to stay on the first screen of a phone.
LONG = 220


def report(explanation: Explanation) -> str:
    """Return the page (HTML) for an explanation: self-contained, its plots drawn by plotly.js."""
    context = _context(explanation)
    figures = {f.name: f.data for f in context["figures"]}
    return (
        _environment()
        .get_template("report/report.html.jinja")
        .render(**context, figure_data=_json(figures), plotly=Markup(get_plotlyjs()))
    )


@cache
def _environment() -> Environment:
    return renderer(
        {
            "capital": w.capital,
            "number": w.number,
            "percent": w.percent,
            "listed": w.listed,
            "duration": w.duration,
        },
        html=True,
    )


def _context(e: Explanation) -> dict[str, Any]:
    verdict = str(e.findings["verdict"])
    shown, rest = places(e)
    proof = _proof(e)
    figures: list[Figure] = [f for p in (*shown, *rest) for f in p.figures]
    figures += [f for f in (proof["error"], proof["threshold"]) if f is not None]
    captions = " ".join(f.caption for f in figures)
    return {
        "robot": e.robot,
        "sentence": e.sentence,
        "long": len(e.sentence) > LONG,
        "verdict": verdict,
        "verdict_text": VERDICTS[verdict][0],
        "tone": VERDICTS[verdict][1],
        "facts": facts(e),
        "findings": finding_rows(e),
        "places": shown,
        "other_places": rest,
        "elsewhere": [(r.joint, t) for r in e.regions if (t := region_words(r)) not in captions],
        "proof": proof,
        "ruled_out": ruled_out(e),
        "cannot": e.cannot,
        "advice": advice(e),
        "next_motion": next_motion(e),
        "sources": sources(e),
        "scheme": e.findings["fit"]["scheme"],
        "placebo_rate": e.findings["placebo_rate"],
        "figures": figures,
    }


def _proof(e: Explanation) -> dict[str, Any]:
    """Return before and after by joint: rows, figures (None: no numbers), and the ceiling in words."""
    p, found = e.proof, named(e)
    has_error = bool((p.before > 0).any())
    has_threshold = found and bool((p.threshold_before > 0).any())
    return {
        "found": found,
        "error": error_figure(p, found) if has_error else None,
        "threshold": threshold_figure(p) if has_threshold else None,
        "rows": by_joint(p),
        "reached": reached(p) if found else "",
        "detection": detection(p) if has_threshold else "",
        "scheme": p.scheme,
    }


def _json(data: object) -> Markup:
    """Return JSON that can stand inside a script element."""
    text = json.dumps(data, allow_nan=False, separators=(",", ":"))
    return Markup(text.replace("<", r"\u003c"))
