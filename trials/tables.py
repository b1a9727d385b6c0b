"""score.md: the score as tables."""

from typing import Any

from .shares import Share

COLUMNS = {
    "right": "right", "right_in_class": "in class", "wrong_first": "wrong first",
    "any_wrong": "any wrong name", "abstained": "abstained", "missed": "missed", "joints": "joints right",
}  # fmt: skip
TITLES = {
    "all": "All",
    "size": "By size (effect rms / residual rms)",
    "size_with_reference": "By size, with reference",
    "size_without_reference": "By size, without reference",
    "visible": "By visible size (without reference: what Coulomb and viscous friction leave of the effect)",
    "reference": "By reference",
    "rate": "By rate, Hz",
    "robot": "By robot",
    "hidden_at_once": "By number of hidden effects",
    "effect": "By effect (hidden alone)",
}


def report(score: dict[str, Any]) -> str:
    """Return the score as Markdown. Shares read "97 % (58/60; 89-99)": count, n, Wilson's 95 % interval."""
    parts = [
        "# Score of concealed trials\n",
        f"{score['cases']} cases. Shares: count/n and Wilson's 95 % interval.\n",
        _table("Half the residual or more", {">= 0.5": score["half_or_more"]}),
        *(_table(TITLES[g], rows) for g, rows in score["catalogue"].items()),
        f"Both of two found: {_share(score['both_found'])}\n",
        _nothing("Clean robots", score["clean"]),
        _nothing("Outside the catalogue", score["outside"]),
        _parameters(score["parameters"]),
        _confidence(score["confidence"]),
        _confusion(score["confusion"]),
        _seconds(score["seconds"]),
        _failures(score["failures"]),
    ]
    return "\n".join(part for part in parts if part)


def compare(scores: dict[str, dict[str, Any]]) -> str:
    """Return several answerers' scores on the same cases as one table, one line each."""
    head = ["answers", "right, >= 0.5", "right, 0.35", "right, 0.2", "any wrong name", "joints right"]
    head += ["clean named", "outside named", "median parameter error", "s a case"]
    lines = [_line(head), _line(["---"] * len(head))]
    for name, s in scores.items():
        sizes, median = s["catalogue"]["size"], s["parameters"]["all"]["median"]
        every = s["catalogue"]["all"]["all"]
        shares = [
            s["half_or_more"]["right"],
            sizes["0.35"]["right"],
            sizes["0.2"]["right"],
            every["any_wrong"],
        ]
        shares += [every["joints"], s["clean"]["all"]["named"], s["outside"]["all"]["named"]]
        error = "-" if median is None else f"{100 * median:.0f} %"
        seconds = f"{s['seconds']['median']:.0f}" if s["seconds"] else "-"
        lines.append(_line([name, *map(_share, shares), error, seconds]))
    return "\n".join(lines) + "\n"


def _table(title: str, rows: dict[str, dict[str, Any]]) -> str:
    lines = [f"## {title}\n", _line(["", *COLUMNS.values()]), _line(["---"] * (1 + len(COLUMNS)))]
    lines += [_line([name, *(_share(row[c]) for c in COLUMNS)]) for name, row in rows.items()]
    return "\n".join(lines) + "\n"


def _nothing(title: str, rows: dict[str, dict[str, Any]]) -> str:
    lines = [f"## {title}\n", _line(["reference", "a name (wrong)", "unknown"]), _line(["---"] * 3)]
    lines += [_line([name, _share(row["named"]), _share(row["unknown"])]) for name, row in rows.items()]
    return "\n".join(lines) + "\n"


def _parameters(parameters: dict[str, Any]) -> str:
    lines = ["## Parameters of right names\n", _line(["parameter", "n", "median relative error"])]
    lines.append(_line(["---"] * 3))
    for name, row in [*parameters["by_name"].items(), ("all", parameters["all"])]:
        error = "-" if row["median"] is None else f"{100 * row['median']:.1f} %"
        lines.append(_line([name, str(row["n"]), error]))
    return "\n".join(lines) + "\n"


def _confidence(rows: dict[str, dict[str, Any]]) -> str:
    lines = ["## Confidence of the first name\n", _line(["confidence", "right"]), _line(["---"] * 2)]
    lines += [_line([name, _share(row)]) for name, row in rows.items()]
    return "\n".join(lines) + "\n"


def _confusion(confusion: dict[str, dict[str, int]]) -> str:
    lines = ["## Truth and first answer\n", _line(["truth", "answers"]), _line(["---"] * 2)]
    for truth, answers in confusion.items():
        lines.append(_line([truth, ", ".join(f"{name} {count}" for name, count in answers.items())]))
    return "\n".join(lines) + "\n"


def _seconds(seconds: dict[str, float]) -> str:
    if not seconds:
        return ""
    return f"Time to answer: median {seconds['median']:.1f} s, largest {seconds['largest']:.1f} s\n"


def _failures(failures: dict[str, str]) -> str:
    if not failures:
        return ""
    return (
        "\n".join(["## Answers that failed\n", *(f"- {case}: {why}" for case, why in failures.items())])
        + "\n"
    )


def _share(data: dict[str, Any]) -> str:
    return Share(data["count"], data["n"]).text()


def _line(cells: list[str]) -> str:
    return "| " + " | ".join(cells) + " |"
