"""What a query looks like that nothing is known of: as if it ended soon, or as if it might not."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.query.lexer import Kind, normalise, tokens

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.query.lexer import Token

__all__ = ["looks_bounded"]

_MOST_CHARACTERS: Final = 4096
"""A longer text is not looked at: that would cost the process that all requests go through more than a moment."""
_MOST_GROUPS: Final = 8
"""With so many that do not hang together yet it is not looked any further."""
_ENDS: Final = frozenset({".", "{", "}"})
_CONSTANTS: Final = frozenset({Kind.IRI, Kind.NAME, Kind.STRING, Kind.NUMBER})


def looks_bounded(text: str) -> bool:
    """Tell whether each pattern of a query has a constant, and all that have variables hang together by these.

    It is a guess that costs little: joins that end soon may look otherwise, and those that do not end may look like it.
    """
    if len(text) > _MOST_CHARACTERS:
        return False
    groups: list[set[str]] = []
    for pattern in _patterns(tokens(normalise(text))):
        variables = {token.text[1:] for token in pattern if token.kind is Kind.VARIABLE}
        if not variables:
            continue
        if not any(token.kind in _CONSTANTS or token.text == "a" for token in pattern):
            return False
        apart = [group for group in groups if group.isdisjoint(variables)]
        groups = [*apart, variables.union(*(group for group in groups if group not in apart))]
        if len(groups) > _MOST_GROUPS:
            break
    return len(groups) <= 1


def _patterns(found: Iterable[Token]) -> Iterator[list[Token]]:
    """Yield the triple patterns with the same subject: what stands between dots and braces, without clauses."""
    pattern: list[Token] = []
    depth = 0
    for token in found:
        if token.kind is not Kind.SIGN or token.text not in _ENDS:
            pattern.append(token)
            continue
        if depth and pattern and not _is_clause(pattern[0]):
            yield pattern
        pattern = []
        depth += (token.text == "{") - (token.text == "}")


def _is_clause(first: Token) -> bool:
    """Tell whether this begins anything else than triples: FILTER, OPTIONAL, SELECT."""
    return first.kind is Kind.WORD and first.text not in {"a", "true", "false"}
