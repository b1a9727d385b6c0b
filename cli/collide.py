"""`residuum collide`: the thesis' collision experiments on the virtual arm, and on recordings."""

import os
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ..errors import InputError
from .files import write_tree
from .run import Stages, stages

if TYPE_CHECKING:
    from ..collisions.campaign import Row
    from ..collisions.free_hour import Quiet
    from ..collisions.in_script import Guarded
    from ..collisions.models import Known
    from ..robots import Robot


@click.command(epilog="Example: residuum collide --out collisions --beyond --hour 60")
@click.option("--out", type=click.Path(path_type=Path), help="Folder for tables, runs and report.")
@click.option("--robot", default="ur5e", show_default=True, help="Built-in, of six joints, or a .toml.")
@click.option(
    "--model",
    default="refined",
    show_default=True,
    help="What the detector knows: rigid, plain, refined (all fitted here), or a model.toml.",
)
@click.option("--detector", default="thesis", show_default=True, help="Who triggers the reaction.")
@click.option(
    "--gain",
    type=click.FloatRange(1, 200),
    default=10.0,
    show_default=True,
    help="Observer gain of the thesis' detector, 1/s.",
)
@click.option("--repeats", type=click.IntRange(1, 100), help="Runs of each cell.  [default: 5]")
@click.option(
    "--obstacle",
    type=click.Choice(["foam", "soft", "clamped"]),
    default="foam",
    show_default=True,
    help="Of the campaign; soft: foam of a tenth of the stiffness.",
)
@click.option("--quick", is_flag=True, help="One run of each cell.")
@click.option("--beyond", is_flag=True, help="Six joints, clamped, loaded, cold, hot; all detectors.")
@click.option("--guard", is_flag=True, help="Also run the generated URScript guard in closed loop.")
@click.option(
    "--hour",
    type=click.IntRange(0, 600),
    default=0,
    metavar="MINUTES",
    help="Free motion to watch.",
)
@click.option("--workers", type=click.IntRange(1, 64), help="Processes.  [default: cores, 2 at most]")
@click.option(
    "--recordings",
    multiple=True,
    type=click.Path(path_type=Path, exists=True),
    metavar="REC",
    help="Real recordings, or a folder of them, instead; repeatable.",
)
def collide(
    out: Path | None,
    robot: str,
    model: str,
    detector: str,
    gain: float,
    repeats: int | None,
    obstacle: str,
    quick: bool,
    beyond: bool,
    guard: bool,
    hour: int,
    workers: int | None,
    recordings: tuple[Path, ...],
) -> None:
    """Let the virtual arm collide, and say how soon it was detected and what the robot did.

    The campaign is that of Gylling 2019: joints 1 to 3, slow and fast, three reactions, five runs each,
    into foam. Written are runs.csv, tables.md, report.html and the fitted models; minutes of collision-free
    motion are kept in a folder and not simulated again.

    --recordings: real ones of one joint with a contact sensor (contact_sensor_counts), and free ones.
    """
    if recordings:
        _recorded(recordings, out)
        return
    if out is None:
        raise InputError("--out is missing: name a folder for tables and report")
    from ..collisions.detectors import DETECTORS

    if detector not in DETECTORS:
        raise InputError(f"--detector {detector}: give one of {', '.join(DETECTORS)}")
    from ..robots import load_robot

    data, digest = load_robot(robot)
    if len(data.joint) != 6:
        raise InputError(f"--robot {robot}: the experiments need six joints, it has {len(data.joint)}")
    count = repeats or (1 if quick else 5)
    processes = workers or min(os.cpu_count() or 1, 2)
    work = _Work(data, digest, out, model, detector, gain, obstacle, processes)
    work.run(count, beyond, guard, hour)


