"""Degrees, connected parts and shortest paths of an undirected graph, in columns of numbers."""

from __future__ import annotations

import random
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Self

import numpy as np

from kg.query.stats import Connectivity

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Numbers = NDArray[np.int64]

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
