"""Classes and properties of a store, which of them occur together, and how often.

All classes and properties are counted. The properties of a class come from a sample of its instances, the classes of a
property's values from a sample of the values. The engine orders terms by their hashes, so the first few hundred entries
of an index are a random sample. Numbers up to the size of the sample are exact; larger ones are estimates, rounded to
the significant digits. On five million quads this takes 6 s of processor time; counting all pairs of class and property
takes 21 s.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, Protocol, TypeVar

import msgspec

from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from kg.store.interface import Snapshot

_Part = TypeVar("_Part")

SAMPLE: Final = 300
"""Number of sampled instances of a class."""
_VALUES: Final = 500
"""Number of sampled triples of a property, for the classes of its values."""
_DIGITS: Final = 2
_LONGEST: Final = 600
"""Largest length of a comment in characters; longer ones are cut."""


class Statistics(msgspec.Struct, frozen=True):
    """Statistics of the content of one snapshot.

    `classes` contains the number of instances of each class, `properties` the number of triples of each property.
    `used` maps a class and a property to the number of instances with it, `leads` a property and a class to the number
    of sampled values of that class. `literal` contains the properties with literals, `comments` the documentation of
    terms, and `prefixes` the prefixes that the store declares. IRIs are without brackets.
    """

    classes: dict[str, int] = {}
    properties: dict[str, int] = {}
    used: dict[str, dict[str, int]] = {}
    leads: dict[str, dict[str, int]] = {}
    literal: frozenset[str] = frozenset()
    comments: dict[str, str] = {}
    prefixes: dict[str, str] = {}


_CLASSES: Final = "SELECT ?c (COUNT(?s) AS ?n) { ?s a ?c FILTER(ISIRI(?c)) } GROUP BY ?c"
_PROPERTIES: Final = "SELECT ?p (COUNT(*) AS ?n) { ?s ?p ?o } GROUP BY ?p"
_USED: Final = """
SELECT ?p (COUNT(DISTINCT ?s) AS ?n) { { SELECT ?s { ?s a <%s> } LIMIT %d } ?s ?p ?o } GROUP BY ?p"""
_USERS: Final = "SELECT ?c (COUNT(DISTINCT ?s) AS ?n) { ?s <%s> ?o . ?s a ?c FILTER(ISIRI(?c)) } GROUP BY ?c"
_LEADS: Final = """
SELECT ?c (COUNT(DISTINCT ?o) AS ?n) {
  { SELECT ?o { ?s <%s> ?o } LIMIT %d } ?o a ?c FILTER(ISIRI(?c)) } GROUP BY ?c"""
_LITERAL: Final = "SELECT ?o { ?s <%s> ?o } LIMIT 1"
_COMMENTS: Final = """
SELECT ?t ?c { ?t rdfs:comment|skos:definition ?c . FILTER(ISIRI(?t) && (LANG(?c) = "" || LANGMATCHES(LANG(?c), "en")))
  { ?t a ?kind VALUES ?kind { rdfs:Class owl:Class rdf:Property owl:ObjectProperty owl:DatatypeProperty
    owl:AnnotationProperty owl:NamedIndividual skos:Concept } } }"""
_DECLARED: Final = """
SELECT ?prefix ?namespace { { ?x sh:prefix ?prefix ; sh:namespace ?namespace } UNION
  { ?namespace <http://purl.org/vocab/vann/preferredNamespacePrefix> ?prefix } } LIMIT 1000"""


class _Keep(Protocol):
    def __call__(self, key: str, make: Callable[[], _Part], kind: type[_Part], /) -> _Part: ...


def _without_cache(_key: str, make: Callable[[], _Part], _kind: type[_Part]) -> _Part:
    return make()


def count(snapshot: Snapshot, keep: _Keep = _without_cache) -> Statistics:
    """Return the statistics of a snapshot; takes some seconds for millions of quads.

    `keep` returns the cached result of a step, or computes it, so an interrupted count resumes where it stopped.
    """
    classes = keep("classes", lambda: dict(_numbers(snapshot, _CLASSES)), dict[str, int])
    properties = keep("properties", lambda: dict(_numbers(snapshot, _PROPERTIES)), dict[str, int])
    used = {each: _used(snapshot, each, number) for each, number in classes.items()}
    for each, number in properties.items():
        if number <= SAMPLE:
            # The samples of the classes may have missed rare properties.
            for kind, users in _numbers(snapshot, _USERS % each):
                used.setdefault(kind, {})[each] = users
    return Statistics(
        classes,
        properties,
        used,
        {each: dict(_numbers(snapshot, _LEADS % (each, _VALUES))) for each in properties if each != _TYPE},
        frozenset(each for each in properties if _is_literal(snapshot, each)),
        _comments(snapshot),
        declared(snapshot),
    )


def declared(snapshot: Snapshot) -> dict[str, str]:
    """Return the prefixes that the content of a snapshot declares, except the standard ones."""
    return {prefix: namespace for prefix, namespace in _texts(snapshot, _DECLARED) if prefix not in PREFIXES}


_TYPE: Final = PREFIXES["rdf"] + "type"


def _used(snapshot: Snapshot, kind: str, number: int) -> dict[str, int]:
    """Return the properties of a class, with the numbers of instances that have them."""
    numbers = dict(_numbers(snapshot, _USED % (kind, SAMPLE)))
    if number <= SAMPLE:
        return numbers
    # Estimates are rounded to their significant digits.
    estimates = {each: f"{seen * number / SAMPLE:.{_DIGITS - 1}e}" for each, seen in numbers.items()}
    return {each: number if seen == SAMPLE else int(float(estimates[each])) for each, seen in numbers.items()}


def _is_literal(snapshot: Snapshot, each: str) -> bool:
    rows: Any = snapshot.query(_LITERAL % each)
    return any(type(row[0]).__name__ == "Literal" for row in rows)


def _comments(snapshot: Snapshot) -> dict[str, str]:
    """Return the beginning of the documentation of each term, from its shortest comment."""
    comments: dict[str, str] = {}
    for term, comment in _texts(snapshot, _COMMENTS):
        shortest = comments.get(term)
        if shortest is None or (len(comment), comment) < (len(shortest), shortest):
            comments[term] = comment
    return {term: " ".join(comment.split())[:_LONGEST] for term, comment in sorted(comments.items())}


def _numbers(snapshot: Snapshot, query: str) -> Iterator[tuple[str, int]]:
    for name, number in _texts(snapshot, query):
        yield name, int(number)


def _texts(snapshot: Snapshot, query: str) -> Iterator[tuple[str, str]]:
    rows: Any = snapshot.query(query, prefixes=PREFIXES)
    return ((row[0].value, row[1].value) for row in rows)
