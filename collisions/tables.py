"""Tables of what was measured, as Markdown, the thesis' and UR's figures beside ours; and all runs as CSV."""

import csv
import io
from collections.abc import Callable, Iterable, Mapping, Sequence

import numpy as np

from .campaign import Row
from .free_hour import Quiet
from .published import DELAY, IMPULSE, MEAN_DELAY, PACES, STOP_TIME, UR_DELAY, UR_MEAN_DELAY

Cells = Sequence[Sequence[str]]
NUMBERS = {"slow": ("5", "6"), "fast": ("7", "8")}


def runs_csv(rows: Iterable[Row]) -> str:
    """Return all runs as CSV: SI units, one line a run; what could not be measured is empty."""
    flat = [row.flat() for row in rows]
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(flat[0])
    writer.writerows([_plain(x) for x in row.values()] for row in flat)
    return text.getvalue()


def _plain(value: object) -> object:
    if isinstance(value, float):
        return "" if np.isnan(value) else f"{value:.6g}"
    return int(value) if isinstance(value, bool) else value


def markdown(header: Sequence[str], cells: Cells) -> str:
    """Return a table."""
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join([*lines, *("| " + " | ".join(row) + " |" for row in cells)]) + "\n"


def mean(rows: Iterable[Row], of: Callable[[Row], float]) -> float:
    """Return the mean of what could be measured, NaN when nothing could."""
    values = np.array([of(row) for row in rows], dtype=float)
    values = values[~np.isnan(values)]
    return float(values.mean()) if len(values) else float("nan")


def show(value: float, form: str = ".0f") -> str:
    """Return a number, or a dash when there is none."""
    return "-" if np.isnan(value) else f"{value:{form}}"


def thesis_tables(rows: Sequence[Row]) -> str:
    """Return tables 5 to 8 from the campaign: ours, and the thesis' figures in brackets."""
    parts = []
    for pace in PACES:
        here = [row for row in rows if row.cell.pace == pace]
        joints = sorted({row.cell.joint for row in here})
        absolute, relative = NUMBERS[pace]
        parts.append(f"### As table {absolute}: {pace}\n")
        parts.append(_absolute(here, joints, pace))
        parts.append(f"### As table {relative}: {pace}, share of the sum over strategies, %\n")
        parts.append(_relative(here, joints, pace))
    return "\n".join(parts)


def _absolute(rows: Sequence[Row], joints: Sequence[int], pace: str) -> str:
    header = ["joint", *(f"impulse S{s}, Ns" for s in (1, 2, 3)), *(f"stop S{s}, ms" for s in (1, 2, 3)),
              "delay, ms", "UR least / most, ms"]  # fmt: skip
    cells = []
    for j in joints:
        mine, key = [row for row in rows if row.cell.joint == j], (j, pace)
        by = [[row for row in mine if row.strategy == s] for s in (1, 2, 3)]
        line = [str(j)]
        line += [f"{show(mean(x, _impulse), '.2f')} ({t:.2f})" for x, t in zip(by, IMPULSE[key], strict=True)]
        line += [f"{show(mean(x, _stop))} ({t})" for x, t in zip(by, STOP_TIME[key], strict=True)]
        line += [f"{show(mean(mine, _delay))} ({DELAY[key]})", "{} / {}".format(*UR_DELAY[key])]
        cells.append(line)
    average = f"**{show(mean(rows, _delay), '.1f')}** ({MEAN_DELAY[pace]})"
    least, most = UR_MEAN_DELAY[pace]
    cells.append(["mean", *[""] * 6, average, f"{least} / {most}"])
    return markdown(header, cells)


def _relative(rows: Sequence[Row], joints: Sequence[int], pace: str) -> str:
    header = ["joint", *(f"impulse S{s}" for s in (1, 2, 3)), *(f"stop S{s}" for s in (1, 2, 3))]
    cells = []
    for j in joints:
        line = [str(j)]
        for of, published in ((_impulse, IMPULSE), (_stop, STOP_TIME)):
            ours = np.array(
                [mean([r for r in rows if r.cell.joint == j and r.strategy == s], of) for s in (1, 2, 3)]
            )
            theirs = np.array(published[j, pace])
            pairs = zip(100 * ours / ours.sum(), 100 * theirs / theirs.sum(), strict=True)
            line += [f"{show(a, '.1f')} ({b:.1f})" for a, b in pairs]
        cells.append(line)
    return markdown(header, cells)


