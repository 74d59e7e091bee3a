"""The figures of RNKG about a graph: entities and triples by kind, degrees, path lengths, entities per node.

Entities are vertices; two are neighbours when any property relates them, whichever way round, and `degree` counts
neighbours. Path lengths are shortest paths in numbers of relations, between all pairs that are connected.
"""

from __future__ import annotations

import random
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.query import stored
from kg.query.core import run
from kg.query.result import Solutions

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.store.interface import Snapshot
    from kg.store.terms import Term

__all__ = ["Connectivity", "Statistics", "connectivity", "statistics"]

_SAMPLE: Final = 400
"""From how many entities paths are followed in a graph with more: the error of the mean stays below a few percent."""


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
    entities = _pairs(snapshot, "completeness/entities-by-kind")
    triples = _pairs(snapshot, "completeness/relations-by-kind")
    kinds = {_text(row[0]): _text(row[1]) for row in _rows(snapshot, stored.internal("entities"))}
    numbers = {iri: number for number, iri in enumerate(sorted(kinds))}
    neighbours: list[set[int]] = [set() for _ in numbers]
    for row in _rows(snapshot, stored.internal("relations")):
        one, other = numbers.get(_text(row[0])), numbers.get(_text(row[1]))
        if one is not None and other is not None and one != other:
            neighbours[one].add(other)
            neighbours[other].add(one)
    totals: Counter[str] = Counter()
    for iri, number in numbers.items():
        totals[kinds[iri]] += len(neighbours[number])
    sizes = Counter(kinds.values())
    degrees = sorted(
        ((kind, totals[kind] / size) for kind, size in sizes.items()), key=lambda pair: (-pair[1], pair[0])
    )
    return Statistics(
        quads=snapshot.count(),
        entities=entities,
        triples=triples,
        per_node=_per_node(snapshot),
        connectivity=connectivity([sorted(ones) for ones in neighbours]),
        degree_by_kind=tuple(degrees),
    )


def connectivity(neighbours: Sequence[Sequence[int]]) -> Connectivity:
    """Return how a graph hangs together that is given as the neighbours of each vertex."""
    count = len(neighbours)
    degrees = [len(ones) for ones in neighbours]
    parts = _parts(neighbours)
    exact = count <= _SAMPLE
    sources = range(count) if exact else random.Random(0).sample(range(count), _SAMPLE)  # noqa: S311 - no secret
    lengths: Counter[int] = Counter()
    for source in sources:
        lengths.update(_lengths(neighbours, source))
    pairs = lengths.total()
    return Connectivity(
        entities=count,
        relations=sum(degrees) // 2,
        degree=sum(degrees) / count if count else 0.0,
        highest=max(degrees, default=0),
        isolated=degrees.count(0),
        parts=len(parts),
        largest=max(parts, default=0),
        path=sum(length * number for length, number in lengths.items()) / pairs if pairs else 0.0,
        path_median=_median(lengths),
        longest=max(lengths, default=0),
        sources=len(sources),
        exact=exact,
    )


def _median(lengths: Counter[int]) -> float:
    """Return the median of lengths that are given with their numbers; 0 without any."""
    pairs = lengths.total()
    reached, middle = 0, []
    for length in sorted(lengths):
        reached += lengths[length]
        middle += [length for at in ((pairs - 1) // 2, pairs // 2) if reached - lengths[length] <= at < reached]
    return sum(middle) / 2


def _lengths(neighbours: Sequence[Sequence[int]], source: int) -> Counter[int]:
    """Return how many vertices are how far from `source`, by breadth-first search."""
    seen = bytearray(len(neighbours))
    seen[source] = 1
    found: Counter[int] = Counter()
    ring, distance = [source], 0
    while ring:
        distance += 1
        reached = []
        for vertex in ring:
            for other in neighbours[vertex]:
                if not seen[other]:
                    seen[other] = 1
                    reached.append(other)
        if reached:
            found[distance] = len(reached)
        ring = reached
    return found


def _parts(neighbours: Sequence[Sequence[int]]) -> list[int]:
    """Return the sizes of the connected parts of a graph."""
    seen = bytearray(len(neighbours))
    sizes = []
    for start in range(len(neighbours)):
        if seen[start]:
            continue
        seen[start] = 1
        pending, size = [start], 0
        while pending:
            size += 1
            for other in neighbours[pending.pop()]:
                if not seen[other]:
                    seen[other] = 1
                    pending.append(other)
        sizes.append(size)
    return sizes


def _per_node(snapshot: Snapshot) -> tuple[tuple[str, float], ...]:
    """Return how many entities of each kind a node is related to, on average."""
    result = run(snapshot, stored.find("completeness/entities-per-node").text)
    if not isinstance(result, Solutions) or not result.rows:
        return ()
    columns = list(enumerate(result.variables))[2:]
    numbers = [(name, [int(_text(row[index])) for row in result.rows]) for index, name in columns]
    return tuple((name, sum(values) / len(values)) for name, values in numbers)


def _pairs(snapshot: Snapshot, name: str) -> tuple[tuple[str, int], ...]:
    return tuple((_text(row[0]), int(_text(row[1]))) for row in _rows(snapshot, stored.find(name).text))


def _rows(snapshot: Snapshot, text: str) -> Sequence[tuple[Term | None, ...]]:
    result = run(snapshot, text)
    return result.rows if isinstance(result, Solutions) else ()


def _text(term: Term | None) -> str:
    return str(getattr(term, "value", ""))
