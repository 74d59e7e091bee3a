"""Tests of the figures of a graph."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

from hypothesis import given, settings
from hypothesis import strategies as st
from pytest import approx  # noqa: PT013 - the only name used

from kg.query.stats import connectivity, statistics

if TYPE_CHECKING:
    from kg.store.snapshot import EmbeddedSnapshot


@settings(deadline=None)
@given(st.sets(st.tuples(st.integers(0, 12), st.integers(0, 12)).filter(lambda edge: edge[0] < edge[1])))
def test_connectivity_is_that_of_all_pairs(edges: set[tuple[int, int]]) -> None:
    """Degrees, parts and lengths of paths are those that comparing all ways finds (Floyd and Warshall)."""
    size, far = 13, 99
    both = edges | {(other, one) for one, other in edges}
    far_apart = {pair: 0 if pair[0] == pair[1] else 1 if pair in both else far for pair in _pairs(size)}
    for via in range(size):
        for one, other in _pairs(size):
            far_apart[one, other] = min(far_apart[one, other], far_apart[one, via] + far_apart[via, other])
    lengths = [length for length in far_apart.values() if 0 < length < far]
    parts = {frozenset(other for other in range(size) if far_apart[one, other] < far) for one in range(size)}
    found = connectivity([sorted(other for one, other in both if one == vertex) for vertex in range(size)])
    assert found.relations == len(edges)
    assert found.parts == len(parts)
    assert found.largest == max(map(len, parts))
    assert found.longest == max(lengths, default=0)
    assert found.path == approx(sum(lengths) / len(lengths) if lengths else 0.0)
    assert found.exact


def _pairs(size: int) -> list[tuple[int, int]]:
    return list(itertools.product(range(size), range(size)))


def test_a_large_graph_is_sampled() -> None:
    """Paths of a large graph are followed from a sample, and the figures say so; the mean of a ring is known."""
    size = 2001
    ring = [[(vertex - 1) % size, (vertex + 1) % size] for vertex in range(size)]
    found = connectivity(ring)
    assert not found.exact
    assert found.sources < size
    assert found.path == approx((size + 1) / 4)


def test_statistics_of_the_examples(examples: EmbeddedSnapshot) -> None:
    """The figures agree with the queries they come from and with each other."""
    found = statistics(examples)
    entities = dict(found.entities)
    assert entities["node"] == 19
    assert found.quads > sum(number for _, number in found.triples) > 0
    assert dict(found.per_node)["topics"] > 1
    assert found.connectivity.entities >= entities["node"] + entities["topic"]
    assert 1 < found.connectivity.path < found.connectivity.longest
    assert dict(found.degree_by_kind)["node"] > 1
