"""Where names and variables are in the text of a rule."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.rules.checks.finding import at_offset, at_rule
from kg.syntax.lexer import Kind, Token, iri_of, is_name, normalise, tokens

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.errors import Place
    from kg.rules.files import RuleFile

_DECLARING: Final = {"PREFIX": 2, "@PREFIX": 2, "BASE": 1, "@BASE": 1, "IMPORTS": 1, "VERSION": 1, "@VERSION": 1}
"""How many tokens belong to a declaration that begins with these."""


def names(file: RuleFile) -> Iterator[tuple[str, Token]]:
    """Yield each name of a file as an IRI with its token; declarations of prefixes are left out.

    So are the names inside the queries of SHACL rules, which are strings to Turtle.
    """
    declaring = 0
    for token in tokens(normalise(file.text)):
        if token.kind in {Kind.WORD, Kind.TAG} and token.text.upper() in _DECLARING:
            declaring = _DECLARING[token.text.upper()]
        elif declaring:
            declaring -= 1
        elif is_name(token) and (iri := iri_of(token, file.prefixes)) is not None:
            yield iri, token


def place_of_name(file: RuleFile, iri: str) -> Place:
    """Return where a file first names an IRI, else the place of its first rule."""
    return next((at_offset(file, token.start) for name, token in names(file) if name == iri), at_rule(file))


def variables(file: RuleFile) -> Iterator[Token]:
    """Yield the variables of a file in the order of the text; in Turtle there are none."""
    if file.notation != ".ttl":
        yield from (token for token in tokens(normalise(file.text)) if token.kind is Kind.VARIABLE)
