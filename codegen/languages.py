"""How each language writes the listing's operations. A new language is one more `Language`."""

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from .listing import Instruction, Listing

#: Operators of all languages: text and binding strength.
_OPERATORS = {"add": (" + ", 1), "sub": (" - ", 1), "mul": ("*", 2), "div": ("/", 2)}
_NEGATION, _ATOM = 3, 4
#: Longer expressions are cut into named parts.
_WIDTH = 72


@dataclass(frozen=True)
class Language:
    """number: how a float is written. functions: operation -> format with one {} an argument."""

    name: str
    number: Callable[[float], str]
    functions: Mapping[str, str]


@dataclass(frozen=True)
class Statement:
    """`target = text`; targets are t1, t2, .. and the unpacked inputs q1, qd1, .."""

    target: str
    text: str


@dataclass(frozen=True)
class Body:
    """A printed listing: inputs that are used (name, input, element), statements, output expressions."""

    inputs: tuple[tuple[str, str, int], ...]
    statements: tuple[Statement, ...]
    outputs: Mapping[str, tuple[str, ...]]


def _urscript_number(value: float) -> str:
    """Write a decimal point always, and an exponent only behind digits (script manual, ch. 3)."""
    text = repr(value)
    mantissa, e, exponent = text.partition("e")
    return (mantissa if "." in mantissa else f"{mantissa}.0") + e + exponent


C = Language(
    "C99",
    repr,
    {
        "sin": "sin({})",
        "cos": "cos({})",
        "exp": "exp({})",
        "sqrt": "sqrt({})",
        "abs": "fabs({})",
        "pow": "pow({}, {})",
    },
)
NUMPY = Language(
    "NumPy",
    repr,
    {
        "sin": "np.sin({})",
        "cos": "np.cos({})",
        "exp": "np.exp({})",
        "sqrt": "np.sqrt({})",
        "abs": "np.abs({})",
        "pow": "np.power({}, {})",
    },
)
# URScript has no exp and no abs: pow of e, and norm, which of a float is its size (manual 5.11, ch. 16).
URSCRIPT = Language(
    "URScript",
    _urscript_number,
    {
        "sin": "sin({})",
        "cos": "cos({})",
        "exp": "pow(2.718281828459045, {})",
        "sqrt": "sqrt({})",
        "abs": "norm({})",
        "pow": "pow({}, {})",
    },
)


def body(listing: Listing, language: Language) -> Body:
    """Print a listing: values used once stand where they are used, the others get a name.

    The order of every operation is the listing's own, so all languages round alike.
    """
    uses = Counter(a for x in listing.instructions if x.op not in ("const", "input") for a in x.args)
    uses.update(i for _, indices in listing.outputs.values() for i in indices)
    names = list(listing.inputs)
    inputs: list[tuple[str, str, int]] = []
    statements: list[Statement] = []
    texts: list[tuple[str, int]] = []
    for index, x in enumerate(listing.instructions):
        if x.op == "input":
            name = f"{names[x.args[0]]}{x.args[1] + 1}"
            inputs.append((name, names[x.args[0]], x.args[1]))
            texts.append((name, _ATOM))
            continue
        text, strength = _expression(x, texts, language)
        if x.op != "const" and (uses[index] > 1 or len(text) > _WIDTH):
            statements.append(Statement(f"t{len(statements) + 1}", text))
            text, strength = statements[-1].target, _ATOM
        texts.append((text, strength))
    outputs = {label: tuple(texts[i][0] for i in indices) for label, (_, indices) in listing.outputs.items()}
    return Body(tuple(sorted(inputs, key=lambda x: (names.index(x[1]), x[2]))), tuple(statements), outputs)


def _expression(x: Instruction, texts: list[tuple[str, int]], language: Language) -> tuple[str, int]:
    if x.op == "const":
        text = language.number(x.value)
        return (text, _ATOM) if x.value >= 0 else (f"({text})", _ATOM)
    arguments = [texts[a] for a in x.args]
    if x.op == "neg":
        return f"-{_bound(arguments[0], _ATOM)}", _NEGATION
    if x.op in _OPERATORS:
        sign, strength = _OPERATORS[x.op]
        return f"{_bound(arguments[0], strength)}{sign}{_bound(arguments[1], strength + 1)}", strength
    return language.functions[x.op].format(*(text for text, _ in arguments)), _ATOM


def _bound(argument: tuple[str, int], strength: int) -> str:
    text, own = argument
    return text if own >= strength else f"({text})"
