"""The options of `gen-model` that concern the program which guards the robot."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from .files import read_script

if TYPE_CHECKING:
    from ..codegen.options import Options

_F = TypeVar("_F", bound=Callable[..., Any])
_CHOICES = (
    click.option(
        "--current-source",
        type=click.Choice(["modbus", "rtde"]),
        default="modbus",
        show_default=True,
        help="Where the URScript reads motor currents.",
    ),
    click.option(
        "--reaction",
        type=click.Choice(["hold", "freedrive", "retract"]),
        default="freedrive",
        show_default=True,
        help="What the URScript does after a collision.",
    ),
    click.option(
        "--detector",
        type=click.Choice(["static", "speed", "cusum", "velocity", "vote"]),
        default="speed",
        show_default=True,
        help="What is a collision: residual over a constant or speed-dependent threshold, its CUSUM, "
        "the speed's deviation from its target, or two of the last three.",
    ),
    click.option(
        "--polyscope",
        metavar="VERSION",
        help="Target version.  [default: 5.11; 5.23 for --current-source rtde]",
    ),
    click.option(
        "--motion",
        type=click.Path(path_type=Path),
        help="Your motion: a URScript FILE, a whole program or a function's body.",
    ),
    click.option(
        "--resume",
        default="register:64",
        show_default=True,
        metavar="INPUT",
        help="What ends the reaction: register:64..127 or digital:0..7.",
    ),
    click.option(
        "--payload", type=float, default=0.0, show_default=True, help="Mass at the flange in the model, kg."
    ),
    click.option(
        "--bias",
        type=click.Choice(["check", "subtract"]),
        default="check",
        show_default=True,
        help="What becomes of the residual at rest.",
    ),
)


def guard_options(command: _F) -> _F:
    """Give a command the options of the guard."""
    for option in reversed(_CHOICES):
        command = option(command)
    return command


def read_guard_options(motion: Path | None, polyscope: str | None, **choices: Any) -> Options:
    """Check the options of the guard and read the user's motion; its warnings go to stderr.

    Raises InputError, with the user's line and column where the motion is wrong.
    """
    from ..codegen.motion import read_motion
    from ..codegen.options import Options

    options = Options(polyscope=polyscope or "", **choices)
    if motion is None:
        return options
    found = read_motion(read_script(motion, "--motion"), str(motion), options.target)
    for remark in found.remarks:
        click.echo(f"warning: {remark}", err=True)
    return Options(polyscope=polyscope or "", motion=found, **choices)
