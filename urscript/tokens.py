"""One pass over the tokens before parsing: what nests too deep, and which block is left open."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from lark import Token

from .errors import ScriptError

MAX_BRACKETS = 40
MAX_BLOCKS = 30
OPENERS = frozenset({"DEF", "SEC", "THREAD", "IF", "WHILE"})
OPERAND_ENDS = frozenset({"NAME", "INTEGER", "FLOAT", "STRING", "TRUE", "FALSE", "NONE", "RPAR", "RSQB"})
CONTINUING = frozenset({"LPAR", "LSQB", "MINUS", "PLUS"})


@dataclass(frozen=True, slots=True)
class Outline:
    """What the tokens alone tell.

    Attributes:
        open_blocks: openers without their `end`, outermost first.
        suspect: the first opener whose `end` stands further left than itself; if an `end` is missing, it is
            this one's.
        stray_end: the first `end` that closes nothing.
        continued: tokens that begin a line and silently continue the expression above.

    """

    open_blocks: tuple[Token, ...]
    suspect: Token | None
    stray_end: Token | None
    continued: tuple[Token, ...]


def outline(tokens: Iterable[Token]) -> Outline:
    """Follow brackets and blocks through the text.

    Raises:
        ScriptError: nesting deeper than `MAX_BRACKETS` or `MAX_BLOCKS`.

    """
    blocks: list[Token] = []
    continued: list[Token] = []
    suspect: Token | None = None
    stray: Token | None = None
    for before, token, depth in _with_depth(tokens):
        if token.type in OPENERS:
            blocks.append(token)
            _limit(len(blocks), MAX_BLOCKS, "blocks", token)
        elif token.type == "END":
            if blocks:
                opener = blocks.pop()
                suspect = suspect or (opener if _dedented(opener, token) else None)
            else:
                stray = stray or token
        elif depth == 0 and before is not None and _continues(before, token):
            continued.append(token)
    return Outline(tuple(blocks), suspect, stray, tuple(continued))


def _with_depth(tokens: Iterable[Token]) -> Iterator[tuple[Token | None, Token, int]]:
    """Each token with the one before it and the bracket depth it stands at."""
    depth = 0
    before: Token | None = None
    for token in tokens:
        if token.type in ("RPAR", "RSQB"):
            depth = max(0, depth - 1)
        yield before, token, depth
        if token.type in ("LPAR", "LSQB"):
            depth += 1
            _limit(depth, MAX_BRACKETS, "brackets", token)
        before = token


def _continues(before: Token, token: Token) -> bool:
    new_line = (token.line or 0) > (before.end_line or 0)
    return new_line and token.type in CONTINUING and before.type in OPERAND_ENDS


def _dedented(opener: Token, end: Token) -> bool:
    return end.line != opener.line and (end.column or 0) < (opener.column or 0)


def _limit(depth: int, limit: int, what: str, token: Token) -> None:
    if depth > limit:
        raise ScriptError(
            f"more than {limit} {what} inside each other; split this up",
            token.line or 1,
            token.column or 1,
            "nesting",
        )
