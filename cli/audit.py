"""`residuum audit`: say what is wrong with recordings."""

import json
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np
from rich.console import Console
from rich.progress import Progress

from ..errors import InputError
from ..recordings import Recording, read
from ..recordings.audit import audit as examine
from ..recordings.recording import BoolArray
from ..recordings.report import AuditReport, describe

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PATIENCE = 2.0
MOST_DRAWN = 20_000
_STYLE = {"good": "green", "usable": "yellow", "refuse": "red", "note": "dim", "dropped": "yellow"}

Examined = tuple[Recording, AuditReport]


@click.command(epilog="Example: residuum audit run1.csv run2.csv.gz --plot overview.png")
@click.argument("recordings", nargs=-1, required=True, type=click.Path(path_type=Path), metavar="REC...")
@click.option("--json", "as_json", is_flag=True, help="Write one JSON list to standard output.")
@click.option(
    "--plot", type=click.Path(path_type=Path, dir_okay=False), help="Draw an overview, .png or .pdf."
)
def audit(recordings: tuple[Path, ...], as_json: bool, plot: Path | None) -> None:
    """Say what is wrong with recordings: gaps, jitter, stuck or absurd values, units, missing columns.

    Exit code 0: all are usable, perhaps without some rows. 2: at least one is not.
    """
    results: list[dict[str, Any]] = []
    drawn: list[Examined] = []
    failures: list[str] = []
    for path in recordings:
        try:
            examined = _examine(path)
        except InputError as error:
            failures.append(str(error))
            results.append({"file": str(path), "verdict": "refuse", "error": str(error)})
            continue
        report = examined[1]
        results.append({"file": str(path), **report.as_dict()})
        if plot:
            drawn.append(examined)
        if not as_json:
            _print(report)
        try:
            report.require()
        except InputError as error:
            failures.append(str(error))
    if as_json:
        click.echo(json.dumps(results, indent=1, allow_nan=False))
    try:
        if plot and drawn:
            _plot(drawn, plot)
    except InputError as error:
        failures.append(str(error))
    for line in failures:
        click.echo(line, err=True)
    if failures:
        sys.exit(2)


def _examine(path: Path) -> Examined:
    with _progress(path.name) as advance:
        recording = read(path, progress=advance)
        return recording, examine(recording)


@contextmanager
def _progress(name: str) -> Iterator[Callable[[float], None]]:
    """Show a bar on a terminal once the work has taken two seconds."""
    console = Console(stderr=True)
    start = time.monotonic()
    bar = Progress(console=console, transient=True, disable=not console.is_terminal)
    task = bar.add_task(name, total=1.0)
    shown = False

    def advance(share: float) -> None:
        nonlocal shown
        if not shown and time.monotonic() - start > PATIENCE:
            bar.start()
            shown = True
        bar.update(task, completed=share)

    try:
        yield advance
    finally:
        if shown:
            bar.stop()


def _print(report: AuditReport) -> None:
    console = Console(highlight=False)
    verdict = report.verdict
    numbers = ", ".join(f"{k} {q.value:.4g} {q.unit}" for k, q in report.summary.items())
    kept = f"{report.rows_kept} of {report.rows_read} rows"
    console.print(f"[{_STYLE[verdict]}]{verdict}[/]  ", end="")
    console.print(f"{report.name}  {kept}  {numbers}", markup=False, soft_wrap=True)
    for finding in report.findings:
        remedy = f" -> {finding.remedy}" if finding.remedy else ""
        console.print(f"  [{_STYLE[finding.severity]}]{finding.severity:8}[/]", end="")
        console.print(f"{finding.kind:18}{describe(finding)}{remedy}", markup=False, soft_wrap=True)


def _plot(examined: list[Examined], path: Path) -> None:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7 * len(examined), 8), layout="constrained")
    axes = figure.subplots(3, len(examined), squeeze=False)
    for column, (recording, report) in enumerate(examined):
        _draw(axes[:, column].tolist(), recording, report)
    image = BytesIO()
    try:
        figure.savefig(image, format=path.suffix.lstrip(".") or "png")
        path.write_bytes(image.getvalue())
    except (OSError, ValueError) as error:
        raise InputError(f"--plot {path}: {error}; give a .png in an existing folder") from error


def _draw(axes: "list[Axes]", recording: Recording, report: AuditReport) -> None:
    """Time steps, positions and currents of the rows kept; rows left out are red marks on the time axis."""
    bad = _bad_rows(recording, report)
    good = recording.take(~bad)
    start = good.timestamp[0] if len(good) else 0.0
    lost = recording.timestamp[bad] - start
    thin = slice(None, None, 1 + len(good) // MOST_DRAWN)
    time = good.timestamp[thin] - start
    curves = (1e3 * np.diff(good.timestamp, prepend=np.nan)[thin], good.q[thin], good.current[thin])
    labels = ("time step, ms", "actual_q, rad", "actual_current, A")
    for axis, curve, label in zip(axes, curves, labels, strict=True):
        axis.plot(time, curve, ".", markersize=2)
        axis.set_ylabel(label)
        shown = lost[np.abs(lost) <= 2 * max(good.duration, 1.0)]
        axis.plot(shown, np.zeros_like(shown), "r|", markersize=16, transform=axis.get_xaxis_transform())
    axes[0].set_title(f"{report.name}: {report.verdict}")
    axes[1].legend([f"joint {j + 1}" for j in range(recording.joints)], ncols=3, fontsize="small")
    axes[2].set_xlabel("time, s")


def _bad_rows(recording: Recording, report: AuditReport) -> BoolArray:
    bad = ~np.isfinite(recording.timestamp)
    for finding in report.findings:
        if finding.severity == "dropped":
            for first, last in finding.rows:
                bad |= (recording.rows >= first) & (recording.rows <= last)
    return bad
