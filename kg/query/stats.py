"""Figures of a graph as published for RNKG: entities and triples by kind, degrees, path lengths, entities per node.

Entities are vertices. Two are neighbours if any property relates them in either direction; `degree` counts neighbours.
Path lengths are shortest paths in numbers of relations, between all connected pairs.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Protocol, Self

from kg.lazily import lazily
from kg.query import stored

with lazily():
    import random
    from statistics import fmean

    import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from kg.store.terms import Term

    Numbers = NDArray[np.int64]


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


_SAMPLE: Final = 400
"""Number of sources for shortest paths in larger graphs; the error of the mean is at most a few percent."""
_BITS: Final = 64


@dataclass(frozen=True, slots=True)
class Neighbours:
    """Adjacency of vertices 0, 1, ...: the neighbours of one are `others[starts[vertex] : starts[vertex + 1]]`."""

    starts: Numbers
    others: Numbers

    @classmethod
    def of(cls, count: int, edges: Sequence[tuple[int, int]] | Numbers) -> Self:
        """Return the adjacency of `count` vertices from edges; duplicates and loops are dropped."""
        pairs = np.array(edges, np.int64).reshape(-1, 2)
        pairs = pairs[pairs[:, 0] != pairs[:, 1]]
        ones, others = np.divmod(np.unique(np.concatenate([pairs, pairs[:, ::-1]]) @ np.array([count, 1])), count or 1)
        return cls(np.searchsorted(ones, np.arange(count + 1)), others)

    @property
    def degrees(self) -> Numbers:
        """Number of neighbours of each vertex."""
        return np.diff(self.starts)

    def of_each(self, vertices: Numbers) -> tuple[Numbers, Numbers]:
        """Return the concatenated neighbours of several vertices, and the number of neighbours of each."""
        sizes = self.degrees[vertices]
        places = np.repeat(self.starts[vertices] - np.cumsum(sizes) + sizes, sizes)
        return self.others[places + np.arange(places.size)], sizes


def connectivity(neighbours: Neighbours) -> Connectivity:
    """Return the figures of a graph."""
    degrees = neighbours.degrees
    count = degrees.size
    parts = _parts(neighbours)
    exact = count <= _SAMPLE
    sources = range(count) if exact else random.Random(0).sample(range(count), _SAMPLE)  # noqa: S311 - not a secret
    lengths = _lengths(neighbours, np.array(sources, np.int64))
    pairs = lengths.total()
    return Connectivity(
        entities=count,
        relations=int(degrees.sum()) // 2,
        degree=int(degrees.sum()) / count if count else 0.0,
        highest=int(degrees.max(initial=0)),
        isolated=int(np.count_nonzero(degrees == 0)),
        parts=parts.size,
        largest=int(parts.max(initial=0)),
        path=sum(length * number for length, number in lengths.items()) / pairs if pairs else 0.0,
        path_median=_median(lengths),
        longest=max(lengths, default=0),
        sources=len(sources),
        exact=exact,
    )


def _median(lengths: Counter[int]) -> float:
    """Return the median of lengths with their numbers; 0 if empty."""
    pairs = lengths.total()
    reached, middle = 0, []
    for length in sorted(lengths):
        reached += lengths[length]
        middle += [length for at in ((pairs - 1) // 2, pairs // 2) if reached - lengths[length] <= at < reached]
    return sum(middle) / 2


def _lengths(neighbours: Neighbours, sources: Numbers) -> Counter[int]:
    """Return the number of pairs of a source and a vertex at each distance, by breadth-first search.

    All sources run at once: each has a bit in the rows of the vertices that it has reached.
    """
    bits = np.zeros((sources.size, -(-sources.size // _BITS)), np.uint64)
    places = np.arange(sources.size)
    bits[places, places // _BITS] = np.left_shift(np.uint64(1), (places % _BITS).astype(np.uint64))
    seen = np.zeros((neighbours.degrees.size, bits.shape[1]), np.uint64)
    seen[sources] = bits
    pairs: Counter[int] = Counter()
    ring, distance = sources, 0
    while ring.size:
        distance += 1
        others, sizes = neighbours.of_each(ring)
        # Several of the ring may have one neighbour: sorting brings its copies together, so that their bits are joined.
        order = np.argsort(others, kind="stable")
        firsts = np.flatnonzero(np.diff(others[order], prepend=-1))
        ring = others[order[firsts]]
        bits = np.bitwise_or.reduceat(np.repeat(bits, sizes, axis=0)[order], firsts) if ring.size else bits[:0]
        # The bits that a vertex did not have are those of sources that reach it at this distance.
        bits &= ~seen[ring]
        seen[ring] |= bits
        new = bits.any(axis=1)
        ring, bits = ring[new], bits[new]
        pairs[distance] = int(np.bitwise_count(bits).sum())
    return +pairs


def _parts(neighbours: Neighbours) -> Numbers:
    """Return the sizes of the connected parts of a graph.

    Each vertex repeatedly takes the smallest label of its neighbours, and the label of that label, until nothing
    changes.
    """
    labels, before = np.arange(neighbours.degrees.size), np.empty(0, np.int64)
    joined = np.flatnonzero(neighbours.degrees)
    while not np.array_equal(labels, before):
        before = labels
        labels = labels.copy()
        if joined.size:
            smallest = np.minimum.reduceat(before[neighbours.others], neighbours.starts[joined])
            labels[joined] = np.minimum(before[joined], smallest)
        labels = labels[labels]  # following labels of labels halves the rounds of long chains
    sizes = np.bincount(labels)
    return sizes[sizes > 0]


@dataclass(frozen=True, slots=True)
class Counted:
    """Figures in the terms of RNKG.

    `entities` and `triples` are totals; `by_kind` is the number of entities of each kind, the largest first.
    `entities_per_node` is the mean number of entities related to a node. `path_to_hardware` and `path_to_function` are
    the mean number of relations from a node to the nearest hardware and function, over connected nodes (None without
    any).
    """

    entities: int
    triples: int
    entities_per_node: float
    path_to_hardware: float | None
    path_to_function: float | None
    by_kind: tuple[tuple[str, int], ...]


def counted(graph: Source) -> Counted:
    """Return the figures of a store in the terms of RNKG."""
    triples = 0
    numbers: dict[str, int] = {}
    kinds: list[str] = []
    neighbours: list[set[int]] = []
    for row in graph.query(stored.internal("rnkg-relations")):
        triples += 1
        one, kind, _, other, other_kind = (str(getattr(term, "value", "")) for term in row)
        ends = []
        for iri, what in ((one, kind), (other, other_kind)):
            number = numbers.setdefault(iri, len(kinds))
            if number == len(kinds):
                kinds.append(what)
                neighbours.append(set())
            ends.append(number)
        neighbours[ends[0]].add(ends[1])
        neighbours[ends[1]].add(ends[0])
    nodes = [len(ones) for ones, kind in zip(neighbours, kinds, strict=True) if kind == "node"]
    by_kind = sorted(Counter(kinds).items(), key=lambda pair: (-pair[1], pair[0]))
    return Counted(
        entities=len(kinds),
        triples=triples,
        entities_per_node=sum(nodes) / len(nodes) if nodes else 0.0,
        path_to_hardware=_mean_path(kinds, neighbours, "hardware"),
        path_to_function=_mean_path(kinds, neighbours, "function"),
        by_kind=tuple(by_kind),
    )


def _mean_path(kinds: Sequence[str], neighbours: Sequence[set[int]], to: str) -> float | None:
    """Return the mean length of the shortest paths from nodes to the nearest entity of a kind; None without paths."""
    ring = {number for number, kind in enumerate(kinds) if kind == to}
    seen, distance, lengths = set(ring), 0, list[int]()
    while ring:
        distance += 1
        ring = {other for one in ring for other in neighbours[one]} - seen
        seen |= ring
        lengths += [distance for one in ring if kinds[one] == "node"]
    return fmean(lengths) if lengths else None
