"""Terms of a query that are missing from the store: the usual reason why a valid query finds nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, NamedTuple

from kg.similar import similar, suggest
from kg.syntax.lexer import Kind, Token, tokens
from kg.syntax.names import PREFIXES, shorten

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.store.interface import Snapshot

_NOT_LOOKED_UP: Final = frozenset({"xsd", "sh"})
"""Prefixes of terms that occur in queries but rarely in data: datatypes of literals, shapes."""

_FEW: Final = 3
_DEFINED: Final = """
SELECT DISTINCT ?term WHERE {
  VALUES ?kind { owl:Class owl:ObjectProperty owl:DatatypeProperty owl:NamedIndividual rdfs:Class rdf:Property }
  ?term a ?kind FILTER(ISIRI(?term))
}"""


class Unknown(NamedTuple):
    """A prefixed name that does not occur in the store, with suggestions."""

    token: Token
    suggestions: list[str]


def unknown_terms(snapshot: Snapshot, text: str) -> list[str]:
    """Return a sentence for each prefixed name of the query `text` that does not occur in the store."""
    missing = unknown(snapshot, text)
    return [f"`{each.token.text}` is not in the store. {suggest(each.suggestions) or ''}".strip() for each in missing]


def unknown(snapshot: Snapshot, text: str, further: Iterable[str] = ()) -> Iterator[Unknown]:
    """Yield each prefixed name of the query `text` that does not occur in the store, at its first occurrence.

    Suggestions are names that the store defines, and those of the IRIs `further`.
    """
    names: list[str] | None = None
    for token, iri in _names(text):
        ask = f"ASK {{ {{ ?s <{iri}> ?o }} UNION {{ ?s ?p <{iri}> }} UNION {{ <{iri}> ?p ?o }} }}"
        if not snapshot.query(ask):
            if names is None:
                rows: Any = snapshot.query(_DEFINED, prefixes=PREFIXES)
                names = sorted({shorten(iri) for iri in (*(row[0].value for row in rows), *further)})
            yield Unknown(token, _suggestions(token.text, [term for term in names if not term.startswith("<")]))


def _suggestions(name: str, names: list[str]) -> list[str]:
    """Return suggestions for a name: the same local name with another prefix, or a similar one with the same prefix."""
    prefix, _, local = name.partition(":")
    elsewhere = sorted(term for term in names if term.partition(":")[2].lower() == local.lower())
    alike = similar(local, (term.partition(":")[2] for term in names if term.startswith(f"{prefix}:")))
    return list(dict.fromkeys([*elsewhere, *(f"{prefix}:{each}" for each in alike)]))[:_FEW]


def _names(text: str) -> Iterator[tuple[Token, str]]:
    """Yield each prefixed name with a known prefix once, with its IRI; names with escapes are skipped."""
    seen = set()
    for token in tokens(text):
        prefix, _, local = token.text.partition(":")
        is_candidate = token.kind is Kind.NAME and prefix in PREFIXES and prefix not in _NOT_LOOKED_UP
        if is_candidate and local.isidentifier() and token.text not in seen:
            seen.add(token.text)
            yield token, PREFIXES[prefix] + local


def iris_of(text: str) -> set[str]:
    """Return the IRIs in a query, in full or as names with declared or known prefixes."""
    prefixes = dict(PREFIXES)
    iris = set()
    declared: str | None = None
    for token in tokens(text):
        if token.kind is Kind.IRI and declared is not None:
            prefixes[declared] = token.text[1:-1]
        elif token.kind is Kind.IRI:
            iris.add(token.text[1:-1])
        prefix, _, local = token.text.partition(":")
        if token.kind is Kind.NAME and prefix in prefixes and local:
            iris.add(prefixes[prefix] + local.replace("\\", ""))
        declared = prefix if token.kind is Kind.NAME and not local else None
    return iris
