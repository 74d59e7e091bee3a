"""Tests of the figures of a graph in the terms of RNKG."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pytest import approx  # noqa: PT013 - the only name used

from kg.query.stats import Neighbours, connectivity, counted, statistics
from kg.query.stats import _mean_path as _path

if TYPE_CHECKING:
    from kg.store.snapshot import EmbeddedSnapshot


def test_entities_are_those_of_the_kinds_of_rnkg(examples: EmbeddedSnapshot) -> None:
    """All nodes, packages and repositories count; hardware and functions only if a node has them."""
    found = counted(examples)
    kinds, every = dict(found.by_kind), dict(statistics(examples).entities)
    assert kinds["node"] == every["node"]
    assert kinds["package"] == every["package"]
    assert set(kinds) <= {"repository", "package", "node", "topic", "service", "message", "hardware", "function"}
    assert found.entities == sum(kinds.values())
    assert found.triples >= found.entities - 1
    assert found.entities_per_node > 1
    assert found.path_to_hardware is not None
    assert found.path_to_hardware >= 1
    assert found.path_to_function is not None
    assert found.path_to_function >= 1


def test_paths_lead_to_the_nearest_entity_of_a_kind() -> None:
    """The shortest path from each node connected to hardware counts; other nodes do not."""
    kinds = ["node", "topic", "node", "hardware", "node", "hardware"]
    neighbours = [{1}, {0, 2}, {1, 3, 5}, {2}, set(), {2}]
    assert _path(kinds, neighbours, "hardware") == approx((3 + 1) / 2)
    assert _path(kinds, neighbours, "function") is None


def test_median_of_paths() -> None:
    """The median of an even number of lengths is the mean of the two in the middle; without paths it is 0."""
    assert connectivity(Neighbours.of(4, [(0, 1), (1, 2), (2, 3)])).path_median == approx(1.5)
    assert connectivity(Neighbours.of(3, [(0, 1), (1, 2)])).path_median == 1
    assert connectivity(Neighbours.of(1, [])).path_median == 0
