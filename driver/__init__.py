"""A robot, real or virtual, at the other end of a cable: record, upload, monitor."""

from .monitor import Monitor, Reading
from .record import FIELDS, Recorded, record
from .rtde import Rtde
from .upload import Program, find_program, upload

__all__ = ["FIELDS", "Monitor", "Program", "Reading", "Recorded", "Rtde", "find_program", "record", "upload"]
