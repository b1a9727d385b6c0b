"""Fewer operations by algebra: like terms, common factors, common products, common sums.

A listing is read as sums of products over its inputs and its functions (sin, cos, ..). Then, while
it saves anything, the factor, product or partial sum that saves most is given a name (greedy
extraction; Hosangadi, Fallah, Kastner 2006). The result is a listing again.
"""

from collections import Counter, defaultdict
from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import combinations

from .listing import Builder, Instruction, Listing

Monomial = tuple[int, ...]  # atoms in ascending order; a power is a repetition
Terms = dict[Monomial, float]  # product -> coefficient; signs only, once constants are atoms
Canonical = tuple[tuple[Monomial, float], ...]  # a sum up to its sign
_FREE = ("const", "input")


def simplify(listing: Listing) -> Listing:
    """Return an equivalent listing, with fewer operations where algebra finds any to save."""
    ways = [listing]
    for inline in (False, True):
        for preference in ("factor", "product"):
            program = _read(listing, inline)
            while _extract_best(program, preference):
                pass
            ways.append(_write(program, listing))
    return min(ways, key=lambda x: x.operations)


@dataclass
class _Program:
    """Named values: leaves (inputs, constants, functions), products of two atoms, sums of products.

    An atom is an index shared by all three. Outputs are rows too.
    """

    leaves: dict[int, Instruction] = field(default_factory=dict)
    pairs: dict[int, tuple[int, int]] = field(default_factory=dict)
    rows: dict[int, Terms] = field(default_factory=dict)
    names: dict[object, int] = field(default_factory=dict)
    sums: dict[Canonical, tuple[int, float]] = field(default_factory=dict)  # canonical sum -> row, its sign

    def atom(self, key: object) -> tuple[int, bool]:
        """Return the atom of a value, and whether it is new."""
        if key in self.names:
            return self.names[key], False
        self.names[key] = len(self.names)
        return self.names[key], True

    def leaf(self, instruction: Instruction) -> int:
        """Return the atom of an input, a constant or a function value."""
        atom, new = self.atom(instruction)
        if new:
            self.leaves[atom] = instruction
        return atom

    def pair(self, a: int, b: int) -> int:
        """Return the atom of a product."""
        atom, new = self.atom(("pair", a, b))
        if new:
            self.pairs[atom] = (a, b)
        return atom

    def row(self, terms: Terms) -> tuple[int, float]:
        """Return (atom, sign) of a sum: equal and opposite sums share an atom."""
        if len(terms) == 1 and len(next(iter(terms))) == 1:
            ((monomial, sign),) = terms.items()
            if abs(sign) == 1:
                return monomial[0], sign
        key, sign = _canonical(terms)
        if key not in self.sums:
            atom, _ = self.atom(("sum", len(self.names)))
            self.put(atom, dict(key))
        atom, own = self.sums[key]
        return atom, sign * own

    def put(self, atom: int, terms: Terms) -> None:
        """Set a row."""
        self.rows[atom] = terms
        if len(terms) > 1:
            key, sign = _canonical(terms)
            self.sums.setdefault(key, (atom, sign))


def _canonical(terms: Terms) -> tuple[Canonical, float]:
    ordered = sorted(terms.items())
    sign = -1.0 if ordered[0][1] < 0 else 1.0
    return tuple((m, sign * c) for m, c in ordered), sign


# ---- reading -----------------------------------------------------------------------------------


def _read(listing: Listing, inline: bool) -> _Program:
    """Read a listing; inline: put sums that are used more than once into the sums that use them."""
    program = _Program()
    uses = Counter(a for x in listing.instructions if x.op not in _FREE for a in x.args)
    values: list[Terms] = []
    for index, x in enumerate(listing.instructions):
        value = _value(program, x, values)
        if len(value) > 1 and uses[index] > 1 and not inline:
            value = _named(program, value)
        values.append(value)
    for label, (_, indices) in listing.outputs.items():
        for k, index in enumerate(indices):
            atom, _ = program.atom(("output", label, k))
            program.rows[atom] = values[index]
    program.sums.clear()
    for atom in list(program.rows):
        program.put(atom, _with_constant_atoms(program, program.rows[atom]))
    return program


