"""One instruction listing, from which every language is printed, so that none can drift from another."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

#: CasADi's operations that the printers know, by our name.
_OPERATIONS = {
    ca.OP_ADD: "add",
    ca.OP_SUB: "sub",
    ca.OP_MUL: "mul",
    ca.OP_DIV: "div",
    ca.OP_NEG: "neg",
    ca.OP_SIN: "sin",
    ca.OP_COS: "cos",
    ca.OP_EXP: "exp",
    ca.OP_SQRT: "sqrt",
    ca.OP_FABS: "abs",
    ca.OP_POW: "pow",
    ca.OP_CONSTPOW: "pow",
}


@dataclass(frozen=True)
class Instruction:
    """One value: an operation on earlier values, a constant, or an input.

    op: a name of `_OPERATIONS`, "const" or "input". args: indices of earlier instructions; for an
    input, (which input, which element).
    """

    op: str
    args: tuple[int, ...] = ()
    value: float = 0.0


@dataclass(frozen=True)
class Listing:
    """A straight-line function.

    inputs: name -> number of elements. instructions: in order, each value once. outputs: name ->
    (shape, indices of instructions in row-major order).
    """

    name: str
    inputs: Mapping[str, int]
    instructions: tuple[Instruction, ...]
    outputs: Mapping[str, tuple[tuple[int, ...], tuple[int, ...]]]

    @property
    def operations(self) -> int:
        """Number of arithmetic and transcendental operations; constants and copies are free."""
        return sum(x.op not in ("const", "input") for x in self.instructions)

    def operations_by_kind(self) -> dict[str, int]:
        """Return the count of each operation, largest first."""
        kinds = Counter(x.op for x in self.instructions if x.op not in ("const", "input"))
        return dict(kinds.most_common())

    def part(self, name: str, inputs: Sequence[str], outputs: Sequence[str]) -> "Listing":
        """Return the listing of some outputs alone; they must not need more than the named inputs."""
        builder = Builder()
        position = {list(self.inputs).index(label): k for k, label in enumerate(inputs)}
        number: dict[int, int] = {}
        wanted = _needed(self, [i for label in outputs for i in self.outputs[label][1]])
        for index, x in enumerate(self.instructions):
            if index in wanted:
                args = (
                    (position[x.args[0]], x.args[1])
                    if x.op == "input"
                    else tuple(number.get(a, a) for a in x.args)
                )
                number[index] = builder.add(Instruction(x.op, args, x.value))
        shaped = {k: (self.outputs[k][0], tuple(number[i] for i in self.outputs[k][1])) for k in outputs}
        return builder.listing(name, {label: self.inputs[label] for label in inputs}, shaped)


def _needed(listing: Listing, indices: Sequence[int]) -> set[int]:
    seen: set[int] = set()
    waiting = list(indices)
    while waiting:
        index = waiting.pop()
        if index not in seen:
            seen.add(index)
            x = listing.instructions[index]
            waiting += () if x.op in ("const", "input") else x.args
    return seen


def from_casadi(name: str, inputs: Mapping[str, ca.SX], outputs: Mapping[str, ca.SX]) -> Listing:
    """List the instructions that CasADi needs for the outputs (matrices: row-major).

    inputs: name -> column of symbols. A constant 0 output stays a constant.
    """
    dense = [ca.densify(ca.vec(x.T)) for x in outputs.values()]
    function = ca.Function(name, list(inputs.values()), dense)
    builder = Builder()
    register: dict[int, int] = {}
    found: dict[tuple[int, int], int] = {}
    for k in range(function.n_instructions()):
        op, args, out = (
            function.instruction_id(k),
            function.instruction_input(k),
            function.instruction_output(k),
        )
        if op == ca.OP_OUTPUT:
            found[(out[0], out[1])] = register[args[0]]
        elif op == ca.OP_INPUT:
            register[out[0]] = builder.add(Instruction("input", (args[0], args[1])))
        elif op == ca.OP_CONST:
            register[out[0]] = builder.constant(function.instruction_constant(k))
        else:
            register[out[0]] = _translate(builder, op, [register[a] for a in args])
    shaped = {}
    for o, (label, matrix) in enumerate(outputs.items()):
        size = matrix.shape[0] * matrix.shape[1]
        indices = [found[(o, e)] if (o, e) in found else builder.constant(0.0) for e in range(size)]
        shape = (matrix.shape[0],) if matrix.shape[1] == 1 else matrix.shape
        shaped[label] = (shape, tuple(indices))
    return builder.listing(name, {label: x.shape[0] for label, x in inputs.items()}, shaped)


def shortest(name: str, inputs: Mapping[str, ca.SX], outputs: Mapping[str, ca.SX]) -> Listing:
    """List a function, with and without CasADi's own search for equal subexpressions; keep the shorter."""
    plain = from_casadi(name, inputs, outputs)
    shared = from_casadi(name, inputs, dict(zip(outputs, ca.cse([*outputs.values()]), strict=True)))
    return min((plain, shared), key=lambda x: x.operations)


