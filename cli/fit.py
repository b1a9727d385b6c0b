"""`residuum fit`: the baseline model of an arm from its recordings."""

from pathlib import Path
from typing import TYPE_CHECKING

import click
import numpy as np

from ..errors import InputError
from .files import check_picture, write_file
from .options import robot_option
from .run import stages

if TYPE_CHECKING:
    from ..identify.baseline import Baseline
    from ..robots import Robot
    from ..robots.model import Model


@click.command(epilog="Example: residuum fit run*.csv --robot ur5e --out ur5e.toml --term stribeck:2,3")
@click.argument("recordings", nargs=-1, required=True, type=click.Path(path_type=Path), metavar="REC...")
@robot_option
@click.option(
    "--dof",
    type=click.IntRange(1, 6),
    help="Moving joints; the rest is rigid.  [default: all of the robot's]",
)
@click.option("--out", required=True, type=click.Path(path_type=Path), help="model.toml to write.")
@click.option(
    "--term",
    "terms",
    multiple=True,
    metavar="NAME[:JOINTS][:P=V]",
    help="A further term of the catalogue, such as load_dependent or stribeck:2,3; repeatable.",
)
@click.option(
    "--form",
    type=click.Choice(["momentum", "inverse-dynamics"]),
    default="momentum",
    show_default=True,
    help="momentum needs no acceleration.",
)
@click.option(
    "--cutoff",
    type=click.FloatRange(0.1, 100),
    default=10.0,
    show_default=True,
    help="Low-pass on both sides, Hz.",
)
@click.option("--causal", is_flag=True, help="Filter once, forwards, instead of with zero phase.")
@click.option(
    "--loaded",
    multiple=True,
    type=click.Path(path_type=Path),
    help="A recording with the known --payload; repeatable. It shows the drive gains.",
)
@click.option(
    "--payload", type=click.FloatRange(min=0, min_open=True), help="Mass in the --loaded recordings, kg."
)
@click.option(
    "--trusted-masses",
    type=click.FloatRange(0.1, 50),
    metavar="PERCENT",
    help="Take the published masses as right to PERCENT and estimate drive gains from them.",
)
@click.option(
    "--false-alarms",
    type=click.FloatRange(min=0, min_open=True),
    default=1.0,
    show_default=True,
    help="Rate per hour and joint for the thresholds; the recordings must be free of contact.",
)
@click.option("--no-thresholds", is_flag=True, help="Fit no thresholds: the recordings hold contacts.")
@click.option(
    "--scheme",
    type=click.Choice(["residuum", "thesis"]),
    default="residuum",
    show_default=True,
    help="thesis: that of Gylling 2019 on joints 1-3, to compare with.",
)
@click.option(
    "--scheduler", metavar="HOST:PORT", help="Run on a Dask cluster.  [default: this machine's cores]"
)
@click.option(
    "--workers",
    type=click.IntRange(1, 256),
    help="Local processes.  [default: cores, 1 for short recordings]",
)
@click.option(
    "--plot", type=click.Path(path_type=Path), help="Picture of held-out errors to write: .png, .svg or .pdf."
)
def fit(
    recordings: tuple[Path, ...],
    robot: str,
    dof: int | None,
    out: Path,
    terms: tuple[str, ...],
    form: str,
    cutoff: float,
    causal: bool,
    loaded: tuple[Path, ...],
    payload: float | None,
    trusted_masses: float | None,
    false_alarms: float,
    no_thresholds: bool,
    scheme: str,
    scheduler: str | None,
    workers: int | None,
    plot: Path | None,
) -> None:
    """Fit rigid body, rotors and friction to recordings; write a model with its uncertainty.

    Fitted are the base parameters (published values are the prior where the motion does not show them),
    rotor inertia, Coulomb and viscous friction and an offset, and every --term. The table says what the
    model explains of recordings that it has not seen.
    """
    from ..identify.baseline import Options
    from ..identify.requests import parse_request
    from ..identify.workflow import Task, run
    from ..robots import load_robot

    check_picture(plot)
    if bool(loaded) != (payload is not None):
        raise InputError(
            "--loaded and --payload go together: the recordings with the load, and its mass in kg"
        )
    data, digest = load_robot(robot)
    count = len(data.joint) if dof is None else dof
    options = Options(tuple(parse_request(t, count) for t in terms), form, cutoff, 4, not causal)  # type: ignore[arg-type]
    if scheme == "thesis":
        _thesis(recordings, data, digest, out)
        return
    with stages(6) as bar:
        task = Task(
            recordings,
            data,
            digest,
            count,
            options,
            loaded,
            payload,
            trusted_masses,
            None if no_thresholds else false_alarms,
            scheduler,
            workers,
        )
        found, model = run(task, bar.begin)
        bar.begin("writing")
        _write(out, model)
        if plot:
            write_file(plot, lambda path: draw(path, found), "--plot")
    for placed in found.placed:
        for text in placed.dropped:
            click.echo(f"{placed.source.name}: {text}")
    click.echo(table(found, model))


