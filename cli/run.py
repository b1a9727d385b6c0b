"""How a command ends: 0 done, 2 bad input with one line on stderr, never a traceback for bad input."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager

import click
from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

from ..errors import InputError


def run(command: click.Command, name: str) -> None:
    """Run a click command as a program; this is what the installed scripts call."""
    try:
        code = command.main(prog_name=name, standalone_mode=False)
    except InputError as error:
        _fail(str(error))
    except click.exceptions.Abort:
        _fail("interrupted", 130)
    except click.ClickException as error:
        where = (
            f" (see {error.ctx.command_path} --help)"
            if isinstance(error, click.UsageError) and error.ctx
            else ""
        )
        _fail(f"{error.format_message()}{where}")
    except BrokenPipeError:
        sys.stderr.close()
        sys.exit(0)
    sys.exit(code if isinstance(code, int) else 0)


def _fail(message: str, code: int = 2) -> None:
    click.echo(" ".join(message.split()), err=True)
    sys.exit(code)


class Stages:
    """A progress bar over named stages; it shows only on a terminal."""

    def __init__(self, progress: Progress, total: int) -> None:
        self._progress = progress
        self._task = progress.add_task("", total=total)
        self._begun = False

    def begin(self, stage: str) -> None:
        """Name the stage that begins; the one before is done."""
        self._progress.update(self._task, description=stage, advance=int(self._begun), refresh=True)
        self._begun = True

    def rename(self, stage: str) -> None:
        """Give the stage that runs another name, such as one with a count."""
        self._progress.update(self._task, description=stage)


@contextmanager
def stages(total: int) -> Iterator[Stages]:
    """Show a bar of `total` stages on stderr while the block runs."""
    console = Console(stderr=True)
    columns = (SpinnerColumn(), TextColumn("{task.description:<28}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress:
        yield Stages(progress, total)
