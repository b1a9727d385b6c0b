"""The catalogue of effects: every physics name that a finding can have, with what it means in the cell.

Names are those of findings.json; "data_fault" and "unknown" are no physics and stand nowhere here.
"""

from collections.abc import Mapping

from .drive import DRIVE
from .effect import Effect
from .friction import FRICTION
from .rigid import RIGID

__all__ = ["EFFECTS", "Effect"]

#: Every effect by name.
EFFECTS: Mapping[str, Effect] = {effect.name: effect for effect in (*RIGID, *FRICTION, *DRIVE)}