def _write(out: Path, model: "Model") -> None:
    from ..codegen.generate import model_toml

    write_file(out, lambda path: path.write_text(model_toml(model), encoding="utf-8", newline="\n"))


def _thesis(recordings: tuple[Path, ...], robot: "Robot", digest: str, out: Path) -> None:
    from ..identify.thesis import fit_thesis
    from ..identify.thesis import table as thesis_table

    with stages(2) as bar:
        bar.begin("fitting the thesis' scheme")
        found = fit_thesis(recordings, robot, digest)
        bar.begin("writing")
        _write(out, found.model)
    click.echo(thesis_table(found))


def table(found: "Baseline", model: "Model") -> str:
    """Return parameters with uncertainty, then errors by joint, as text."""
    return "\n".join([*_parameter_lines(found, model), "", *_error_lines(found, model)])


def _parameter_lines(found: "Baseline", model: "Model") -> list[str]:
    lines = [f"{'parameter':24}{'value':>12}{'std':>10}  unit"]
    for name, x in model.base.items():
        lines.append(
            f"{name:24}{x.value:12.4g}{x.std:10.2g}  {x.unit:14}"
            f"{'' if x.source.startswith('identified') else 'prior'}"
        )
    units = _units()
    for term in model.term:
        for name, value in term.parameters.items():
            if name in term.std:
                label = f"joint {term.joint} {term.name} {name}"
                note = "" if term.source == "identified" else term.source
                lines.append(
                    f"{label:24}{value:12.4g}{term.std[name]:10.2g}  {units[term.name, name]:14}{note}"
                )
    for i, joint in enumerate(model.joint, start=1):
        if joint.drive_gain_std is not None:
            lines.append(
                f"{f'joint {i} drive gain':24}{joint.drive_gain:12.4g}{joint.drive_gain_std:10.2g}  Nm/A"
            )
    return [line.rstrip() for line in lines]


def _units() -> dict[tuple[str, str], str]:
    from ..symbolic.terms import CATALOGUE

    return {(t.name, n): p.unit for t in CATALOGUE.values() for n, p in t.parameters.items()}


def _error_lines(found: "Baseline", model: "Model") -> list[str]:
    n = model.dof
    record = model.fit
    assert record is not None
    numbers = [
        ("left out: error, %", found.held_out.percent(), ".2f"),
        ("left out: rms, Nm", found.held_out.rms(), ".3f"),
        ("  with rests, %", found.held_out.percent("all"), ".2f"),
        ("residual memory, s", np.array(record.residual_memory), ".2f"),
    ]
    if model.thresholds:
        numbers.append(("threshold, Nm", np.array(model.thresholds.static), ".2f"))
        numbers.append(("  + per rad/s, Nm", np.array(model.thresholds.per_speed), ".2f"))
    lines = [f"{'joint':24}" + "".join(f"{i:>9}" for i in range(1, n + 1))]
    lines += [f"{label:24}" + "".join(f"{x:>9{form}}" for x in row) for label, row, form in numbers]
    lines.append(
        f"error norm over torque norm where the arm moves, {record.left_out} left out ({record.folds} folds)"
    )
    lines.append(
        f"{record.directions} of {record.parameters} parameter combinations shown by the motion;"
        f" {record.gains}"
    )
    if model.thresholds:
        lines.append(
            f"thresholds: {model.thresholds.false_alarms_per_hour:g} false alarms an hour and joint;"
            f" {model.thresholds.source}"
        )
    return [*lines, *record.notes]


def draw(path: Path, found: "Baseline") -> None:
    """Draw held-out error by joint and recording."""
    from matplotlib.figure import Figure

    percent = 100 * np.sqrt(found.held_out.scored / np.maximum(found.held_out.torque, 1e-300))  # (folds, N)
    folds, n = percent.shape
    figure = Figure(figsize=(1.5 + 1.4 * n, 4), layout="constrained")
    axis = figure.subplots()
    for i in range(n):
        axis.plot(i + 1 + np.linspace(-0.25, 0.25, folds), percent[:, i], "o", ms=4, color="#9aa5b1")
    axis.plot(range(1, n + 1), found.held_out.percent(), "_", ms=34, mew=2.5, color="#0b6bcb")
    for i, value in enumerate(found.held_out.percent(), start=1):
        axis.annotate(
            f"{value:.1f} %", (i, value), (0, 6), textcoords="offset points", ha="center", fontsize=9
        )
    axis.set(xlabel="joint", ylabel="error norm / torque norm, %", ylim=(0, None), xticks=range(1, n + 1))
    axis.set_title(f"{folds} left out one at a time (dots), all together (bars)", loc="left", fontsize=10)
    axis.grid(axis="y", alpha=0.3)
    figure.savefig(path, dpi=130)
