"""Commands of the package, and the virtual robot, each in a process of its own."""

import contextlib
import os
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

PORTS = (30004, 29999, 30001, 30002, 30003)


class StepError(Exception):
    """A step did not do what it should."""


def residuum(*arguments: str, verb: str = "residuum") -> str:
    """Run a command of the package in a process of its own; return what it printed."""
    done = subprocess.run([program(verb), *arguments], capture_output=True, text=True, timeout=600)
    if done.returncode:
        raise StepError(f"{verb} {' '.join(arguments)}: ended with {done.returncode}: {done.stderr.strip()}")
    return done.stdout.strip()


def program(name: str) -> str:
    """Return where a command of this Python environment is installed."""
    found = Path(sys.executable).parent / name
    if not found.exists():
        raise StepError(f"{name} is not installed beside {Path(sys.executable).name}; pip install residuum")
    return str(found)


def free_host() -> str:
    """Return a loopback address on which a controller's ports are free: the ports themselves are fixed.

    Linux has the whole of 127/8; elsewhere there is but one.
    """
    own = os.getpid() % 60000
    for host in (*(f"127.{42 + k}.{own // 250}.{own % 250 + 1}" for k in range(3)), "127.0.0.1"):
        with contextlib.ExitStack() as stack, contextlib.suppress(OSError):
            for port in PORTS:
                probe = stack.enter_context(socket.socket())
                probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
                probe.bind((host, port))
            return host
    raise StepError("no loopback address with free ports 29999 and 30001-30004")


@contextlib.contextmanager
def robot(plant: Path, speed: float, seed: int) -> Iterator[str]:
    """Serve a virtual robot until the block ends; yields its address."""
    host = free_host()
    command = [program("residuum"), "serve", "--host", host, "--plant", str(plant)]
    process = subprocess.Popen(
        [*command, "--speed", str(speed), "--seed", str(seed)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    try:
        if process.stdout is None or "RTDE 30004" not in process.stdout.readline():
            process.terminate()
            raise StepError(f"serve did not start: {process.communicate(timeout=10)[1].strip()}")
        yield host
    finally:
        process.terminate()
        process.communicate(timeout=10)
