"""`residuum monitor`: the observer's view of a running robot, in the terminal."""

import time
from pathlib import Path
from typing import TYPE_CHECKING

import click
from rich.console import Console
from rich.live import Live
from rich.table import Table

from .observe import load_observer

if TYPE_CHECKING:
    from ..driver import Reading

DEFAULT = Path(__file__).parents[1] / "generated" / "ur5e_dof6"
REFRESH = 0.1  # s between pictures; every package goes through the observer whatever it is
BAR = 24  # characters


@click.command(epilog="Example: residuum monitor --host 192.168.1.10 --model generated/ur5e_dof6")
@click.option("--host", required=True, help="The robot's address, or a virtual one's.")
@click.option(
    "--model", type=click.Path(path_type=Path), help="A model.toml, or a folder that gen-model wrote.  [ur5e]"
)
@click.option("--seconds", type=click.FloatRange(min=0, min_open=True), help="End by itself after this.")
def monitor(host: str, model: Path | None, seconds: float | None) -> None:
    """Show external torque, thresholds, temperatures and detections live; Ctrl-C ends.

    Without a terminal one line a second is printed.
    """
    from ..driver import Monitor

    readings = Monitor(host, load_observer(model or DEFAULT)).readings()
    console = Console()
    first, shown = None, 0.0
    live = Live(console=console, auto_refresh=False) if console.is_terminal else None
    every = REFRESH if live else 1.0
    reading = None
    try:
        if live:
            live.start()
        for reading in readings:
            first = reading.time if first is None else first
            over = seconds is not None and reading.time - first >= seconds
            if over or time.monotonic() - shown >= every:
                shown = time.monotonic()
                live.update(_picture(reading), refresh=True) if live else click.echo(_line(reading))
            if over:
                break
    except KeyboardInterrupt:
        pass
    finally:
        if live:
            live.stop()
    if reading is not None:
        click.echo(
            f"{reading.packages} packages, {reading.lost} lost, {int(reading.detections.sum())} detection(s)"
        )


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
