"""`residuum upload`: send a program to the controller."""

from pathlib import Path

import click

from ..errors import InputError


@click.command(
    epilog="Example: residuum upload generated/ur5e_dof6/collision_guard.script --host 192.168.1.10"
)
@click.argument("script", type=click.Path(path_type=Path), metavar="SCRIPT")
@click.option("--host", required=True, help="The robot's address, or a virtual one's.")
@click.option("--timeout", default=10.0, show_default=True, help="Seconds to wait for the start.")
def upload(script: Path, host: str, timeout: float) -> None:
    """Send a URScript program and wait until the controller has started it.

    The program that runs is ended by it. When the controller refuses, its error is shown with the line in
    the file.
    """
    from ..driver import find_program
    from ..driver import upload as send

    try:
        text = script.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "not text"
        raise InputError(f"{script}: cannot be read: {reason}") from None
    program = find_program(text, str(script))
    send(host, program, str(script), timeout=timeout)
    click.echo(f"{program.name} {'sent' if program.secondary else 'started'} on {host}")
