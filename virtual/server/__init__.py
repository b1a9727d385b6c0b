"""The virtual robot behind a controller's sockets: RTDE, dashboard and script ports."""

from .controller import VERSIONS, Controller
from .network import Ports, Server

__all__ = ["VERSIONS", "Controller", "Ports", "Server"]
