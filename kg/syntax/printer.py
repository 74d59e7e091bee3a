"""Prints a text of SPARQL again with some of its tokens spelt differently; all else stays as it is written."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.syntax.lexer import Kind, tokens_of

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from kg.syntax.lexer import Token

__all__ = ["renamed", "respelt"]


def respelt(text: str, spelling: Callable[[Token], str | None]) -> str:
    """Return a text with another spelling for each token that `spelling` gives one."""
    pieces, end = [], 0
    for token in tokens_of(text):
        new = spelling(token)
        if new is not None:
            pieces += [text[end : token.start], new]
            end = token.end
    return "".join(pieces) + text[end:]


def renamed(text: str, names: Mapping[str, str]) -> str:
    """Return a text with other names for some variables, by their names without `?`; it may be a whole group."""

    def spelling(token: Token) -> str | None:
        new = names.get(token.text[1:]) if token.kind is Kind.VARIABLE else None
        return None if new is None else f"?{new}"

    return respelt(text, spelling)
