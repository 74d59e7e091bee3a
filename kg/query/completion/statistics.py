"""Which classes and properties a store has, which of them go together, and how often.

Classes and properties are counted. Which properties a class has is read from a sample of its instances, and which
classes a property leads to from a sample of its values: the engine keeps terms in the order of their hashes, so the
first few hundred of an index are as good as drawn by lot. Up to that many the numbers are exact; beyond they are
estimates, rounded so that they look like ones. Counting all pairs of class and property of five million quads takes
21 s of processor time; this takes 6 s.
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
"""How many instances of a class are looked at."""
_VALUES: Final = 500
"""How many triples of a property are looked at for the classes of its values."""
_DIGITS: Final = 2
_LONGEST: Final = 600
"""How many characters of a comment are kept."""


class Statistics(msgspec.Struct, frozen=True):
    """What is known of the content of one snapshot.

    `classes` has the number of instances of each class, `properties` that of the triples of each property. `used` tells
    for a class how many of its instances have a property, `leads` for a property how many of its sampled values are of
    a class, `literal` which properties have literals. `comments` documents terms. `prefixes` are those that the
    store declares. IRIs are without brackets.
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


def _made(_key: str, make: Callable[[], _Part], _kind: type[_Part]) -> _Part:
    return make()


def count(snapshot: Snapshot, keep: _Keep = _made) -> Statistics:
    """Return the statistics of a snapshot; some seconds for millions of quads.

    `keep` returns a part that was counted before, or makes it: whoever is interrupted goes on where it was.
    """
    classes = keep("classes", lambda: dict(_numbers(snapshot, _CLASSES)), dict[str, int])
    properties = keep("properties", lambda: dict(_numbers(snapshot, _PROPERTIES)), dict[str, int])
    used = {each: _used(snapshot, each, number) for each, number in classes.items()}
    for each, number in properties.items():
        if number <= SAMPLE:
            # What samples of the classes may have missed.
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
    """Return the prefixes that the content of a snapshot declares, beside those that every query knows."""
    return {prefix: namespace for prefix, namespace in _texts(snapshot, _DECLARED) if prefix not in PREFIXES}


_TYPE: Final = PREFIXES["rdf"] + "type"


def _used(snapshot: Snapshot, kind: str, number: int) -> dict[str, int]:
    """Return how many instances of a class have each property."""
    found = dict(_numbers(snapshot, _USED % (kind, SAMPLE)))
    if number <= SAMPLE:
        return found
    return {each: number if seen == SAMPLE else _rounded(seen * number / SAMPLE) for each, seen in found.items()}


def _rounded(value: float) -> int:
    """Return an estimate with as many digits as can be relied on."""
    return int(float(f"{value:.{_DIGITS - 1}e}"))


def _is_literal(snapshot: Snapshot, each: str) -> bool:
    rows: Any = snapshot.query(_LITERAL % each)
    return any(type(row[0]).__name__ == "Literal" for row in rows)


def _comments(snapshot: Snapshot) -> dict[str, str]:
    """Return the first sentence or so that documents each term, the shortest of several."""
    found: dict[str, str] = {}
    for term, comment in _texts(snapshot, _COMMENTS):
        known = found.get(term)
        if known is None or (len(comment), comment) < (len(known), known):
            found[term] = comment
    return {term: " ".join(comment.split())[:_LONGEST] for term, comment in sorted(found.items())}


def _numbers(snapshot: Snapshot, query: str) -> Iterator[tuple[str, int]]:
    for name, number in _texts(snapshot, query):
        yield name, int(number)


def _texts(snapshot: Snapshot, query: str) -> Iterator[tuple[str, str]]:
    rows: Any = snapshot.query(query, prefixes=PREFIXES)
    return ((row[0].value, row[1].value) for row in rows)
