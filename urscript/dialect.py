"""What is not known of the language for certain, as choices."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

STEP = 0.002
"""Controller period of the e-Series in seconds, script manual 5.11, `get_steptime`."""


@dataclass(frozen=True, slots=True)
class Dialect:
    """Choices where the manual is silent or contradicted by scripts in use.

    Attributes:
        version: PolyScope version of the controller that is imitated, as "5.11".
        strict_numbers: refuse a float for a variable that began as an integer. The manual fixes the type at
            the first assignment; ur_rtde's control script relies on both being "number".
        integer_division: "float" gives 7 / 2 = 3.5 (UR's external_control script needs it), "whole" gives 3.
        integer_overflow: integers have 32 bits; beyond, "error" stops the program, "wrap" counts
            modulo 2^32.
        budget: operations a thread may execute in one 2 ms frame before the program is stopped. The cost of
            an operation on the controller is not published; this is a round number.
        slice: operations after which a thread outside a critical section lets the others of the frame go on;
            None never does.
        seed: of `random()`.

    """

    version: str = "5.23"
    strict_numbers: bool = False
    integer_division: Literal["float", "whole"] = "float"
    integer_overflow: Literal["error", "wrap"] = "error"
    budget: int = 100_000
    slice: int | None = None
    seed: int = 0
