"""Terms of a query that the store does not know: the usual reason why a query that parses finds nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from kg.query.lexer import Kind, tokens
from kg.query.prefixes import PREFIXES, shorten
from kg.query.similar import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.store.interface import Snapshot

__all__ = ["iris_of", "unknown_terms"]

_NOT_LOOKED_UP: Final = frozenset({"xsd", "sh"})
"""Prefixes whose terms stand in queries but seldom in data: data types of literals, shapes."""

_DEFINED: Final = """
SELECT DISTINCT ?term WHERE {
  VALUES ?kind { owl:Class owl:ObjectProperty owl:DatatypeProperty owl:NamedIndividual rdfs:Class rdf:Property }
  ?term a ?kind FILTER(ISIRI(?term))
}"""


def unknown_terms(snapshot: Snapshot, text: str) -> list[str]:
    """Return a sentence for each prefixed name of the query `text` that occurs nowhere in the store."""
    known: list[str] | None = None
    found = []
    for name, iri in _names(text):
        ask = f"ASK {{ {{ ?s <{iri}> ?o }} UNION {{ ?s ?p <{iri}> }} UNION {{ <{iri}> ?p ?o }} }}"
        if not snapshot.query(ask):
            if known is None:
                rows: Any = snapshot.query(_DEFINED, prefixes=PREFIXES)
                known = [shorten(row[0].value) for row in rows]
            hint = did_you_mean(name, [term for term in known if not term.startswith("<")])
            found.append(f"`{name}` is not in the store. {hint or ''}".strip())
    return found


def _names(text: str) -> Iterator[tuple[str, str]]:
    """Yield each prefixed name of a known prefix once, with its IRI; names with escapes are left out."""
    seen = set()
    for token in tokens(text):
        prefix, _, local = token.text.partition(":")
        known = token.kind is Kind.NAME and prefix in PREFIXES and prefix not in _NOT_LOOKED_UP
        if known and local.isidentifier() and token.text not in seen:
            seen.add(token.text)
            yield token.text, PREFIXES[prefix] + local


def iris_of(text: str) -> set[str]:
    """Return the IRIs that a query mentions, written out or as names of prefixes that it declares or that are known."""
    prefixes = dict(PREFIXES)
    found = set()
    declared: str | None = None
    for token in tokens(text):
        if token.kind is Kind.IRI and declared is not None:
            prefixes[declared] = token.text[1:-1]
        elif token.kind is Kind.IRI:
            found.add(token.text[1:-1])
        prefix, _, local = token.text.partition(":")
        if token.kind is Kind.NAME and prefix in prefixes and local:
            found.add(prefixes[prefix] + local.replace("\\", ""))
        declared = prefix if token.kind is Kind.NAME and not local else None
    return found
