"""A listing as NumPy calls that write into reused work arrays.

Large arrays cost NumPy a pass over memory for every operation; writing into arrays that are in the
cache already saves about a fifth of the time of ordinary expressions. Only what runs over whole
recordings is printed so.
"""

from dataclasses import dataclass

from .listing import Listing

_UFUNCS = {
    "add": "add", "sub": "subtract", "mul": "multiply", "div": "divide", "neg": "negative", "sin": "sin",
    "cos": "cos", "exp": "exp", "sqrt": "sqrt", "abs": "absolute", "pow": "power",
}  # fmt: skip


@dataclass(frozen=True)
class InPlace:
    """Calls (ufunc, arguments, work array) in order, results in order, and what they need.

    ufuncs: their names; buffers: number of work arrays b0, b1, ..
    """

    calls: tuple[tuple[str, str, str], ...]
    results: tuple[str, ...]
    ufuncs: tuple[str, ...]
    buffers: int


def in_place(listing: Listing) -> InPlace:
    """Print a listing with work arrays: one is free again after the last use of its value."""
    results = [i for _, indices in listing.outputs.values() for i in indices]
    last_use = {
        a: k for k, x in enumerate(listing.instructions) if x.op not in ("const", "input") for a in x.args
    }
    last_use |= dict.fromkeys(results, len(listing.instructions))
    names = list(listing.inputs)
    place: dict[int, str] = {}
    free: list[str] = []
    calls: list[tuple[str, str, str]] = []
    buffers = 0
    for k, x in enumerate(listing.instructions):
        if x.op == "const":
            place[k] = repr(x.value)
        elif x.op == "input":
            place[k] = f"{names[x.args[0]]}{x.args[1] + 1}"
        else:
            # A ufunc may write where it reads: element by element it has read before it writes.
            free += [place[a] for a in sorted(set(x.args)) if last_use[a] == k and place[a].startswith("b")]
            if not free:
                free.append(f"b{buffers}")
                buffers += 1
            place[k] = free.pop()
            calls.append((_UFUNCS[x.op], ", ".join(place[a] for a in x.args), place[k]))
    used = tuple(sorted({ufunc for ufunc, _, _ in calls}))
    return InPlace(tuple(calls), tuple(place[i] for i in results), used, buffers)
