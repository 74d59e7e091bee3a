"""The figures of RNKG about a graph: entities and triples by kind, degrees, path lengths, entities per node.

Entities are vertices; two are neighbours when any property relates them, whichever way round, and `degree` counts
neighbours. Path lengths are shortest paths in numbers of relations, between all pairs that are connected.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

from pyoxigraph import NamedNode

from kg.query import stored
from kg.query.core import run
from kg.query.result import Solutions

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from kg.store.interface import Snapshot
    from kg.store.terms import Term

__all__ = ["Connectivity", "Statistics", "statistics"]


@dataclass(frozen=True, slots=True)
class Connectivity:
    """How entities hang together.

    `degree` is the mean number of neighbours, `largest` how many entities the largest connected part has, `path` the
    mean length of shortest paths, `path_median` their median and `longest` the longest of those followed; `sources`
    tells from how many entities they were followed, `exact` whether that was all.
    """

    entities: int
    relations: int
    degree: float
    highest: int
    isolated: int
    parts: int
    largest: int
    path: float
    path_median: float
    longest: int
    sources: int
    exact: bool


@dataclass(frozen=True, slots=True)
class Statistics:
    """All figures; pairs of kind and number are sorted from the largest."""

    quads: int
    entities: tuple[tuple[str, int], ...]
    triples: tuple[tuple[str, int], ...]
    per_node: tuple[tuple[str, float], ...]
    connectivity: Connectivity
    degree_by_kind: tuple[tuple[str, float], ...]


def statistics(snapshot: Snapshot) -> Statistics:
    """Return the figures of a store."""
    from kg.query.connectivity import Neighbours, connectivity  # noqa: PLC0415 - numbers are loaded here

    entities = _pairs(snapshot, "completeness/entities-by-kind")
    triples = _pairs(snapshot, "completeness/relations-by-kind")
    kinds = {_text(row[0]): _text(row[1]) for row in _rows(snapshot, stored.internal("entities"))}
    numbers = {iri: number for number, iri in enumerate(sorted(kinds))}
    neighbours = Neighbours.of(len(numbers), list(_edges(snapshot, numbers)))
    totals: Counter[str] = Counter()
    for iri, degree in zip(numbers, neighbours.degrees.tolist(), strict=True):
        totals[kinds[iri]] += degree
    sizes = Counter(kinds.values())
    degrees = sorted(
        ((kind, totals[kind] / size) for kind, size in sizes.items()), key=lambda pair: (-pair[1], pair[0])
    )
    return Statistics(
        quads=snapshot.count(),
        entities=entities,
        triples=triples,
        per_node=_per_node(snapshot),
        connectivity=connectivity(neighbours),
        degree_by_kind=tuple(degrees),
    )


def _edges(snapshot: Snapshot, numbers: Mapping[str, int]) -> Iterator[tuple[int, int]]:
    """Yield the pairs of entities that a property relates, by their numbers."""
    for row in _rows(snapshot, stored.internal("relations")):
        one, other = numbers.get(_text(row[0])), numbers.get(_text(row[1]))
        # What a launch file has for itself is named below its configuration.
        of_sources = isinstance(row[1], NamedNode) and "/configuration/" not in _text(row[0])
        if of_sources and one is not None and other is not None:
            yield one, other


def _per_node(snapshot: Snapshot) -> tuple[tuple[str, float], ...]:
    """Return how many entities of each kind a node is related to, on average."""
    result = run(snapshot, stored.internal("entities-per-node"))
    if not isinstance(result, Solutions) or not result.rows:
        return ()
    columns = zip(result.variables, zip(*result.rows, strict=True), strict=True)
    return tuple((name, sum(int(_text(term)) for term in column) / len(result.rows)) for name, column in columns)


def _pairs(snapshot: Snapshot, name: str) -> tuple[tuple[str, int], ...]:
    return tuple((_text(row[0]), int(_text(row[1]))) for row in _rows(snapshot, stored.find(name).text))


def _rows(snapshot: Snapshot, text: str) -> Sequence[tuple[Term | None, ...]]:
    result = run(snapshot, text)
    return result.rows if isinstance(result, Solutions) else ()


def _text(term: Term | None) -> str:
    return str(getattr(term, "value", ""))
