"""Text to syntax tree.

Source: script manual e-Series 5.11, chapters 2 to 9. Where the manual is silent (precedence of the logical
operators, escapes in strings) docs/urscript.md says what was assumed.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

from lark import Lark, Token
from lark.exceptions import UnexpectedCharacters, UnexpectedInput, UnexpectedToken, VisitError

from .builder import Builder
from .errors import ScriptError
from .nodes import Define, Script
from .tokens import Outline, outline

FIRST_OF_EXPRESSION = frozenset({"LPAR", "LSQB", "MINUS", "INTEGER", "FLOAT", "STRING", "TRUE"})


@cache
def grammar() -> Lark:
    """Give the LALR(1) parser tables, built once."""
    text = Path(__file__).with_name("grammar.lark").read_text(encoding="ascii")
    return Lark(text, parser="lalr", lexer="basic", transformer=Builder(), maybe_placeholders=False)


def parse(text: str) -> Script:
    """Parse any URScript text: a program, several functions, or bare statements.

    Raises:
        ScriptError: one message with the line and column of the first error.

    """
    shape = scan(text)
    try:
        tree = grammar().parse(text)
    except VisitError as error:
        if isinstance(error.orig_exc, ScriptError):
            raise error.orig_exc from None
        raise
    except UnexpectedInput as error:
        raise _readable(error, text, shape) from None
    assert isinstance(tree, Script)  # the transformer's result; Lark types it as a Tree
    return tree


def parse_program(text: str) -> Define:
    """Parse a text that is one program: a single `def name(): ... end` or `sec name(): ... end`.

    Raises:
        ScriptError: a syntax error, or anything before, after or instead of the program.

    """
    body = parse(text).body
    if not body or not isinstance(body[0], Define) or body[0].kind == "thread":
        line, column = (body[0].line, body[0].column) if body else (1, 1)
        raise ScriptError("a program starts with `def name():`", line, column, "framing")
    if len(body) > 1:
        raise ScriptError(
            "text after the program's `end`; the controller takes one program",
            body[1].line,
            body[1].column,
            "framing",
        )
    return body[0]


def scan(text: str) -> Outline:
    """Give the outline of blocks and brackets, without parsing.

    Raises:
        ScriptError: a character that starts no token, or nesting beyond the limits.

    """
    try:
        return outline(grammar().lex(text))
    except UnexpectedCharacters as error:
        raise _bad_character(error, text) from None


def _bad_character(error: UnexpectedCharacters, text: str) -> ScriptError:
    position = error.pos_in_stream or 0
    found = text[position : position + 1]
    if found == '"':
        return ScriptError("the string is not closed on its line", error.line, error.column, "open-string")
    if found == "^":
        reason = "there is no power operator `^`; write pow(base, exponent) or a product"
        return ScriptError(reason, error.line, error.column, "power")
    hint = "; strings take double quotes" if found == "'" else ""
    reason = f"{found!a} has no place in URScript{hint}"
    return ScriptError(reason, error.line, error.column, "character")


def _readable(error: UnexpectedInput, text: str, shape: Outline) -> ScriptError:
    if not isinstance(error, UnexpectedToken):
        return ScriptError("not understood", getattr(error, "line", 1), getattr(error, "column", 1))
    token = error.token
    if token.type == "$END":
        return _unfinished(text, shape)
    line, column = token.line or 1, token.column or 1
    if token is shape.stray_end or (token.type == "END" and shape.stray_end is not None):
        return ScriptError("this `end` closes nothing", line, column, "extra-end")
    before = text[: token.start_pos or 0].rstrip()
    if token == "*" and before.endswith("*"):
        return ScriptError(
            "there is no power operator `**`; write pow(base, exponent)", line, column, "power"
        )
    return ScriptError(_unexpected(token, error.accepts or error.expected), line, column)


def _unfinished(text: str, shape: Outline) -> ScriptError:
    if shape.open_blocks:
        opener = shape.suspect or shape.open_blocks[-1]
        reason = f"`{opener}` is never closed; its `end` is missing"
        return ScriptError(reason, opener.line or 1, opener.column or 1, "missing-end")
    lines = text.rstrip().split("\n")
    return ScriptError("the text stops in the middle of a statement", len(lines), len(lines[-1]) + 1)


def _unexpected(token: Token, expected: set[str]) -> str:
    found = f"unexpected {ascii(str(token))[:40]}"
    if token.type == "EQUAL":
        return f"{found}: only a variable, an element or a member can be assigned (comparison is `==`)"
    if token.type == "COMPARE":
        return f"{found}: a comparison is no statement and does not chain; join two with `and`"
    if expected >= FIRST_OF_EXPRESSION:
        return f"{found} where a value should stand"
    if len(expected) == 1:
        return f"{found}, expected {_spoken(next(iter(expected)))}"
    if "COLON" in expected:
        return f"{found}, the condition ends with `:`"
    if token.type == "ELSE" or token.type == "ELIF":
        return f"{found} without an open `if`"
    if "RPAR" in expected or "RSQB" in expected:
        return f"{found}, a `,` or the closing bracket is missing"
    return f"{found} here"


def _spoken(terminal: str) -> str:
    names = {"NAME": "a name", "COLON": "`:`", "LPAR": "`(`", "RPAR": "`)`", "EQUAL": "`=`", "END": "`end`"}
    return names.get(terminal, terminal.lower())
