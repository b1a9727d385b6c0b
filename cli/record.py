"""`residuum record`: the robot's own stream as a recording."""

from pathlib import Path
from typing import TYPE_CHECKING

import click
from rich.console import Console
from rich.progress import Progress

from ..errors import InputError
from .files import write_file

if TYPE_CHECKING:
    from ..driver import Recorded


@click.command(epilog="Example: residuum record --host 192.168.1.10 --seconds 60 --out run.csv")
@click.option("--host", required=True, help="The robot's address, or a virtual one's.")
@click.option("--seconds", required=True, type=click.FloatRange(min=0, min_open=True), help="How long.")
@click.option("--out", required=True, type=click.Path(path_type=Path), help="CSV to write.")
@click.option(
    "--rate", default=500.0, show_default=True, type=click.FloatRange(1, 500), help="Samples a second."
)
def record(host: str, seconds: float, out: Path, rate: float) -> None:
    """Record motion, currents and temperatures as the robot sends them.

    Every package of the stream is kept; what is lost or repeated is counted from its timestamps and said.
    Nothing is written when the robot is lost on the way.
    """
    from ..driver import record as read_stream

    if not out.parent.is_dir():
        raise InputError(f"--out {out}: there is no folder {out.parent}")
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("recording", total=None)
        found = read_stream(
            host, seconds, rate, progress=lambda done, total: bar.update(task, completed=done, total=total)
        )
    write_file(out, lambda path: path.write_text(found.csv(), encoding="ascii"))
    click.echo(_line(found, out))


def _line(found: "Recorded", out: Path) -> str:
    rows = len(found.table)
    span = found.table[-1, 0] - found.table[0, 0]
    return (
        f"{out}: {rows} rows at {found.rate:g} Hz, {span:.3f} s of the robot's time, "
        f"{found.lost} lost, {found.repeated} repeated"
    )
