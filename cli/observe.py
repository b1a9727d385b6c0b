"""`residuum observe`: run a generated observer over a recording."""

from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import click
import numpy as np

from .files import check_picture, write_file
from .run import stages

if TYPE_CHECKING:
    from ..identify.observation import Observation


@click.command(
    epilog="Example: residuum observe run.csv --model generated/ur5e_dof6 --out r.csv --plot r.png"
)
@click.argument("recording", type=click.Path(path_type=Path), metavar="REC")
@click.option(
    "--model",
    required=True,
    type=click.Path(path_type=Path),
    help="A model.toml, or a folder that gen-model wrote.",
)
@click.option("--out", required=True, type=click.Path(path_type=Path), help="CSV to write.")
@click.option("--plot", type=click.Path(path_type=Path), help="Picture to write: .png, .svg or .pdf.")
@click.option(
    "--gain", type=click.FloatRange(min=0, min_open=True), help="Observer gain, 1/s.  [default: the model's]"
)
def observe(recording: Path, model: Path, out: Path, plot: Path | None, gain: float | None) -> None:
    """Write residual and external torque along a recording.

    residual_i: torque (Nm) that the rigid body does not explain; external_torque_i: the same less the
    model's friction and drive terms. Both are positive along the joint axis. Bad rows are dropped, and
    said.
    """
    from ..identify.observation import observe as run_observer
    from ..identify.observation import wrist_note
    from ..recordings import read
    from ..recordings.audit import clean
    from ..recordings.report import describe

    check_picture(plot)
    with stages(4) as bar:
        bar.begin("generating")
        module = load_observer(model)
        bar.begin("reading")
        good, report = clean(read(recording))
        report.require()
        bar.begin("observing")
        found = run_observer(good, module, gain)
        bar.begin("writing")
        write_file(out, lambda path: _write_csv(path, found))
        if plot:
            write_file(plot, lambda path: draw(path, found, good.name, module), "--plot")
    for finding in report.findings:
        if finding.severity == "dropped":
            click.echo(f"{good.name}: {describe(finding)}")
    if note := wrist_note(good, module):
        click.echo(note)
    click.echo(_table(found, module.DOF))


def load_observer(model: Path) -> ModuleType:
    """Return the generated observer of a folder, or generate it from a model.toml."""
    from ..codegen.generate import observer_text
    from ..codegen.load import load_file, load_text
    from ..robots.model import Model
    from ..robots.toml import read

    if model.is_dir():
        return load_file(model / "observer.py")
    data, _ = read(Model, model)
    return load_text(observer_text(data))


def _write_csv(path: Path, found: "Observation") -> None:
    n = found.residual.shape[1]
    names = [f"{kind}_{i}" for kind in ("residual", "external_torque") for i in range(n)]
    table = np.column_stack([found.timestamp, found.residual, found.external_torque])
    np.savetxt(path, table, fmt="%.9g", delimiter=",", header=",".join(["timestamp", *names]), comments="")


def _table(found: "Observation", n: int) -> str:
    residual, external = found.rms()
    rows = [f"{len(found.timestamp)} samples, gain {found.gain:.3g} 1/s, {len(found.starts)} segment(s)"]
    rows.append("joint               " + "".join(f"{i:>9}" for i in range(1, n + 1)))
    rows.append("residual rms, Nm    " + "".join(f"{x:9.3f}" for x in residual))
    rows.append("external rms, Nm    " + "".join(f"{x:9.3f}" for x in external))
    return "\n".join(rows)


def draw(path: Path, found: "Observation", name: str, module: ModuleType) -> None:
    """Draw residual and external torque, a panel a joint, gaps left open."""
    from matplotlib.figure import Figure

    n = found.residual.shape[1]
    figure = Figure(figsize=(10, 1.6 * n + 1), layout="constrained")
    panels = figure.subplots(n, 1, sharex=True, squeeze=False)[:, 0]
    time = found.timestamp - found.timestamp[0]
    residual_rms, external_rms = found.rms()
    same = np.array_equal(found.residual, found.external_torque)
    for i, panel in enumerate(panels):
        for values, label, colour in (
            (found.residual, "residual", "#9aa5b1"),
            (found.external_torque, "external torque", "#0b6bcb"),
        ):
            if same and label == "residual":
                continue
            broken = values[:, i].copy()
            broken[list(found.starts)] = np.nan
            panel.plot(time, broken, lw=0.9, color=colour, label=label)
        panel.axhline(0, lw=0.5, color="black")
        text = f"joint {i + 1}: rms {residual_rms[i]:.2f} Nm" + (
            "" if same else f" -> {external_rms[i]:.2f} Nm"
        )
        panel.set_title(text, loc="left", fontsize=9)
        panel.set_ylabel("Nm")
        panel.grid(alpha=0.3)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper right", fontsize=8, ncols=2)
    panels[-1].set_xlabel("time, s")
    note = (
        "no friction terms in this model: residual = external torque"
        if same
        else "grey: rigid body alone; blue: with the model's terms"
    )
    figure.suptitle(f"{name}   ({note})", fontsize=10)
    figure.savefig(path, dpi=130)
