"""`residuum monitor`: the observer's view of a running robot, in the terminal or in the browser."""

import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING

import click
from rich.console import Console
from rich.live import Live
from rich.table import Table

from .observe import load_observer

if TYPE_CHECKING:
    from ..driver import Browser, Reading

DEFAULT = Path(__file__).parents[1] / "generated" / "ur5e_dof6"
REFRESH = 0.1  # s between pictures; every package goes through the observer whatever it is
BAR = 24  # characters


@click.command(epilog="Example: residuum monitor --host 192.168.1.10 --model generated/ur5e_dof6")
@click.option("--host", required=True, help="The robot's address, or a virtual one's.")
@click.option(
    "--model", type=click.Path(path_type=Path), help="A model.toml, or a folder that gen-model wrote.  [ur5e]"
)
@click.option("--seconds", type=click.FloatRange(min=0, min_open=True), help="End by itself after this.")
@click.option("--browser", is_flag=True, help="Show it in the browser, on this computer only.")
@click.option("--port", type=click.IntRange(0, 65535), help="Of the page; 0 takes a free one.  [8070]")
def monitor(host: str, model: Path | None, seconds: float | None, browser: bool, port: int | None) -> None:
    """Show external torque, thresholds, temperatures and detections live; Ctrl-C ends.

    Without a terminal one line a second is printed.
    """
    from ..driver import BROWSER_PORT, Browser, Monitor

    if port is not None and not browser:
        raise click.UsageError("--port is the page's; it needs --browser")
    observer = load_observer(model or DEFAULT)
    page = Browser(host, int(observer.DOF), BROWSER_PORT if port is None else port) if browser else None
    served: AbstractContextManager[object] = page or nullcontext()
    reading = None
    with served:
        readings = Monitor(host, observer).readings()
        if page:
            click.echo(f"{page.address} (this computer only); Ctrl-C ends")
        try:
            with _view(page) as (every, show):
                for reading, due in _paced(readings, seconds, every):
                    if due:
                        show(reading)
        except KeyboardInterrupt:
            pass
    if reading is not None:
        click.echo(
            f"{reading.packages} packages, {reading.lost} lost, {int(reading.detections.sum())} detection(s)"
        )


@contextmanager
def _view(page: "Browser | None") -> Iterator[tuple[float, Callable[["Reading"], None]]]:
    """Open a view and yield the s between its pictures and what shows one."""
    console = Console()
    if page:
        yield 0.0, page.show
    elif console.is_terminal:
        with Live(console=console, auto_refresh=False) as live:
            yield REFRESH, lambda reading: live.update(_picture(reading), refresh=True)
    else:
        yield 1.0, lambda reading: click.echo(_line(reading))


def _paced(
    readings: Iterator["Reading"], seconds: float | None, every: float
) -> Iterator[tuple["Reading", bool]]:
    """Yield the readings of so many s, and whether to show each: one in `every` s, and the last."""
    first, shown = None, 0.0
    for reading in readings:
        first = reading.time if first is None else first
        over = seconds is not None and reading.time - first >= seconds
        due = over or time.monotonic() - shown >= every
        shown = time.monotonic() if due else shown
        yield reading, due
        if over:
            return


def _line(reading: "Reading") -> str:
    torque = " ".join(f"{x:8.3f}" for x in reading.external)
    flag = f"  over: {', '.join(map(str, _over(reading)))}" if reading.over.any() else ""
    return f"{reading.time:10.3f} s  external torque, Nm: {torque}{flag}"


def _over(reading: "Reading") -> list[int]:
    return [i for i, over in enumerate(reading.over, start=1) if over]


def _picture(reading: "Reading") -> Table:
    latest = f", latest at {reading.latest:.3f} s" if reading.latest is not None else ""
    table = Table(title=f"{reading.time:.2f} s   {int(reading.detections.sum())} detections{latest}")
    for name in ("joint", "angle, deg", "external, Nm", "threshold, Nm", "", "deg C", "detections"):
        table.add_column(name, justify="left" if not name else "right")
    for i in range(len(reading.q)):
        part = abs(reading.external[i]) / reading.threshold[i] if reading.threshold[i] > 0 else 0.0
        bar = "#" * min(round(BAR * part), BAR)
        style = "bold red" if reading.over[i] else "yellow" if part > 0.7 else None
        table.add_row(
            str(i + 1),
            f"{reading.q[i] * 57.29578:.2f}",
            f"{reading.external[i]:.2f}",
            f"{reading.threshold[i]:.1f}",
            f"{bar:<{BAR}}",
            f"{reading.temperature[i]:.1f}",
            str(reading.detections[i]),
            style=style,
        )
    return table