def _value(program: _Program, x: Instruction, values: list[Terms]) -> Terms:
    if x.op == "const":
        return {(): x.value} if x.value else {}
    if x.op == "input":
        return {(program.leaf(x),): 1.0}
    a, *rest = (values[i] for i in x.args)
    if x.op == "neg":
        return _added({}, a, -1.0)
    if x.op in ("add", "sub"):
        return _added(a, rest[0], 1.0 if x.op == "add" else -1.0)
    if x.op == "mul":
        return _multiplied(program, a, rest[0])
    arguments = [_argument(program, v) for v in (a, *rest)]
    return {(program.leaf(Instruction(x.op, tuple(arguments))),): 1.0}


def _added(a: Terms, b: Terms, scale: float) -> Terms:
    total = dict(a)
    for monomial, coefficient in b.items():
        total[monomial] = total.get(monomial, 0.0) + scale * coefficient
    return {m: c for m, c in total.items() if c}


def _multiplied(program: _Program, a: Terms, b: Terms) -> Terms:
    if not a or not b:
        return {}
    ((m, x),) = (_named(program, a) if len(a) > 1 else a).items()
    ((n, y),) = (_named(program, b) if len(b) > 1 else b).items()
    return {tuple(sorted(m + n)): x * y}


def _named(program: _Program, value: Terms) -> Terms:
    atom, sign = program.row(value)
    return {(atom,): sign}


def _argument(program: _Program, value: Terms) -> int:
    """Return an atom that equals the value, sign included: a function needs it whole."""
    ((monomial, sign),) = (_named(program, value) if len(value) != 1 else value).items()
    if sign == 1 and len(monomial) == 1:
        return monomial[0]
    atom, new = program.atom(("argument", monomial, sign))
    if new:
        program.rows[atom] = {monomial: sign}
    return atom


def _with_constant_atoms(program: _Program, terms: Terms) -> Terms:
    """Turn coefficients into atoms, so that they are factored and shared like everything else."""
    changed: Terms = {}
    for monomial, coefficient in terms.items():
        size, sign = abs(coefficient), 1.0 if coefficient > 0 else -1.0
        if size != 1 or not monomial:
            monomial = tuple(sorted((*monomial, program.leaf(Instruction("const", (), size)))))
        changed[monomial] = sign
    return changed


# ---- extracting --------------------------------------------------------------------------------


def _extract_best(program: _Program, preference: str) -> bool:
    """Name what saves most; return False when nothing saves any operation."""
    factors = _best_factor(program)
    product = _best_product(program)
    partial = _best_partial_sum(program)
    best = max(factors[0], product[0], partial[0])
    if best <= 0:
        return False
    order = ("factor", "product") if preference == "factor" else ("product", "factor")
    for kind in order:
        if kind == "factor" and factors[0] == best:
            for row, atom in factors[1]:
                _factor_out(program, row, atom)
            return True
        if kind == "product" and product[0] == best:
            _name_product(program, *product[1])
            return True
    _name_partial_sum(program, partial[1])
    return True


def _without(monomial: Monomial, atom: int) -> Monomial:
    i = monomial.index(atom)
    return monomial[:i] + monomial[i + 1 :]


def _inner(terms: Terms, atom: int) -> Terms:
    """Return the cofactor of an atom in a sum."""
    return {_without(m, atom): c for m, c in terms.items() if atom in m and len(m) > 1}


def _best_factor(program: _Program) -> tuple[int, list[tuple[int, int]]]:
    """Find the factor (in all sums where it leaves the same cofactor) that saves most."""
    groups: dict[Canonical, list[tuple[int, int]]] = defaultdict(list)
    for row, terms in program.rows.items():
        if len(terms) < 2:
            continue
        counts = Counter(atom for m in terms if len(m) > 1 for atom in set(m))
        for atom, count in counts.items():
            if count > 1:
                groups[_canonical(_inner(terms, atom))[0]].append((row, atom))
    best: tuple[int, list[tuple[int, int]]] = (0, [])
    for key, places in groups.items():
        distinct = {row: (row, atom) for row, atom in reversed(places)}  # one a sum: they may overlap
        size = len(key)
        inner_cost = size - 1 + sum(len(m) - 1 for m, _ in key)
        again = len(distinct) - (key not in program.sums)
        saving = (size - 1) * len(distinct) + inner_cost * again
        if (saving, -min(distinct)) > (best[0], -min((r for r, _ in best[1]), default=0)):
            best = saving, sorted(distinct.values())
    return best


