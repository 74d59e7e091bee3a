"""Colours of a query: spans of its text with the class of their style, from the same tokens that guards see."""

from __future__ import annotations

import re
from bisect import bisect_right
from typing import TYPE_CHECKING, Final, NamedTuple

from kg.syntax.lexer import Kind, tokens

if TYPE_CHECKING:
    from collections.abc import Iterator

CLASSES: Final = ("comment", "iri", "string", "variable", "name", "keyword", "number")
"""Kinds of spans; `sparql--KIND` is the class of the style."""

_KINDS: Final = {
    Kind.IRI: "iri",
    Kind.STRING: "string",
    Kind.VARIABLE: "variable",
    Kind.NAME: "name",
    Kind.WORD: "keyword",
    Kind.NUMBER: "number",
    Kind.TAG: "string",
}
_COMMENT: Final = re.compile(r"#[^\n]*")


class Span(NamedTuple):
    """A stretch of a text with its kind."""

    start: int
    end: int
    kind: str


def spans(text: str) -> Iterator[Span]:
    """Yield the spans of a normalised query that have a colour, in order; comments stand between tokens."""
    position = 0
    for token in tokens(text):
        yield from _comments(text, position, token.start)
        position = token.end
        if token.kind in _KINDS:
            yield Span(token.start, token.end, _KINDS[token.kind])
    yield from _comments(text, position, len(text))


def _comments(text: str, start: int, end: int) -> Iterator[Span]:
    for found in _COMMENT.finditer(text, start, end):
        yield Span(found.start(), found.end(), "comment")


def line_starts(text: str) -> list[int]:
    """Return the offset of the first character of each line."""
    return [0, *(found.end() for found in re.finditer("\n", text))]


def line_spans(text: str) -> dict[int, list[Span]]:
    """Return the spans by line, with columns in place of offsets; one of several lines has a part in each."""
    starts = line_starts(text)
    found: dict[int, list[Span]] = {}
    for span in spans(text):
        line = bisect_right(starts, span.start) - 1
        while line < len(starts) and starts[line] < span.end:
            end = starts[line + 1] - 1 if line + 1 < len(starts) else len(text)
            part = Span(max(span.start - starts[line], 0), min(span.end, end) - starts[line], span.kind)
            found.setdefault(line, []).append(part)
            line += 1
    return found
