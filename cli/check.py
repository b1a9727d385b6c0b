"""`residuum check`: reads a program as the controller would, before the controller does."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import click

from ..errors import InputError
from ..urscript import Diagnostic, Version
from ..urscript import check as check_text
from .files import read_script


@click.command(epilog="Example:  residuum check collision_guard.script --target-version 5.11")
@click.argument("file", type=click.Path(path_type=Path))
@click.option(
    "--target-version",
    default="5.23",
    show_default=True,
    metavar="VERSION",
    help="PolyScope version of the robot: 5.4 and newer, or 10.x for PolyScope X.",
)
@click.option("--json", "as_json", is_flag=True, help="Print the diagnostics as a JSON list.")
def check(file: Path, target_version: str, as_json: bool) -> None:
    """Check a URScript program for what the controller would refuse, stop or misread.

    Exit code 0: no errors (warnings may be there), 1: errors, 2: the file or the version cannot be used.
    """
    try:
        Version.parse(target_version)
        diagnostics = check_text(read_script(file), target_version)
    except InputError as error:
        click.echo(f"residuum check: {error}", err=True)
        raise SystemExit(2) from None
    click.echo(_as_json(diagnostics) if as_json else _as_text(file, diagnostics), nl=as_json)
    raise SystemExit(1 if any(d.severity == "error" for d in diagnostics) else 0)


def _as_text(file: Path, diagnostics: list[Diagnostic]) -> str:
    return "".join(f"{file}:{d.line}:{d.column}: {d.severity}: {d.message} [{d.code}]\n" for d in diagnostics)


def _as_json(diagnostics: list[Diagnostic]) -> str:
    return json.dumps([asdict(diagnostic) for diagnostic in diagnostics], indent=1)
