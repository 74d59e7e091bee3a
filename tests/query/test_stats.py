"""Tests of the figures of a graph."""

from __future__ import annotations

import itertools
import random
from collections import Counter
from statistics import fmean, median
from typing import TYPE_CHECKING

from hypothesis import given, settings
from hypothesis import strategies as st
from pytest import approx  # noqa: PT013 - the only name used

from kg.query import stored
from kg.query.core import run
from kg.query.result import Solutions
from kg.query.stats import Neighbours, connectivity, statistics

if TYPE_CHECKING:
    from kg.store.snapshot import EmbeddedSnapshot


@settings(deadline=None)
@given(st.sets(st.tuples(st.integers(0, 12), st.integers(0, 12)).filter(lambda edge: edge[0] < edge[1])))
def test_connectivity_is_that_of_all_pairs(edges: set[tuple[int, int]]) -> None:
    """Degrees, parts and lengths of paths are those of an exhaustive algorithm (Floyd and Warshall)."""
    size, far = 13, 99
    both = edges | {(other, one) for one, other in edges}
    far_apart = {pair: 0 if pair[0] == pair[1] else 1 if pair in both else far for pair in _pairs(size)}
    for via in range(size):
        for one, other in _pairs(size):
            far_apart[one, other] = min(far_apart[one, other], far_apart[one, via] + far_apart[via, other])
    lengths = [length for length in far_apart.values() if 0 < length < far]
    parts = {frozenset(other for other in range(size) if far_apart[one, other] < far) for one in range(size)}
    found = connectivity(Neighbours.of(size, [*edges, *edges]))
    assert found.relations == len(edges)
    assert found.parts == len(parts)
    assert found.largest == max(map(len, parts))
    assert found.longest == max(lengths, default=0)
    assert found.path == approx(sum(lengths) / len(lengths) if lengths else 0.0)
    assert found.exact


def _pairs(size: int) -> list[tuple[int, int]]:
    return list(itertools.product(range(size), range(size)))


def test_a_large_graph_is_sampled() -> None:
    """Paths of a large graph are followed from a sample, which the figures record; the mean of a ring is known."""
    size = 2001
    found = connectivity(Neighbours.of(size, [(vertex, (vertex + 1) % size) for vertex in range(size)]))
    assert not found.exact
    assert found.sources < size
    assert found.path == approx((size + 1) / 4)


@given(
    st.integers(401, 600).flatmap(
        lambda size: st.lists(st.tuples(st.integers(0, size - 1), st.integers(0, size - 1)), max_size=900)
    )
)
@settings(deadline=None, max_examples=20)
def test_paths_from_a_sample_are_those_of_a_search_from_each(edges: list[tuple[int, int]]) -> None:
    """Following all sources at once finds the same lengths as one after the other; loops are not paths."""
    size = 600
    around: dict[int, set[int]] = {vertex: set() for vertex in range(size)}
    for one, other in edges:
        around[one].add(other)
        around[other].add(one)
    lengths: Counter[int] = Counter()
    for source in random.Random(0).sample(range(size), 400):  # noqa: S311 - the same sample, no secret
        seen, ring, distance = {source}, {source}, 0
        while ring := set().union(*(around[one] for one in ring)) - seen:
            seen |= ring
            distance += 1
            lengths[distance] += len(ring)
    found = connectivity(Neighbours.of(size, edges))
    every = sorted(lengths.elements())
    assert found.longest == max(every, default=0)
    assert found.path == approx(fmean(every) if every else 0.0)
    assert found.path_median == (median(every) if every else 0.0)
    assert found.highest == max(len(others - {one}) for one, others in around.items())


def test_a_long_chain_is_followed_to_its_end() -> None:
    """The cost of a step depends on the vertices that it reaches, so a chain costs no more than other graphs."""
    size = 5_000
    found = connectivity(Neighbours.of(size, [(vertex, vertex + 1) for vertex in range(size - 1)]))
    assert (found.parts, found.largest) == (1, size)
    assert size // 2 < found.longest < size


def test_entities_per_node_are_the_means_of_the_stored_query(examples: EmbeddedSnapshot) -> None:
    """The figures for all nodes are the means of the query for single nodes."""
    result = run(examples, stored.find("completeness/entities-per-node").text)
    assert isinstance(result, Solutions)
    columns = zip(result.variables[2:], list(zip(*result.rows, strict=True))[2:], strict=True)
    expected = {name: fmean(int(str(getattr(term, "value", ""))) for term in column) for name, column in columns}
    assert dict(statistics(examples).per_node) == approx(expected)


def test_statistics_of_the_examples(examples: EmbeddedSnapshot) -> None:
    """The figures agree with their queries and with each other."""
    found = statistics(examples)
    entities = dict(found.entities)
    assert entities["node"] == 19
    assert found.quads > sum(number for _, number in found.triples) > 0
    assert dict(found.per_node)["topics"] > 1
    assert found.connectivity.entities >= entities["node"] + entities["topic"]
    assert 1 < found.connectivity.path < found.connectivity.longest
    assert dict(found.degree_by_kind)["node"] > 1
