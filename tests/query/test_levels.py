"""Statistics and most questions are about node types: launch files do not affect their results."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from workspaces import copied, example

from kg.pipeline.inferring import Inference
from kg.query.core import ask
from kg.query.result import Solutions
from kg.query.stored import discover
from kg.settings import load
from kg.store.embedded import EmbeddedStore
from kg.store.opening import existing

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from kg.store.snapshot import EmbeddedSnapshot

OF_SYSTEMS = {"explore/actions", "explore/services", "explore/who-publishes", "explore/who-subscribes"}
"""Queries that also read names in launched systems."""
QUERIES = {
    name: query for name, query in discover().items() if not name.startswith("robot/") and name not in OF_SYSTEMS
}
"""All others, except those about robots, whose subject is the capabilities of systems."""


@pytest.fixture(scope="module")
def levels(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[EmbeddedSnapshot, EmbeddedSnapshot]]:
    """The example workspace with the graphs of its launch files, and without them."""
    root = tmp_path_factory.mktemp("levels")
    full = existing(load({"store": example(tmp_path_factory) / ".kg"}, environment={}))
    types = _types_alone(root, full)
    with full.read() as one, types.read() as other:
        yield one, other


def _types_alone(root: Path, full: EmbeddedStore) -> EmbeddedStore:
    """Return a copy of a store without the graphs of launch files, with updated inferences."""
    copied(full.layout.root, root / "types")
    store = EmbeddedStore.create(root / "types")
    with store.write("test") as transaction:
        launched = [graph for graph in transaction.graphs() if "/graph/launch/" in graph.value]
        assert launched
        transaction.replace_graphs({graph: [] for graph in launched})
        Inference(store, load({}, environment={})).run(transaction)
    return store


@pytest.mark.parametrize("name", QUERIES)
def test_instances_change_no_answer(levels: tuple[EmbeddedSnapshot, EmbeddedSnapshot], name: str) -> None:
    """Each stored query has the same result with and without the graphs of launch files."""
    query = QUERIES[name]
    with_instances, without = (ask(snapshot, query, {}) for snapshot in levels)
    assert isinstance(with_instances, Solutions)
    assert isinstance(without, Solutions)
    assert sorted(map(str, with_instances.rows)) == sorted(map(str, without.rows))
