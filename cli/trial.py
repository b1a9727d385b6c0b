"""`residuum trial`: concealed cases, answered without their labels, and the score."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from ..errors import InputError

if TYPE_CHECKING:
    from ..trials.answering import CaseFiles
    from ..trials.pool import Report

STAGES = ("generate", "answer", "score")


@click.command(epilog="Example: residuum trial --cases 200 --seed 7 --out trial --workers 2")
@click.option("--cases", required=True, type=click.IntRange(1, 100_000), help="How many cases.")
@click.option("--seed", required=True, type=click.IntRange(0), help="Of everything random.")
@click.option("--out", required=True, type=click.Path(path_type=Path, file_okay=False), help="Folder.")
@click.option("--workers", type=click.IntRange(1, 256), default=1, show_default=True, help="Processes.")
@click.option(
    "--seconds",
    nargs=2,
    type=click.FloatRange(10.0, 3600.0),
    default=(30.0, 60.0),
    show_default=True,
    help="Shortest and longest recording.",
)
@click.option(
    "--stage",
    "chosen",
    multiple=True,
    type=click.Choice(STAGES),
    help="Only this stage; repeatable.  [default: all]",
)
def trial(
    cases: int, seed: int, out: Path, workers: int, seconds: tuple[float, float], chosen: tuple[str, ...]
) -> None:
    """Hide effects in a virtual robot, explain its recordings without the labels, reveal and score.

    OUT/cases holds recordings, OUT/sealed the truths (their hashes stand in OUT/seal.txt before the first
    answer), OUT/answers what explain found; OUT/score.md, score.json and cases.csv the score. Run it again
    to go on where it stopped.
    """
    from ..trials.stages import Trial, answer_stage, generate_stage, score_stage
    from ..trials.tables import report

    if seconds[0] > seconds[1]:
        raise InputError(f"--seconds {seconds[0]:g} {seconds[1]:g}: give the shorter one first")
    wanted = chosen or STAGES
    if "generate" in wanted:
        with counting("simulating cases") as show:
            generate_stage(out, Trial(cases, seed, seconds), workers, show)
    if "answer" in wanted:
        with counting("answering") as show:
            answer_stage(out, explain_case, workers, show)
    if "score" in wanted:
        click.echo(report(score_stage(out)))


def explain_case(files: "CaseFiles") -> dict[str, Any]:
    """Return what `residuum explain` finds in one case's files."""
    from ..mismatch import Task, explain
    from ..robots import load_robot

    robot, digest = load_robot(files.robot)
    task = Task(
        recordings=files.recordings,
        reference=files.reference,
        robot=robot,
        robot_hash=digest,
        dof=len(robot.joint),
        propose=False,
        thresholds=False,
    )
    return dict(explain(task).findings)


@contextmanager
def counting(what: str) -> Iterator["Report"]:
    """Show a bar that counts on stderr, on a terminal only."""
    console = Console(stderr=True)
    columns = (TextColumn(what), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task("", total=None)
        yield lambda done, of: progress.update(task, completed=done, total=of)
