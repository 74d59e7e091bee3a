"""Figures of a graph in the terms of RNKG: its kinds of entities and the relations between them only.

The stored query `internal/rnkg-relations` defines these kinds and relations.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from statistics import fmean
from typing import TYPE_CHECKING

from kg.query import stored

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.query.stats import Source


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
        path_to_hardware=_path(kinds, neighbours, "hardware"),
        path_to_function=_path(kinds, neighbours, "function"),
        by_kind=tuple(by_kind),
    )


def _path(kinds: Sequence[str], neighbours: Sequence[set[int]], to: str) -> float | None:
    """Return the mean length of the shortest paths from nodes to the nearest entity of a kind; None without paths."""
    ring = {number for number, kind in enumerate(kinds) if kind == to}
    seen, distance, lengths = set(ring), 0, list[int]()
    while ring:
        distance += 1
        ring = {other for one in ring for other in neighbours[one]} - seen
        seen |= ring
        lengths += [distance for one in ring if kinds[one] == "node"]
    return fmean(lengths) if lengths else None
