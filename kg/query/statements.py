"""Split a text with several queries, as in editors.

SPARQL has no separator between queries. After the form of a query, a new one begins outside of all brackets at the
first word of a prologue (`PREFIX`, `BASE`) or of a form (`SELECT`, ...). Comments and whitespace before that belong to
the previous query.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final, NamedTuple

from kg.syntax.lexer import Kind, tokens

_PROLOGUE: Final = frozenset({"prefix", "base"})
_FORMS: Final = frozenset({"select", "construct", "ask", "describe"})


class Statement(NamedTuple):
    """A query with its start and end offsets."""

    text: str
    start: int
    end: int


def statements(text: str) -> Iterator[Statement]:
    """Yield the queries in a normalised text, each from its first token to its last."""
    start = end = 0
    has_form = begun = False
    depth = 0
    for token in tokens(text):
        word = token.text.lower() if token.kind is Kind.WORD and depth == 0 else ""
        if begun and has_form and (word in _FORMS or word in _PROLOGUE):
            yield Statement(text[start:end], start, end)
            begun = has_form = False
        if not begun:
            start, begun = token.start, True
        has_form = has_form or word in _FORMS
        if token.kind is Kind.SIGN:
            depth = max(0, depth + (token.text in {"{", "("}) - (token.text in {"}", ")"}))
        end = token.end
    if begun:
        yield Statement(text[start:end], start, end)


def statement_at(text: str, offset: int) -> Statement | None:
    """Return the query that contains or precedes `offset`; the first one if it precedes all, None if there is none."""
    statement = None
    for one in statements(text):
        if statement is not None and one.start > offset:
            return statement
        statement = one
    return statement


def segment_at(text: str, offset: int) -> Statement:
    """Return the query at `offset` with the whitespace and comments after it, up to the next query."""
    starts = [one.start for one in statements(text)]
    begin = max((start for start in starts[1:] if start <= offset), default=0)
    end = next((start for start in starts[1:] if start > offset), len(text))
    return Statement(text[begin:end], begin, end)
