"""The grammar's rules become nodes."""

# ruff: noqa: D102 - the methods are the rules of grammar.lark

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from lark import Token, Transformer

from . import nodes as n
from .errors import ScriptError

MAX_TERMS = 500
MAX_SUFFIXES = 30
MAX_BRANCHES = 500
MAX_INTEGER = 2**31
CONSTANTS: dict[str, bool | None] = {"TRUE": True, "FALSE": False, "NONE": None}
NUMBERS: dict[str, Callable[[str], float | int]] = {"INTEGER": int, "FLOAT": float}


def _at(token: Token) -> tuple[int, int]:
    return token.line or 1, token.column or 1


def _place(item: n.Node | Token) -> tuple[int, int]:
    return _at(item) if isinstance(item, Token) else (item.line, item.column)


class Builder(Transformer[Token, n.Script]):
    """Called by the parser bottom up, once per rule; methods bear the rules' names."""

    def start(self, items: list[n.Block]) -> n.Script:
        return n.Script(items[0])

    def block(self, items: list[n.Statement]) -> n.Block:
        return tuple(items)

    # statements

    def definition(self, items: list[Any]) -> n.Define:
        kind, name, *parameters, body, end = (item for item in items if not _is_punctuation(item))
        if kind != "def" and parameters:
            raise ScriptError(f"a {kind} takes no parameters", *_place(parameters[0]), "thread-parameters")
        keyword: Any = str(kind)
        return n.Define(*_at(kind), keyword, str(name), tuple(parameters), body, *_at(end))

    def parameter(self, items: list[Any]) -> n.Parameter:
        return n.Parameter(*_at(items[0]), str(items[0]), items[1] if len(items) > 1 else None)

    def conditional(self, items: list[Any]) -> n.If:
        branches: list[n.Branch] = []
        otherwise: n.Block = ()
        parts = iter(items)
        for keyword in parts:
            if keyword.type in ("IF", "ELIF"):
                branches.append(n.Branch(*_at(keyword), next(parts), next(parts)))
            elif keyword.type == "ELSE":
                otherwise = next(parts)
        if len(branches) > MAX_BRANCHES:
            raise ScriptError(f"more than {MAX_BRANCHES} branches; split this up", *_at(items[0]), "nesting")
        return n.If(*_at(items[0]), tuple(branches), otherwise)

    def loop(self, items: list[Any]) -> n.While:
        return n.While(*_at(items[0]), items[1], items[2])

    def give_back(self, items: list[Any]) -> n.Return:
        return n.Return(*_at(items[0]), items[1] if len(items) > 1 else None)

    def command(self, items: list[Token]) -> n.Command:
        return n.Command(*_at(items[0]), str(items[0]))

    def handle(self, items: list[Any]) -> n.Handle:
        return n.Handle(*_at(items[0]), str(items[0]), items[1])

    def declare(self, items: list[Any]) -> n.Assign:
        keyword, name, value = items
        scope: Any = str(keyword)
        return n.Assign(*_at(keyword), scope, n.Name(*_at(name), str(name)), value)

    def assign(self, items: list[Any]) -> n.Assign:
        target, value = items
        root = target
        while isinstance(root, n.Index | n.Member):
            root = root.base
        if not isinstance(root, n.Name):
            raise ScriptError(
                "this cannot be assigned; only a variable, element or member can", *_place(target)
            )
        return n.Assign(*_place(root), "", target, value)

    def evaluate(self, items: list[n.Expression]) -> n.Evaluate:
        value = items[0]
        if not isinstance(value, n.Call | n.Run):
            reason = "a value alone is no statement; call it with `()` or assign it"
            raise ScriptError(reason, *_place(value))
        return n.Evaluate(*_place(value), value)

    def label(self, items: list[Token]) -> n.Label:
        text = str(items[2])[1:-1] if len(items) > 2 else ""
        return n.Label(*_at(items[0]), int(items[1][:9]), text)

    # expressions

    def binary(self, items: list[Any]) -> n.Expression:
        if len(items) > 2 * MAX_TERMS:
            raise ScriptError(f"more than {MAX_TERMS} terms; split this up", *_place(items[-1]), "nesting")
        result: n.Expression = items[0]
        for operator, right in zip(items[1::2], items[2::2], strict=True):
            result = n.Binary(*_at(operator), str(operator), result, right)
        return result

    def unary(self, items: list[Any]) -> n.Expression:
        *signs, result = items
        if len(signs) > MAX_SUFFIXES:
            raise ScriptError(f"more than {MAX_SUFFIXES} signs in a row", *_at(signs[0]), "nesting")
        for sign in reversed(signs):
            result = n.Unary(*_at(sign), "not" if sign == "!" else str(sign), result)
        return result  # type: ignore[no-any-return]

    def name(self, items: list[Token]) -> n.Name:
        return n.Name(*_at(items[0]), str(items[0]))

    def call(self, items: list[Any]) -> n.Call:
        function, *arguments = (item for item in items if not _is_punctuation(item))
        if not isinstance(function, n.Name | n.Member):
            raise ScriptError("only a named function can be called", *_place(function))
        _limit_suffixes(function)
        _check_argument_order(arguments)
        return n.Call(*_place(function), function, tuple(arguments))

    def named(self, items: list[Any]) -> n.Argument:
        return n.Argument(*_at(items[0]), str(items[0]), items[1])

    def positional(self, items: list[n.Expression]) -> n.Argument:
        return n.Argument(*_place(items[0]), None, items[0])

    def index(self, items: list[Any]) -> n.Expression:
        base, bracket, *indices = items
        # `p` is no keyword: `p[i]` is an element of a variable p, and six items make a pose.
        if isinstance(base, n.Name) and base.name == "p" and len(indices) == 6:
            return n.PoseDisplay(base.line, base.column, tuple(indices))
        _limit_suffixes(base)
        if not 1 <= len(indices) <= 2:
            wanted = "a pose has 6 elements" if getattr(base, "name", "") == "p" else "write a[i] or m[i, j]"
            raise ScriptError(f"{len(indices)} indices; {wanted}", *_at(bracket), "index-count")
        return n.Index(*_at(bracket), base, tuple(indices))

    def member(self, items: list[Any]) -> n.Member:
        _limit_suffixes(items[0])
        return n.Member(*_at(items[1]), items[0], str(items[2]))

    def list_display(self, items: list[Any]) -> n.ListDisplay:
        return n.ListDisplay(*_at(items[0]), tuple(items[1:]))

    def literal(self, items: list[Token]) -> n.Literal:
        token = items[0]
        if token.type in CONSTANTS:
            return n.Literal(*_at(token), CONSTANTS[token.type])
        if token.type == "STRING":
            return n.Literal(*_at(token), str(token)[1:-1])
        if token.type == "INTEGER" and (len(token) > 30 or int(token) > MAX_INTEGER):
            reason = f"{token[:30]} does not fit an integer of 32 bits; write it with a decimal point"
            raise ScriptError(reason, *_at(token), "integer-range")
        return n.Literal(*_at(token), NUMBERS[token.type](token))

    def run(self, items: list[Token]) -> n.Run:
        return n.Run(*_at(items[0]), str(items[1]))


def _is_punctuation(item: object) -> bool:
    return isinstance(item, Token) and item.type in ("LPAR", "RPAR")


def _limit_suffixes(base: n.Expression) -> None:
    for _ in range(MAX_SUFFIXES):
        if isinstance(base, n.Index | n.Member):
            base = base.base
        elif isinstance(base, n.Call):
            base = base.function
        else:
            return
    raise ScriptError(f"more than {MAX_SUFFIXES} suffixes in a row", *_place(base), "nesting")


def _check_argument_order(arguments: list[n.Argument]) -> None:
    named = False
    for argument in arguments:
        if argument.name is None and named:
            raise ScriptError("a positional argument after a named one", *_place(argument), "argument-order")
        named = named or argument.name is not None
