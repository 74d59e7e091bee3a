"""Values of properties, and names of graphs: candidates where a term is expected."""

from __future__ import annotations

import re
from itertools import islice
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import msgspec
from pyoxigraph import Literal, NamedNode

from kg.syntax.names import PREFIXES, shorten

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from kg.query.completion.keeping import SnapshotCache

_MOST: Final = 50_000
"""Largest number of cached values of a property; the most frequent ones are cached."""
_IRI: Final = re.compile(r"[A-Za-z][\w+.-]*:[^\x00-\x20<>\"{}|^`\\]*", re.ASCII)
"""Valid text between angle brackets; an unfinished query may contain any text as an IRI."""
_XSD: Final = PREFIXES["xsd"]
_BARE: Final = frozenset({_XSD + "integer", _XSD + "boolean", _XSD + "decimal"})


class Value(msgspec.Struct, frozen=True, array_like=True):
    """A term in SPARQL syntax (`written`), its label or text, and the number of its occurrences."""

    written: str
    text: str
    count: int


class Values(NamedTuple):
    """Values, the most frequent first, and their texts in lower case."""

    values: list[Value]
    lower: list[str]

    def holding(self, typed: str) -> Iterator[Value]:
        """Yield values whose text contains `typed`, up to the number of candidates; if there are few values, all."""
        wanted = typed.lower()
        if len(self.values) <= _FEW:
            yield from self.values
            return
        matches = (value for value, lower in zip(self.values, self.lower, strict=True) if wanted in lower)
        yield from islice(matches, _OFFERED)


_FEW: Final = 1000
"""Up to this number, all values are candidates and the matcher ranks them."""
_OFFERED: Final = 500
_OF_CLASS: Final = "?s a <%s> ."
_COUNTED: Final = "SELECT ?o (COUNT(*) AS ?n) { %s ?s <%s> ?o } GROUP BY ?o"
_LABELLED: Final = "SELECT ?o ?n ?l { { %s } OPTIONAL { ?o rdfs:label ?l } }"
_PROPERTIES: Final = "SELECT ?p (COUNT(*) AS ?n) { <%s> ?p ?o } GROUP BY ?p"


def values(cache: SnapshotCache, iri: str, kind: str | None, *, literal: bool) -> Values:
    """Return the values of the property `iri`, of instances of `kind` or of any subject."""

    def make() -> list[Value]:
        if not all(_IRI.fullmatch(each) for each in (iri, kind) if each is not None):
            return []
        counted = _COUNTED % (_OF_CLASS % kind if kind else "", iri)
        rows: Any = cache.snapshot.query(counted if literal else _LABELLED % counted, prefixes=PREFIXES)
        by_term = {
            row[0]: _value(row[0], int(row[1].value), None if literal else row[2])
            for row in rows
            if isinstance(row[0], NamedNode | Literal)
        }
        return sorted(by_term.values(), key=lambda value: (-value.count, value.text))[:_MOST]

    return _lowered(cache, f"values {iri} {kind}", make)


def _lowered(cache: SnapshotCache, key: str, make: Callable[[], list[Value]]) -> Values:
    content = cache.values(key, make, list[Value])
    return cache.in_memory(key, lambda: Values(content, [value.text.lower() for value in content]))


def _value(term: NamedNode | Literal, count: int, label: Literal | None) -> Value:
    if isinstance(term, NamedNode):
        written = shorten(term.value)
        return Value(written, label.value if label else written, count)
    return Value(term.value if term.datatype.value in _BARE else str(term), term.value, count)


def graphs(cache: SnapshotCache) -> Values:
    """Return the named graphs."""

    def make() -> list[Value]:
        return [Value(shorten(graph.value), graph.value, 0) for graph in cache.snapshot.graphs()]

    return _lowered(cache, "graphs", make)


def of_iri(cache: SnapshotCache, iri: str) -> dict[str, int]:
    """Return the properties of an IRI, with their numbers of values."""
    if not _IRI.fullmatch(iri):
        return {}
    rows: Any = cache.snapshot.query(_PROPERTIES % iri)
    return {row[0].value: int(row[1].value) for row in rows}
