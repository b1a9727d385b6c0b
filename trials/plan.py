"""Which cases a trial holds: kinds, rates, robots and references in fixed shares, shuffled by seed."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain, count
from math import ceil
from typing import Literal

import numpy as np

from .catalogue import OUTSIDE as OUTSIDE_CATALOGUE
from .catalogue import names as catalogue_names

CLEAN, OUTSIDE, TWO = 0.28, 0.17, 0.15  # shares: of all, of all, of those from the catalogue
ROBOTS = ("ur5e", "ur5e", "ur5e", "ur5e", "ur10e", "ur3e")
Kind = Literal["clean", "catalogue", "outside"]
KINDS: tuple[Kind, ...] = ("clean", "catalogue", "outside")


@dataclass(frozen=True)
class Outline:
    """One case before anything is drawn for it.

    seconds: bounds of a recording's length. first: the effect that is tried first, so that all come up
    equally often; empty: any.
    """

    number: int
    seed: int
    kind: Kind
    two: bool
    reference: bool
    rate: int
    robot: str
    seconds: tuple[float, float]
    first: str = ""

    @property
    def name(self) -> str:
        """The folder's name, from 001."""
        return f"{self.number:03d}"


def outlines(cases: int, seed: int, seconds: tuple[float, float] = (30.0, 60.0)) -> list[Outline]:
    """Return the outlines of a trial; the same arguments give the same ones."""
    rng = np.random.default_rng([seed, 0])
    clean, outside = ceil(CLEAN * cases), ceil(OUTSIDE * cases)
    clean, outside = min(clean, cases), min(outside, cases - min(clean, cases))
    kinds: list[Kind] = []
    kinds += ["clean"] * clean
    kinds += ["outside"] * outside
    kinds += ["catalogue"] * (cases - len(kinds))
    four = [(reference, rate) for reference in (True, False) for rate in (125, 500)]
    turn = int(rng.integers(4))  # going through the kinds in order gives every kind its halves
    settings = [four[(k + turn) % 4] for k in range(cases)]
    order = rng.permutation(cases)
    two, robots = (rng.random(cases) < TWO).tolist(), rng.choice(ROBOTS, cases).tolist()
    decks = {(kind, reference): _deck(kind, reference, rng) for kind in KINDS for reference in (True, False)}
    return [
        Outline(
            number, seed, kinds[k], two[k] and kinds[k] == "catalogue", reference, rate, robots[k], seconds,
            next(decks[kinds[k], reference]),
        )
        for number, k in enumerate(order.tolist(), 1)
        for reference, rate in [settings[k]]
    ]  # fmt: skip


def _deck(kind: Kind, reference: bool, rng: np.random.Generator) -> Iterator[str]:
    """Give the names that a kind of case can hide, shuffled anew whenever all were given."""
    names = {"clean": [""], "outside": list(OUTSIDE_CATALOGUE), "catalogue": catalogue_names(reference)}[kind]
    return chain.from_iterable(rng.permutation(names).tolist() for _ in count())
