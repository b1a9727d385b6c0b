"""Jinja templates, and what renders them; the tree mirrors the output tree of gen-model."""

from collections.abc import Callable, Mapping
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined


def renderer(filters: Mapping[str, Callable[..., Any]] | None = None, *, html: bool = False) -> Environment:
    """Return a Jinja environment for the templates here; a name that they are not given is an error.

    filters: name in the templates -> function, besides Jinja's own. html: escape what is filled in and drop
    the lines of blocks; otherwise the text comes out as it stands, to the last line's end.
    """
    found = Environment(
        loader=PackageLoader("residuum.templates", ""),
        undefined=StrictUndefined,
        autoescape=html,
        trim_blocks=html,
        lstrip_blocks=html,
        keep_trailing_newline=not html,
    )
    found.filters |= filters or {}
    return found
