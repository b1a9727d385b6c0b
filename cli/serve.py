"""`residuum serve`: the virtual robot behind a controller's sockets."""

import asyncio
import contextlib
import signal
import sys
from ipaddress import ip_address
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from ..virtual.server import Server


VERSIONS = ("5.21", "5.25.1")


def factor(_context: click.Context, _option: click.Parameter, value: str) -> float | None:
    """Return a factor above 0, or None for max."""
    if value == "max":
        return None
    try:
        number = float(value)
    except ValueError:
        number = 0.0
    if not 0.0 < number < 1e6:
        raise click.BadParameter(f"{value!r} is neither a number above 0 nor max")
    return number


@click.command(epilog="Example: residuum serve --plant arm.toml")
@click.option("--host", default="127.0.0.1", show_default=True, help="Address to listen at.")
@click.option("--robot", default="ur5e", show_default=True, help="Built-in robot, or a .toml file.")
@click.option("--plant", type=click.Path(path_type=Path), help="What this arm is like beside the robot file.")
@click.option(
    "--polyscope",
    type=click.Choice(VERSIONS),
    default=VERSIONS[0],
    show_default=True,
    help="Version to imitate.",
)
@click.option("--speed", callback=factor, default="1.0", show_default=True, help="Times real time, or max.")
@click.option("--seed", default=0, show_default=True, help="Of noise.")
def serve(host: str, robot: str, plant: Path | None, polyscope: str, speed: float | None, seed: int) -> None:
    """Serve a virtual robot: RTDE 30004, dashboard 29999, script ports 30001-30003.

    Stop it with Ctrl-C. It has no password and obeys everybody who reaches it, as a robot does: at another
    address than a loopback one, that is your network.
    """
    from ..robots import load_robot
    from ..virtual import load_plant
    from ..virtual.server import Controller, Server

    controller = Controller(
        load_robot(robot)[0], load_plant(plant) if plant else None, polyscope, seed=seed, say=_say
    )
    server = Server(controller, host, speed=speed)
    # The parser may run beside the clock; it must not keep it waiting for Python's usual 5 ms.
    sys.setswitchinterval(0.0005)
    asyncio.run(_serve(server, host, f"virtual {robot}, PolyScope {polyscope}"))


async def _serve(server: "Server", host: str, what: str) -> None:
    ports = await server.open()
    _say(
        f"{what}: RTDE {ports.rtde}, dashboard {ports.dashboard}, "
        f"scripts {ports.primary}, {ports.secondary}, {ports.realtime} "
        f"at {host} ({_reach(host)}); Ctrl-C ends"
    )
    task = asyncio.ensure_future(server.run())
    for number in (signal.SIGINT, signal.SIGTERM):
        asyncio.get_running_loop().add_signal_handler(number, task.cancel)
    try:
        with contextlib.suppress(asyncio.CancelledError):
            await task
    finally:
        server.close()
    _say(f"stopped after {server.controller.arm.time:.3f} s of the robot's time")


def _reach(host: str) -> str:
    with contextlib.suppress(ValueError):
        return "this computer only" if ip_address(host).is_loopback else "open to the network"
    return "this computer only" if host == "localhost" else "open to the network"


def _say(line: str) -> None:
    click.echo(line)
    sys.stdout.flush()
