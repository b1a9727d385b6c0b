"""The virtual robot: physics, sensors and recordings, independent of the symbolic derivation.

Rigid-body dynamics are MuJoCo's; drives, friction, sensors and surroundings are this package's.
"""

from .command import Command, Freedrive, Position, Speed, Stop, Torque
from .controller import TICK
from .motions import Motion
from .plant import NOISELESS, Plant, load_plant
from .recording import Recording, Run, Truth, simulate
from .sensing import Rows
from .simulator import Simulator, State
from .surroundings import Contact, Obstacle, clamped_hand, foam

__all__ = [
    "NOISELESS",
    "TICK",
    "Command",
    "Contact",
    "Freedrive",
    "Motion",
    "Obstacle",
    "Plant",
    "Position",
    "Recording",
    "Rows",
    "Run",
    "Simulator",
    "Speed",
    "State",
    "Stop",
    "Torque",
    "Truth",
    "clamped_hand",
    "foam",
    "load_plant",
    "simulate",
]
