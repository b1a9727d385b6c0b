"""`residuum explain`: where recordings and model differ, what physics is missing, and the proof."""

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ..errors import InputError
from .files import write_tree
from .options import ROBOTS
from .run import stages

if TYPE_CHECKING:
    from ..mismatch import Explanation


class _ManyReferences(click.Command):
    """A command whose --reference takes all the names that follow it, up to the next option."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        spread, inside = list[str](), False
        for arg in args:
            if arg == "--reference":
                inside = True
            elif arg.startswith("-"):
                inside = False
                spread.append(arg)
            else:
                spread += ["--reference", arg] if inside else [arg]
        return super().parse_args(ctx, spread)


@click.command(
    cls=_ManyReferences,
    epilog="Example: residuum explain run*.csv --reference healthy*.csv --robot ur5e --out answer",
)
@click.argument("recordings", nargs=-1, required=True, type=click.Path(path_type=Path), metavar="REC...")
@click.option(
    "--reference",
    "references",
    multiple=True,
    type=click.Path(path_type=Path),
    help="Recordings of the healthy robot: all names that follow, up to the next option.",
)
@click.option("--robot", help=f"{ROBOTS}  [default: ur5e]")
@click.option("--model", type=click.Path(path_type=Path), help="A model.toml instead of the published robot.")
@click.option("--dof", type=click.IntRange(1, 6), help="Moving joints; the rest is rigid.  [default: all]")
@click.option("--out", required=True, type=click.Path(path_type=Path, file_okay=False), help="Folder.")
def explain(
    recordings: tuple[Path, ...],
    references: tuple[Path, ...],
    robot: str | None,
    model: Path | None,
    dof: int | None,
    out: Path,
) -> None:
    """Say what physics a model lacks, where, and prove it on data that the fit did not see.

    Without --reference: what the published rigid body with Coulomb and viscous friction lacks. With it: what
    has changed since the reference was recorded. OUT gets findings.json, model.toml and report.html.
    """
    from ..codegen.generate import model_toml
    from ..mismatch import Task
    from ..mismatch import explain as explained
    from ..mismatch.report.page import report
    from ..robots import load_robot
    from ..robots.model import Model
    from ..robots.toml import read

    if robot and model:
        raise InputError("--robot and --model exclude each other: the model says which robot it is")
    known = read(Model, model)[0] if model else None
    data, digest = load_robot(known.robot if known else robot or "ur5e")
    count = known.dof if known else dof or len(data.joint)
    if known and dof and dof != known.dof:
        raise InputError(f"--dof {dof}: {model} has {known.dof} joints; leave --dof out")
    with stages(15) as bar:
        answer = explained(Task(recordings, references, data, digest, count, known), bar.begin)
        bar.begin("writing")
        files = {
            "findings.json": json.dumps(answer.findings, indent=1, ensure_ascii=False, allow_nan=False)
            + "\n",
            "model.toml": model_toml(answer.model),
            "report.html": report(answer),
        }
        if answer.next_motion is not None and answer.next_motion.script:
            files |= {"next_motion.script": answer.next_motion.script, "next_motion.csv": _waypoints(answer)}
        write_tree(out, files)
    click.echo(answer.sentence)
    for text in answer.cannot:
        click.echo(f"not shown by these recordings: {text}")
    click.echo(f"{out}: {', '.join(files)}")


def _waypoints(answer: "Explanation") -> str:
    motion = answer.next_motion
    assert motion is not None
    header = ",".join(f"q_{k}" for k in range(motion.waypoints.shape[1]))
    return "\n".join([header, *(",".join(f"{x:.6f}" for x in row) for row in motion.waypoints)]) + "\n"