def _factor_out(program: _Program, row: int, atom: int) -> None:
    terms = program.rows[row]
    inner = _inner(terms, atom)
    name, sign = program.row(inner)
    kept = {m: c for m, c in terms.items() if not (atom in m and len(m) > 1)}
    program.put(row, _added(kept, {tuple(sorted((atom, name))): sign}, 1.0))


def _pairs_of(monomial: Monomial) -> Iterable[tuple[int, int]]:
    return set(combinations(monomial, 2))


def _best_product(program: _Program) -> tuple[int, tuple[int, int]]:
    counts = Counter(p for terms in program.rows.values() for m in terms if len(m) > 1 for p in _pairs_of(m))
    if not counts:
        return 0, (0, 0)
    pair = max(counts, key=lambda p: (counts[p], -p[0], -p[1]))
    return counts[pair] - 1, pair


def _name_product(program: _Program, a: int, b: int) -> None:
    name = program.pair(a, b)

    def shorter(monomial: Monomial) -> Monomial:
        if (a, b) not in _pairs_of(monomial):
            return monomial
        return tuple(sorted((*_without(_without(monomial, a), b), name)))

    for row, terms in program.rows.items():
        if any((a, b) in _pairs_of(m) for m in terms):
            program.put(row, {shorter(m): c for m, c in terms.items()})


PartialSum = tuple[Monomial, Monomial, float]


def _best_partial_sum(program: _Program) -> tuple[int, PartialSum]:
    counts: Counter[PartialSum] = Counter()
    for terms in program.rows.values():
        ordered = sorted(terms.items())
        for (m, x), (n, y) in combinations(ordered, 2):
            counts[(m, n, x * y)] += 1
    if not counts:
        return 0, ((), (), 0.0)
    key = max(counts, key=lambda k: (counts[k], sum(map(len, k[:2])), k[0], k[1], k[2]))
    return counts[key] - 1, key


def _name_partial_sum(program: _Program, key: PartialSum) -> None:
    m, n, relative = key
    name, sign = program.row({m: 1.0, n: relative})
    for row, terms in list(program.rows.items()):
        if row != name and m in terms and n in terms and terms[m] * terms[n] == relative:
            kept = {k: c for k, c in terms.items() if k not in (m, n)}
            program.put(row, _added(kept, {(name,): sign * terms[m]}, 1.0))


# ---- writing -----------------------------------------------------------------------------------


def _write(program: _Program, source: Listing) -> Listing:
    builder = Builder()
    written: dict[int, int] = {}

    def atom(index: int) -> int:
        if index not in written:
            written[index] = _emit(index)
        return written[index]

    def _emit(index: int) -> int:
        if index in program.rows:
            return _sum(program.rows[index])
        if index in program.pairs:
            a, b = program.pairs[index]
            return builder.add(Instruction("mul", (atom(a), atom(b))))
        leaf = program.leaves[index]
        if leaf.op in _FREE:
            return builder.add(leaf)
        return builder.add(Instruction(leaf.op, tuple(atom(a) for a in leaf.args)))

    def product(monomial: Monomial, negative: bool = False) -> int:
        factors = list(monomial)
        for k, a in enumerate(factors):
            if negative and a in program.leaves and program.leaves[a].op == "const":
                rest = [atom(x) for x in factors[:k] + factors[k + 1 :]]
                return _chain([builder.constant(-program.leaves[a].value), *rest])
        value = _chain([atom(x) for x in factors])
        return builder.add(Instruction("neg", (value,))) if negative else value

    def _chain(values: list[int]) -> int:
        total = values[0]
        for value in values[1:]:
            total = builder.add(Instruction("mul", (total, value)))
        return total

    def _has_constant(monomial: Monomial) -> bool:
        return any(a in program.leaves and program.leaves[a].op == "const" for a in monomial)

    def _sum(terms: Terms) -> int:
        if not terms:
            return builder.constant(0.0)
        first = min(terms.items(), key=lambda t: (t[1] < 0, not _has_constant(t[0]), t[0]))
        total = product(first[0], negative=first[1] < 0)
        for monomial, sign in sorted(terms.items()):
            if monomial != first[0]:
                total = builder.add(Instruction("add" if sign > 0 else "sub", (total, product(monomial))))
        return total

    outputs = {
        label: (shape, tuple(atom(program.names[("output", label, k)]) for k in range(len(indices))))
        for label, (shape, indices) in source.outputs.items()
    }
    return builder.listing(source.name, source.inputs, outputs)
