"""Where names and variables stand in the text of a rule."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.query.lexer import Kind, normalise, tokens
from kg.rules.checks.finding import at_offset, at_rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.errors import Place
    from kg.query.lexer import Token
    from kg.rules.files import RuleFile

__all__ = ["names", "place_of_name", "variables"]


def _code(file: RuleFile) -> Iterator[Token]:
    """Yield the tokens of a rule in one of the notations that are like SPARQL; of Turtle nothing is read."""
    if file.notation != ".ttl":
        yield from tokens(normalise(file.text))


def names(file: RuleFile) -> Iterator[tuple[str, Token]]:
    """Yield each name of a file as an IRI with its token; declarations of prefixes are left out."""
    prefixes = file.prefixes or {}
    declaring = 0
    for token in _code(file):
        if token.kind is Kind.WORD and token.text.upper() in {"PREFIX", "BASE", "IMPORTS", "VERSION"}:
            declaring = 2 if token.text.upper() == "PREFIX" else 1
        elif declaring:
            declaring -= 1
        elif token.kind is Kind.IRI:
            yield token.text[1:-1], token
        elif token.kind is Kind.NAME and not token.text.startswith("_:"):
            prefix, _, local = token.text.partition(":")
            if prefix in prefixes:
                yield prefixes[prefix] + local.replace("\\", ""), token


def place_of_name(file: RuleFile, iri: str) -> Place:
    """Return where a file first names an IRI, else the place of its first rule."""
    return next((at_offset(file, token.start) for found, token in names(file) if found == iri), at_rule(file))


def variables(file: RuleFile) -> Iterator[Token]:
    """Yield the variables of a file in the order of the text."""
    yield from (token for token in _code(file) if token.kind is Kind.VARIABLE)
