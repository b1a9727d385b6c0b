"""Work on recordings and blocks side by side: each is by itself, and NumPy lets other threads run."""

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

A = TypeVar("A")
B = TypeVar("B")

#: Threads at most: each holds the columns of a stretch of time.
_MOST = 4


def each(function: Callable[[A], B], items: Iterable[A]) -> list[B]:
    """Return function of each item, in their order. Threads of BLAS are not counted: limit them outside."""
    with ThreadPoolExecutor(min(os.cpu_count() or 1, _MOST)) as pool:
        return list(pool.map(function, items))