def _translate(builder: "Builder", op: int, args: Sequence[int]) -> int:
    if op == ca.OP_SQ:
        return builder.add(Instruction("mul", (args[0], args[0])))
    if op == ca.OP_TWICE:
        return builder.add(Instruction("mul", (builder.constant(2.0), args[0])))
    if op == ca.OP_INV:
        return builder.add(Instruction("div", (builder.constant(1.0), args[0])))
    if op not in _OPERATIONS:
        raise NotImplementedError(f"CasADi operation {op} has no printer; add it to _OPERATIONS")
    return builder.add(Instruction(_OPERATIONS[op], tuple(args)))


class Builder:
    """Collects instructions, each distinct one once."""

    def __init__(self) -> None:
        self._instructions: list[Instruction] = []
        self._index: dict[Instruction, int] = {}

    def add(self, instruction: Instruction) -> int:
        """Return the index of the instruction, adding it where it is new (a+b and b+a are one)."""
        if instruction.op in ("add", "mul"):
            instruction = Instruction(instruction.op, tuple(sorted(instruction.args)))
        if instruction not in self._index:
            self._index[instruction] = len(self._instructions)
            self._instructions.append(instruction)
        return self._index[instruction]

    def constant(self, value: float) -> int:
        """Return the index of a constant."""
        return self.add(Instruction("const", (), float(value) + 0.0))

    def listing(
        self,
        name: str,
        inputs: Mapping[str, int],
        outputs: Mapping[str, tuple[tuple[int, ...], tuple[int, ...]]],
    ) -> Listing:
        """Return the listing with only what the outputs need, in the order of first need."""
        order: list[int] = []
        number: dict[int, int] = {}

        def visit(index: int) -> int:
            if index not in number:
                instruction = self._instructions[index]
                if instruction.op not in ("const", "input"):
                    for a in instruction.args:
                        visit(a)
                number[index] = len(order)
                order.append(index)
            return number[index]

        numbered = {
            label: (shape, tuple(visit(i) for i in indices)) for label, (shape, indices) in outputs.items()
        }
        final = []
        for index in order:
            x = self._instructions[index]
            args = x.args if x.op in ("const", "input") else tuple(number[a] for a in x.args)
            final.append(Instruction(x.op, args, x.value))
        return Listing(name, dict(inputs), tuple(final), numbered)


_NUMERIC = {
    "add": np.add, "sub": np.subtract, "mul": np.multiply, "div": np.divide, "neg": np.negative,
    "sin": np.sin, "cos": np.cos, "exp": np.exp, "sqrt": np.sqrt, "abs": np.abs, "pow": np.power,
}  # fmt: skip


def evaluate(listing: Listing, values: Mapping[str, Sequence[float]]) -> dict[str, np.ndarray]:
    """Run a listing on numbers: the reference for every printed form."""
    names = list(listing.inputs)
    results: list[float] = []
    for x in listing.instructions:
        if x.op == "const":
            results.append(x.value)
        elif x.op == "input":
            results.append(float(values[names[x.args[0]]][x.args[1]]))
        else:
            results.append(_NUMERIC[x.op](*(results[a] for a in x.args)))
    return {
        label: np.array([results[i] for i in indices]).reshape(shape)
        for label, (shape, indices) in listing.outputs.items()
    }
