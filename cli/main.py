"""`residuum`: one verb a file; a verb's modules are imported when it is called."""

import importlib

import click

from .. import __version__
from .run import run

#: Verb -> its one line in --help; the command stands in the file of that name.
VERBS = {
    "audit": "Say what is wrong with recordings.",
    "check": "Check a URScript program.",
    "collide": "Collision experiments: the thesis' campaign, and beyond.",
    "explain": "What physics is missing, where, and the proof.",
    "fit": "Fit a baseline model to recordings.",
    "monitor": "The observer's view of a running robot.",
    "observe": "Residual and external torque along a recording.",
    "predict": "Motor currents along a recording from its motion alone.",
    "record": "Record a robot's own stream.",
    "serve": "A virtual robot behind a controller's sockets.",
    "trial": "Concealed cases, answered without their labels, and the score.",
    "upload": "Send a program to the controller.",
}


class Verbs(click.Group):
    """A group that imports a verb when it is needed."""

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: D102
        return list(VERBS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:  # noqa: D102
        if cmd_name not in VERBS:
            return None
        module = importlib.import_module(f".{cmd_name}", __package__)
        command: click.Command = getattr(module, cmd_name)
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: D102
        with formatter.section("Commands"):
            formatter.write_dl(list(VERBS.items()))


@click.command(
    cls=Verbs, epilog="Example: residuum observe run.csv --model generated/ur5e_dof6/model.toml --out r.csv"
)
@click.version_option(__version__, prog_name="residuum")
def residuum() -> None:
    """Find what a robot's own motion does not explain of its motor currents.

    `gen-model` generates the observer; these commands do the rest.
    """


def main() -> None:
    """Run the command; the installed script `residuum`."""
    run(residuum, "residuum")
