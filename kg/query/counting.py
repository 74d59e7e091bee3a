"""The figures of a graph as RNKG counts it: its kinds of entities, the relations between these, and nothing else.

Which kinds and relations these are stands in the stored query `internal/rnkg-relations`.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kg.query import stored
from kg.query.core import run
from kg.query.result import Solutions
from kg.query.stats import connectivity

if TYPE_CHECKING:
    from kg.store.interface import Snapshot

__all__ = ["Counted", "counted"]


@dataclass(frozen=True, slots=True)
class Counted:
    """Figures as RNKG has them.

    `entities` and `triples` in all, `by_kind` the entities from the most; `entities_per_node` the mean number of
    entities that a node is related to; mean and median of the lengths of shortest paths between entities that are
    connected.
    """

    entities: int
    triples: int
    entities_per_node: float
    path_mean: float
    path_median: float
    by_kind: tuple[tuple[str, int], ...]


def counted(snapshot: Snapshot) -> Counted:
    """Return the figures of a store as RNKG counts them."""
    result = run(snapshot, stored.internal("rnkg-relations"))
    rows = result.rows if isinstance(result, Solutions) else ()
    numbers: dict[str, int] = {}
    kinds: list[str] = []
    neighbours: list[set[int]] = []
    for row in rows:
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
    paths = connectivity([sorted(ones) for ones in neighbours])
    nodes = [len(ones) for ones, kind in zip(neighbours, kinds, strict=True) if kind == "node"]
    by_kind = sorted(Counter(kinds).items(), key=lambda pair: (-pair[1], pair[0]))
    return Counted(
        entities=len(kinds),
        triples=len(rows),
        entities_per_node=sum(nodes) / len(nodes) if nodes else 0.0,
        path_mean=paths.path,
        path_median=paths.path_median,
        by_kind=tuple(by_kind),
    )
