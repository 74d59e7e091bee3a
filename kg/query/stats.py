"""Figures of a graph as published for RNKG: entities and triples by kind, degrees, path lengths, entities per node.

Entities are vertices. Two are neighbours if any property relates them in either direction; `degree` counts neighbours.
Path lengths are shortest paths in numbers of relations, between all connected pairs.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Protocol

from kg.lazily import lazily
from kg.query import stored

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from kg.store.terms import Term

with lazily():
    from kg.query.connectivity import Neighbours, connectivity


@dataclass(frozen=True, slots=True)
class Connectivity:
    """Connectivity of the entities.

    `degree` is the mean number of neighbours, `largest` the number of entities of the largest connected part. `path` is
    the mean length of shortest paths, `path_median` their median and `longest` the longest one found. `sources` is the
    number of entities from which paths were followed, `exact` whether that was all of them.
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
    """All figures; pairs of kind and number are sorted, the largest first."""

    quads: int
    entities: tuple[tuple[str, int], ...]
    triples: tuple[tuple[str, int], ...]
    per_node: tuple[tuple[str, float], ...]
    connectivity: Connectivity
    degree_by_kind: tuple[tuple[str, float], ...]


_OF_NODES: Final = ("topics", "services", "actions", "types", "parameters")


class Source(Protocol):
    """A data source for queries over the whole store: a snapshot, or its columns."""

    def query(self, text: str, /) -> Any:
        """Return the rows of a SELECT over the union of all graphs."""
        ...

    def count(self) -> int:
        """Return the number of quads."""
        ...


def statistics(snapshot: Source) -> Statistics:
    """Return the figures of a store, from a snapshot or its columns."""
    kinds = {_text(row[0]): _text(row[1]) for row in snapshot.query(stored.internal("entities"))}
    numbers = {iri: number for number, iri in enumerate(sorted(kinds))}
    neighbours = Neighbours.of(len(numbers), _edges(snapshot, numbers))
    totals: Counter[str] = Counter()
    for iri, degree in zip(numbers, neighbours.degrees.tolist(), strict=True):
        totals[kinds[iri]] += degree
    sizes = Counter(kinds.values())
    degrees = sorted(
        ((kind, totals[kind] / size) for kind, size in sizes.items()), key=lambda pair: (-pair[1], pair[0])
    )
    return Statistics(
        quads=snapshot.count(),
        entities=_pairs(snapshot, "completeness/entities-by-kind"),
        triples=_pairs(snapshot, "completeness/relations-by-kind"),
        per_node=_per_node(snapshot),
        connectivity=connectivity(neighbours),
        degree_by_kind=tuple(degrees),
    )


def _edges(snapshot: Source, numbers: Mapping[str, int]) -> Sequence[tuple[int, int]]:
    """Return the pairs of entities related by a property, as numbers."""
    # The entities of a launch file are named below its configuration.
    rows = ((_text(row[0]), _text(row[1])) for row in snapshot.query(stored.internal("relations")))
    places = ((numbers.get(one), numbers.get(other)) for one, other in rows if "/configuration/" not in one)
    return [(one, other) for one, other in places if one is not None and other is not None]


def _per_node(graph: Source) -> tuple[tuple[str, float], ...]:
    """Return the mean number of entities of each kind that are related to a node."""
    nodes: set[tuple[str, str]] = set()
    numbers: Counter[str] = Counter()
    for row in graph.query(stored.internal("entities-per-node")):
        package, node, kind, _ = map(_text, row)
        nodes.add((package, node))
        numbers[kind] += 1
    return tuple((kind, numbers[kind] / len(nodes)) for kind in _OF_NODES) if nodes else ()


def _pairs(graph: Source, name: str) -> tuple[tuple[str, int], ...]:
    return tuple((_text(row[0]), int(_text(row[1]))) for row in graph.query(stored.find(name).text))


def _text(term: Term | None) -> str:
    return str(getattr(term, "value", ""))