def ordering(rows: Sequence[Row]) -> str:
    """Say which strategy has the smallest impulse and the shortest stop, cell by cell."""
    cells = []
    for pace in PACES:
        for j in sorted({row.cell.joint for row in rows}):
            best = []
            for of in (_impulse, _stop):
                here = [row for row in rows if (row.cell.joint, row.cell.pace) == (j, pace)]
                means = {s: mean([r for r in here if r.strategy == s], of) for s in (1, 2, 3)}
                order = sorted(means, key=lambda s: np.inf if np.isnan(means[s]) else means[s])
                best.append(" < ".join(f"S{s}" for s in order))
            thesis = [
                " < ".join(f"S{s + 1}" for s in np.argsort(published[j, pace]))
                for published in (IMPULSE, STOP_TIME)
            ]
            cells.append([f"{j} {pace}", best[0], thesis[0], best[1], thesis[1]])
    return markdown(["joint", "impulse", "in the thesis", "stop time", "in the thesis"], cells)


def verdict(rows: Sequence[Row]) -> str:
    """Say what became of the runs: how many detected in time, early, never; and the delay against half."""
    late = [row for row in rows if not np.isnan(row.figures.delay)]
    early = sum(row.figures.early for row in rows)
    lines = [
        f"{len(rows)} runs: {len(late)} detected after contact, {early} alarms before it,"
        f" {len(rows) - len(late) - early} without detection."
    ]
    for pace, theirs in MEAN_DELAY.items():
        ours = mean([row for row in rows if row.cell.pace == pace], _delay)
        word = "at most" if ours <= 0.5 * theirs else "more than"
        lines.append(f"Mean delay {pace}: {show(ours, '.1f')} ms, {word} half the thesis' {theirs} ms.")
    return "\n".join(lines) + "\n"


def beyond_table(rows: Sequence[Row]) -> str:
    """Return a line for each obstacle, condition, model and detector: means over joints and paces."""
    header = ["obstacle", "robot", "knows", "detector", "detected", "early", "missed", "delay slow, ms",
              "delay fast, ms", "peak slow, N", "peak fast, N"]  # fmt: skip
    groups: dict[tuple[str, str, str, str], list[Row]] = {}
    for row in rows:
        key = row.cell.obstacle, row.cell.condition, row.model or "-", row.detector
        groups.setdefault(key, []).append(row)
    cells = []
    for key, group in groups.items():
        found = sum(not np.isnan(row.figures.delay) for row in group)
        early = sum(row.figures.early for row in group)
        paces = [[row for row in group if row.cell.pace == pace] for pace in PACES]
        numbers = [show(mean(x, of)) for of in (_delay, _peak) for x in paces]
        cells.append([*key, str(found), str(early), str(len(group) - found - early), *numbers])
    return markdown(header, cells)


def hour_table(found: Mapping[tuple[str, str], Quiet]) -> str:
    """Return false alarms per hour, by motion, model and detector."""
    header = ["motion", "knows", "detector", "hours", "false alarms", "per hour", "largest score"]
    cells = []
    for (motion, model), quiet in found.items():
        for name, count in quiet.alarms.items():
            rate = count / quiet.hours
            cells.append([motion, model, name, f"{quiet.hours:.2f}", str(count), f"{rate:.3g}",
                          f"{quiet.peak[name]:.2f}"])  # fmt: skip
    return markdown(header, cells)


def _impulse(row: Row) -> float:
    return row.figures.impulse


def _stop(row: Row) -> float:
    return 1e3 * row.figures.stop_time


def _delay(row: Row) -> float:
    return 1e3 * row.figures.delay


def _peak(row: Row) -> float:
    return row.figures.peak
