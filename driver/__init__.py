"""A robot, real or virtual, at the other end of a cable: record, upload, monitor."""

from .browser import BROWSER_PORT, Browser
from .monitor import Monitor, Reading
from .record import FIELDS, Recorded, record
from .rtde import Rtde
from .upload import Program, find_program, upload

__all__ = [
    "BROWSER_PORT",
    "FIELDS",
    "Browser",
    "Monitor",
    "Program",
    "Reading",
    "Recorded",
    "Rtde",
    "find_program",
    "record",
    "upload",
]
