"""Tests of the graphs shared by sources and systems, as builds change them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kg.graph.iris import Iris
from kg.graph.shared import SHARED
from kg.pipeline import sharing
from kg.pipeline.sharing import keep_shared, patch_shared
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from pathlib import Path

IRIS = Iris("https://example.org/")
LINES = [f"<https://example.org/message/{name}> <https://example.org/p> <https://example.org/o> .\n" for name in "ab"]
BOTH = "".join(LINES).encode()


@pytest.fixture
def store(tmp_path: Path) -> EmbeddedStore:
    """A store whose sources share two triples."""
    store = EmbeddedStore.create(tmp_path / ".kg")
    with store.write("test") as transaction:
        keep_shared(transaction, IRIS, [BOTH], [])
    return store


def graphs(store: EmbeddedStore) -> set[str]:
    """Return the named graphs of a store."""
    with store.read() as snapshot:
        return {graph.value for graph in snapshot.graphs()}


def test_a_graph_with_triples_stays(store: EmbeddedStore) -> None:
    """Removing some of the shared triples keeps their graph."""
    with store.write("test") as transaction:
        keep_shared(transaction, IRIS, [LINES[0].encode()], [])
    assert graphs(store) == {IRIS.graph(SHARED)}


def test_an_empty_graph_goes(store: EmbeddedStore) -> None:
    """A graph is removed with its last triple: a clean build does not create it."""
    with store.write("test") as transaction:
        keep_shared(transaction, IRIS, [], [])
    assert graphs(store) == set()


def test_a_graph_that_a_patch_empties_goes(store: EmbeddedStore) -> None:
    """The same applies if only the change is known."""
    with store.write("test") as transaction:
        patch_shared(transaction, IRIS, [BOTH], [], [])
    assert graphs(store) == set()


@pytest.mark.parametrize("held", [0, 1 << 20])
def test_a_start_is_described_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, held: int) -> None:
    """It is, with its lines in memory or in a file."""
    monkeypatch.setattr(sharing, "_HELD_BYTES", held)
    first = [b'<urn:start/a> <urn:kind> "node" .\n', b'<urn:start/a#remap/x> <urn:from> "x" .\n']
    second = b'<urn:start/b> <urn:kind> "node" .\n'
    described = sharing.Described(tmp_path)
    described.add(first)
    described.add([*first, second])
    assert list(described) == [*first, second]
    assert b"".join(described.chunks()) == b"".join([*first, second])
    described.close()
