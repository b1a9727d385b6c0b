"""From column names to the channels of a recording: which column is what, and what is missing."""

import difflib
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import InputError
from .channels import CURRENT, OPTIONAL, OTHERS, PER_JOINT, REQUIRED, Channel
from .recording import Dropped, FloatArray, IntArray, Recording, Source

MOST_JOINTS = 6


@dataclass(frozen=True)
class Layout:
    """What to take from a table with `width` columns.

    `columns`: indices of the table's columns to read, ascending. `channels`: each channel with the
    positions of its columns among `columns`. `ignored`: names of columns of incomplete channels.
    """

    width: int
    columns: tuple[int, ...]
    channels: tuple[tuple[Channel, tuple[int, ...]], ...]
    ignored: tuple[str, ...]

    def recording(
        self, name: str, source: Source, table: FloatArray, rows: IntArray, dropped: tuple[Dropped, ...]
    ) -> Recording:
        """Cut `table` (T, len(columns)) into channels."""
        named: dict[str, FloatArray] = {}
        others: dict[str, FloatArray] = {}
        for channel, at in self.channels:
            value = table[:, at[0]] if channel.width == 1 else table[:, list(at)]
            if channel.field:
                named[channel.field] = np.ascontiguousarray(value)
            else:
                others[channel.name] = np.ascontiguousarray(value)
        named.setdefault("current", np.broadcast_to(0.0, named["q"].shape))
        return Recording(
            name=name, source=source, rows=rows, dropped=dropped, ignored=self.ignored, others=others, **named
        )


def layout(names: Sequence[str], where: str, extra: Sequence[str] = (), current: bool = True) -> Layout:
    """Find the channels among the column `names`; `where` begins the message of an InputError.

    `current` False: the measured currents are neither needed nor taken.
    `extra` names further columns to keep, each as a channel of its own in `Recording.others`.
    Raises InputError when a needed column is missing or a used one stands there twice.
    """
    index = {name: k for k, name in enumerate(names)}
    required = [c for c in REQUIRED if current or c is not CURRENT]
    joints = _joints(index, required)
    _require(index, [c for channel in required for c in channel.columns(joints)], where)
    optional = [*OPTIONAL, *OTHERS, *(Channel(name, None, 1, "as recorded") for name in extra)]
    _require(index, extra, where)
    complete = [c for c in optional if all(name in index for name in c.columns(joints))]
    partial = [c for c in optional if c not in complete]
    channels = [*required, *complete]
    _refuse_twice(names, {name for c in channels for name in c.columns(joints)}, where)
    columns = sorted({index[name] for c in channels for name in c.columns(joints)})
    position = {column: k for k, column in enumerate(columns)}
    return Layout(
        width=len(names),
        columns=tuple(columns),
        channels=tuple((c, tuple(position[index[name]] for name in c.columns(joints))) for c in channels),
        ignored=tuple(name for c in partial for name in c.columns(joints) if name in index),
    )


def _joints(index: Mapping[str, int], required: Sequence[Channel]) -> int:
    per_joint = [c.name for c in required if c.width == PER_JOINT]
    present = [k for k in range(MOST_JOINTS) for name in per_joint if f"{name}_{k}" in index]
    return max(present, default=0) + 1


def _require(index: Mapping[str, int], needed: Sequence[str], where: str) -> None:
    missing = [name for name in needed if name not in index]
    if not missing:
        return
    near = difflib.get_close_matches(missing[0], list(index), n=1, cutoff=0.75)
    hint = f"; rename {near[0]!r}?" if near else "; name the columns as RTDE does"
    more = f" (and {len(missing) - 1} more)" if len(missing) > 1 else ""
    raise InputError(f"{where}: column {missing[0]!r} is missing{more}{hint}")


def _refuse_twice(names: Sequence[str], used: set[str], where: str) -> None:
    for name, count in Counter(names).items():
        if count > 1 and name in used:
            raise InputError(f"{where}: column {name!r} stands there {count} times; keep one of them")