class _Work:
    """The stages of a campaign."""

    def __init__(
        self,
        robot: "Robot",
        digest: str,
        out: Path,
        model: str,
        detector: str,
        gain: float,
        obstacle: str,
        workers: int,
    ) -> None:
        self.robot, self.digest, self.out = robot, digest, out
        self.model, self.detector, self.gain = model, detector, gain
        self.obstacle, self.workers = obstacle, workers

    def run(self, repeats: int, beyond: bool, guard: bool, minutes: int) -> None:
        """Do all of it and write."""
        from ..codegen.generate import model_toml
        from ..collisions import campaign, cells, report
        from ..collisions.models import eyes
        from ..collisions.page import page
        from ..collisions.tables import runs_csv, verdict

        with stages(4 + 2 * beyond + guard + (minutes > 0)) as bar:
            known = self._known(bar)
            seen = eyes(known[0], self.gain)
            thesis = cells.thesis_cells(repeats, self.obstacle)
            tasks = campaign.thesis_runs(self.robot, thesis, seen, self.detector)
            found = campaign.spread(tasks, self.workers, _told(bar, "the thesis' campaign"))
            once = campaign.at_thesis_delays(self.robot, cells.thesis_cells(1, self.obstacle))
            late = [row for row, _ in campaign.spread(once, self.workers, _told(bar, "with its delays"))]
            guarded = self._guarded(bar, known[0]) if guard else []
            further = self._beyond(bar, known) if beyond else []
            hours = self._hours(bar, known, minutes) if minutes else {}
            bar.begin("writing")
            rows = [row for row, _ in found]
            traces = {
                (row.cell.joint, row.cell.pace, row.strategy): trace
                for row, trace in found
                if row.cell.seed == 0
            }
            text = report.text(
                self.robot, known, self.detector, self.gain, rows, late, guarded, further, hours
            )
            files = {f"{k.name}.toml": model_toml(k.model) for k in known}
            files |= {
                "runs.csv": runs_csv([*rows, *late, *(row for row, _ in guarded), *further]),
                "tables.md": text,
                "report.html": page(text, rows, traces),
            }
            write_tree(self.out, files)
        click.echo(verdict(rows).rstrip())
        click.echo(f"{self.out}: {', '.join(files)}")

    def _known(self, bar: Stages) -> "list[Known]":
        """Return the model of the campaign."""
        from ..collisions.models import MODELS, calibrate, supplied
        from ..robots.model import Model
        from ..robots.toml import read

        bar.begin("fitting to free motion")
        if self.model in MODELS:
            return [calibrate(self.robot, self.digest, self.model)]
        if not self.model.endswith(".toml"):
            raise InputError(f"--model {self.model}: give one of {', '.join(MODELS)}, or a model.toml")
        given, _ = read(Model, Path(self.model))
        if given.dof != 6:
            raise InputError(f"--model {self.model}: has {given.dof} joints; the experiments need six")
        rigid = calibrate(self.robot, self.digest, "rigid")
        return [supplied(given, rigid.current)]

    def _guarded(self, bar: Stages, known: "Known") -> "list[tuple[Row, Guarded]]":
        from ..collisions import campaign, cells
        from ..collisions.in_script import guard_run

        chosen = [(c, s) for c in cells.thesis_cells(1, self.obstacle) for s in (1, 2, 3)]
        tasks = [partial(guard_run, self.robot, c, s, known.model) for c, s in chosen]
        runs = campaign.spread(tasks, self.workers, _told(bar, "the guard in URScript"))
        nothing = float("nan")
        return [
            (campaign.Row(c, s, "guard-speed", known.name, run.figures, nothing), run)
            for (c, s), run in zip(chosen, runs, strict=True)
        ]

    def _beyond(self, bar: Stages, known: "list[Known]") -> "list[Row]":
        from ..collisions import campaign, cells
        from ..collisions.models import calibrate, eyes

        conditions = ("warm", "payload", "cold", "hot")
        wanted = [(k, "warm") for k in ("plain", "rigid")]
        wanted += [("refined", c) for c in ("payload", "cold")]
        fits = [partial(calibrate, self.robot, self.digest, *w) for w in wanted]
        fitted = campaign.spread(fits, self.workers, _told(bar, "fitting in other states"))
        known += fitted
        base = dict.fromkeys(conditions, (known[0], *fitted[:2]))
        base["payload"] += (fitted[2],)
        base["cold"] += (fitted[3],)
        base["hot"] += (fitted[3],)
        seen = {c: tuple(eyes(k, self.gain) for k in ks) for c, ks in base.items()}
        todo = cells.further_cells((1, 2, 3, 4, 5, 6), conditions)
        tasks = [partial(campaign.beyond, self.robot, c, seen[c.condition]) for c in todo]
        return [row for rows in campaign.spread(tasks, self.workers, _told(bar, "beyond")) for row in rows]

    def _hours(self, bar: Stages, known: "list[Known]", minutes: int) -> "dict[tuple[str, str], Quiet]":
        from ..collisions.free_hour import hour
        from ..collisions.models import eyes

        folder = self.out / "free_motion"
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(f"--out {self.out}: cannot be written: {error.strerror}") from None
        seen = tuple(eyes(k, self.gain) for k in known[:1])
        return hour(self.robot, seen, minutes, folder, self.workers, _told(bar, "free motion"))


def _told(bar: Stages, what: str) -> "_Counter":
    return _Counter(bar, what)


class _Counter:
    """Names a stage with its count."""

    def __init__(self, bar: Stages, what: str) -> None:
        self._bar, self._what = bar, what
        bar.begin(what)

    def __call__(self, done: int, of: int) -> None:
        """Say how many of how many are done."""
        self._bar.rename(f"{self._what} {done}/{of}")


def _recorded(paths: tuple[Path, ...], out: Path | None) -> None:
    from ..collisions.recorded import evaluate, table

    files = [f for p in paths for f in (sorted(p.glob("*.csv")) if p.is_dir() else [p])]
    text = table(evaluate(files))
    if out is not None:
        write_tree(out, {"recordings.md": text})
    click.echo(text.rstrip())
