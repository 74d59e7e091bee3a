"""Tests of the union of several stores."""

from __future__ import annotations

from contextlib import ExitStack
from typing import TYPE_CHECKING

from pyoxigraph import NamedNode

from kg.store.embedded import EmbeddedStore
from kg.store.union import union_of

if TYPE_CHECKING:
    from pathlib import Path

FIRST, SECOND = NamedNode("urn:first"), NamedNode("urn:second")


def _made(folder: Path, graphs: dict[NamedNode, bytes]) -> EmbeddedStore:
    store = EmbeddedStore.create(folder)
    with store.write("test") as transaction:
        transaction.replace_graphs({graph: [content] for graph, content in graphs.items()})
    return store


def test_graphs_are_united_and_blank_nodes_kept_apart(tmp_path: Path) -> None:
    """A graph with the same name has the triples of both; the same label means different nodes in different stores."""
    stores = [
        _made(tmp_path / "a", {FIRST: b"<urn:a> <urn:p> <urn:b> .\n_:x <urn:p> <urn:c> .\n"}),
        _made(tmp_path / "b", {FIRST: b"_:x <urn:p> <urn:c> .\n", SECOND: b"<urn:d> <urn:p> <urn:e> .\n"}),
    ]
    with ExitStack() as stack:
        snapshots = [stack.enter_context(store.read()) for store in stores]
        with union_of(snapshots) as union:
            assert union.graphs() == [FIRST, SECOND]
            assert union.count(FIRST) == 3
            assert union.count() == 4
    assert [store.layout.current() for store in stores] == [1, 1]


def test_a_graph_that_both_have_alike_is_there_once(tmp_path: Path) -> None:
    """Equal graphs, for example of an ontology, do not duplicate their blank nodes."""
    content = b"_:x <urn:p> <urn:c> .\n"
    stores = [_made(tmp_path / name, {FIRST: content}) for name in ("a", "b")]
    with ExitStack() as stack, union_of([stack.enter_context(store.read()) for store in stores]) as union:
        assert union.count() == 1
