"""`residuum predict`: motor currents along a recording from its motion alone."""

from pathlib import Path

import click
import numpy as np

from .files import write_file
from .observe import load_observer
from .run import stages


@click.command(epilog="Example: residuum predict run.csv --model ur5e.toml --out predicted.csv")
@click.argument("recording", type=click.Path(path_type=Path), metavar="REC")
@click.option(
    "--model",
    required=True,
    type=click.Path(path_type=Path),
    help="A model.toml of residuum fit, or a folder that gen-model wrote.",
)
@click.option("--out", required=True, type=click.Path(path_type=Path), help="CSV to write.")
def predict(recording: Path, model: Path, out: Path) -> None:
    """Write the motor currents (A) that a recording's motion needs: timestamp, predicted_current_0, ..

    Only positions, speeds and temperatures are read, never the recorded currents; the file need not have
    any. Timestamps are as recorded; rows whose motion is corrupt are left out, and said.
    """
    from ..errors import InputError
    from ..identify.motion import predicted_current
    from ..recordings import read
    from ..recordings.audit import clean

    with stages(4) as bar:
        bar.begin("generating")
        module = load_observer(model)
        bar.begin("reading")
        good, report = clean(read(recording, current=False), motion_only=True)
        report.require()
        if good.joints < module.DOF:
            raise InputError(f"{good.name}: has {good.joints} joints, the model needs {module.DOF}")
        bar.begin("predicting")
        current = predicted_current(good, module)
        bar.begin("writing")
        write_file(out, lambda path: _write_csv(path, good.timestamp, current))
    for finding in report.findings:
        if finding.severity == "dropped":
            click.echo(f"{good.name}: {finding.text}")
    click.echo(f"{out}: {len(current)} rows, {module.DOF} joints")


def _write_csv(
    path: Path, timestamp: "np.ndarray[tuple[int], np.dtype[np.float64]]", current: object
) -> None:
    values = np.asarray(current)
    names = [f"predicted_current_{i}" for i in range(values.shape[1])]
    with path.open("w", encoding="utf-8", newline="\n") as file:
        file.write(",".join(["timestamp", *names]) + "\n")
        for time, row in zip(timestamp.tolist(), values.tolist(), strict=True):
            file.write(f"{time!r}," + ",".join(f"{x:.9g}" for x in row) + "\n")
