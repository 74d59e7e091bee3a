"""The figures of RNKG about a graph: entities and triples by kind, degrees, path lengths, entities per node.

Entities are vertices; two are neighbours when any property relates them, whichever way round, and `degree` counts
neighbours. Path lengths are shortest paths in numbers of relations, between all pairs that are connected.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Protocol, cast

from kg.query import stored
from kg.query.core import run
from kg.query.result import Solutions

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    import numpy as np
    from numpy.typing import NDArray

    from kg.store.interface import Snapshot
    from kg.store.terms import Term

__all__ = ["Asked", "Columns", "Connectivity", "Statistics", "statistics"]


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


_OF_NODES: Final = ("topics", "services", "actions", "types", "parameters")
_SOURCES: Final = '!CONTAINS(STR(?graph), "/graph/launch/") && !STRENDS(STR(?graph), "/graph/inferred")'
_DIRECT: Final = tuple(
    f"https://w3id.org/rnkg/ns#{name}"
    for name in ("publishes", "subscribes", "provides", "calls", "servesAction", "callsAction")
)
"""The direct relations of nodes, which rules infer. The query `internal/relations` says the same to the store."""


class Asked(Protocol):
    """What answers queries about the whole store: a snapshot, or its columns."""

    def query(self, text: str, /) -> Any:
        """Return the rows of a SELECT over the union of all graphs."""
        ...


class Columns(Asked, Protocol):
    """The content of a snapshot as columns (`kg.rules.selecting`)."""

    def related(self, numbers: Mapping[str, int], condition: str, everywhere: Iterable[str]) -> NDArray[np.int64]:
        """Return pairs of things, by number, that a property relates."""
        ...

    def count(self) -> int:
        """Return how many quads there are."""
        ...


def statistics(snapshot: Snapshot, columns: Columns | None = None) -> Statistics:
    """Return the figures of a store; queries with many rows are answered from its columns where they are given."""
    from kg.query.connectivity import Neighbours, connectivity  # noqa: PLC0415 - numbers are loaded here

    graph = columns or cast("Asked", snapshot)
    entities = _pairs(snapshot, "completeness/entities-by-kind")
    triples = _pairs(snapshot, "completeness/relations-by-kind")
    kinds = {_text(row[0]): _text(row[1]) for row in graph.query(stored.internal("entities"))}
    numbers = {iri: number for number, iri in enumerate(sorted(kinds))}
    neighbours = Neighbours.of(len(numbers), _edges(snapshot, columns, numbers))
    totals: Counter[str] = Counter()
    for iri, degree in zip(numbers, neighbours.degrees.tolist(), strict=True):
        totals[kinds[iri]] += degree
    sizes = Counter(kinds.values())
    degrees = sorted(
        ((kind, totals[kind] / size) for kind, size in sizes.items()), key=lambda pair: (-pair[1], pair[0])
    )
    return Statistics(
        quads=(columns or snapshot).count(),
        entities=entities,
        triples=triples,
        per_node=_per_node(graph),
        connectivity=connectivity(neighbours),
        degree_by_kind=tuple(degrees),
    )


def _edges(
    snapshot: Snapshot, columns: Columns | None, numbers: Mapping[str, int]
) -> Sequence[tuple[int, int]] | NDArray[np.int64]:
    """Return the pairs of entities that a property relates, by their numbers."""
    # What a launch file has for itself is named below its configuration.
    if columns is not None:
        import numpy as np  # noqa: PLC0415 - numbers are loaded here

        own = np.array(["/configuration/" not in iri for iri in numbers], bool)
        pairs = columns.related(numbers, _SOURCES, _DIRECT)
        kept: NDArray[np.int64] = pairs[own[pairs[:, 0]]]
        return kept
    rows = ((_text(row[0]), _text(row[1])) for row in _rows(snapshot, stored.internal("relations")))
    places = ((numbers.get(one), numbers.get(other)) for one, other in rows if "/configuration/" not in one)
    return [(one, other) for one, other in places if one is not None and other is not None]


def _per_node(graph: Asked) -> tuple[tuple[str, float], ...]:
    """Return how many entities of each kind a node is related to, on average."""
    nodes: set[tuple[str, str]] = set()
    found: Counter[str] = Counter()
    for row in graph.query(stored.internal("entities-per-node")):
        package, node, kind, _ = map(_text, row)
        nodes.add((package, node))
        found[kind] += 1
    return tuple((kind, found[kind] / len(nodes)) for kind in _OF_NODES) if nodes else ()


def _pairs(snapshot: Snapshot, name: str) -> tuple[tuple[str, int], ...]:
    return tuple((_text(row[0]), int(_text(row[1]))) for row in _rows(snapshot, stored.find(name).text))


def _rows(snapshot: Snapshot, text: str) -> Sequence[tuple[Term | None, ...]]:
    result = run(snapshot, text)
    return result.rows if isinstance(result, Solutions) else ()


def _text(term: Term | None) -> str:
    return str(getattr(term, "value", ""))
