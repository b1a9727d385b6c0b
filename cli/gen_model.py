"""`gen-model`: derive, reduce, print and check a model; write its folder."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click
import numpy as np

from ..errors import InputError
from .files import write_tree
from .guard_options import guard_options, read_guard_options
from .options import robot_option
from .run import run, stages


def _numbers(text: str, option: str, count: int | None = None) -> tuple[float, ...]:
    try:
        values = tuple(float(x) for x in text.split(","))
    except ValueError:
        raise InputError(f"{option} {text}: give numbers with commas between them") from None
    if not np.all(np.isfinite(values)):
        raise InputError(f"{option} {text}: give finite numbers")
    if count is not None and len(values) != count:
        raise InputError(f"{option} {text}: give {count} numbers with commas between them")
    return values


@click.command(epilog="Example: gen-model --dof 3 --robot ur5e --out generated")
@click.option("--dof", type=int, help="Moving joints, 1 to 6; the rest is rigid.  [required without --model]")
@robot_option
@click.option(
    "--model", "model_file", type=click.Path(path_type=Path), help="Generate from a model.toml instead."
)
@click.option(
    "--out", default="generated", show_default=True, type=click.Path(path_type=Path), help="Parent folder."
)
@click.option(
    "--variant",
    type=click.Choice(["full", "thesis"]),
    default="full",
    show_default=True,
    help="thesis: the model of Gylling 2019, its omissions included.",
)
@click.option(
    "--locked-angles", metavar="DEG,..", help="Angles of the joints left out, degrees.  [default: 0]"
)
@click.option(
    "--gravity", metavar="X,Y,Z", help="Free fall in the base frame, m/s^2.  [default: the robot's]"
)
@click.option("--gain", type=float, help="Observer gain, 1/s.  [default: 25]")
@guard_options
def gen_model(
    dof: int | None,
    robot: str,
    model_file: Path | None,
    out: Path,
    variant: str,
    locked_angles: str | None,
    gravity: str | None,
    gain: float | None,
    **guard: Any,
) -> None:
    """Derive a robot's equations of motion and generate its residual observer.

    Writes OUT/ROBOT_dofN/ with observer.py (NumPy), observer.c and .h (C99), collision_guard.script
    (URScript), probe.script and snapshot.script (what to check before its use), model.md (the equations)
    and model.toml (the numbers).
    """
    # SymPy and CasADi take half a second to import; --help need not wait for them.
    from ..codegen.check import TOLERANCE, worst_disagreement
    from ..codegen.functions import listings, operation_count, symbolic_model
    from ..codegen.generate import render
    from ..robots import load_robot
    from ..robots.model import Model
    from ..robots.toml import read
    from ..symbolic.nominal import nominal_model

    options = read_guard_options(**guard)
    counts: list[tuple[str, int]] = []
    with stages(5) as bar:
        bar.begin("deriving")
        if model_file is not None:
            if dof is not None:
                raise InputError(
                    "--dof: a model file says how many joints it has; leave --dof out with --model"
                )
            model, _ = read(Model, model_file)
        elif dof is None:
            raise InputError("--dof: say how many joints move, 1 to 6, such as --dof 3")
        else:
            data, digest = load_robot(robot)
            if gravity is not None:
                data = data.model_copy(update={"gravity": _numbers(gravity, "--gravity", 3)})
            model = nominal_model(data, digest, dof, _radians(locked_angles), variant)
            if variant == "full" and dof < len(data.joint):
                alone = symbolic_model(nominal_model(data, digest, dof, wrist="absent")).without_rotors()
                counts = [
                    (f"momentum and beta of links 1-{dof} alone, without rotors", operation_count(alone))
                ]
        if gain is not None:
            if not 0 < gain < 1000:
                raise InputError(f"--gain {gain:g}: give a number between 0 and 1000 1/s")
            model = model.model_copy(update={"observer_gain": gain})
        symbolic = symbolic_model(model)
        bar.begin("reducing")
        found = listings(symbolic)
        bar.begin("printing")
        generated = render(symbolic, found, options, counts)
        bar.begin("checking against SymPy")
        worst = worst_disagreement(symbolic, generated.files["observer.py"])
        if worst > TOLERANCE:
            raise RuntimeError(
                f"generated code differs from the equations by {worst:.1e}; nothing was written"
            )
        bar.begin("writing")
        write_tree(out / model.name, generated.files)
    core = found["momentum_and_beta"].operations
    click.echo(f"{out / model.name}: {', '.join(x for x in generated.files if x != '__init__.py')}")
    click.echo(f"momentum and beta in {core} operations; NumPy agrees with SymPy to {worst:.0e} (relative)")


def _radians(text: str | None) -> Sequence[float]:
    return () if text is None else tuple(np.deg2rad(_numbers(text, "--locked-angles")))


def main() -> None:
    """Run the command; the installed script `gen-model`."""
    run(gen_model, "gen-model")
