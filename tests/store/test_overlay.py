"""A generation with triples added for one query."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from pyoxigraph import NamedNode

from kg.store.embedded import EmbeddedStore
from kg.store.overlay import overlaid

if TYPE_CHECKING:
    from pathlib import Path

GRAPH = NamedNode("urn:test:g")
ADDED = NamedNode("urn:test:added")
COUNT = "SELECT (COUNT(*) AS ?n) { ?s ?p ?o }"


def lines(begin: int, end: int) -> bytes:
    """Return N-Triples, one of them with a blank node."""
    return b"".join(b"<urn:test:%d> <urn:test:p> _:b .\n" % number for number in range(begin, end))


def filled(folder: Path) -> EmbeddedStore:
    """Return a store of twenty quads."""
    store = EmbeddedStore.create(folder / ".kg")
    with store.write("test") as transaction:
        transaction.replace_graphs({GRAPH: [lines(0, 20)]})
    return store


def size(snapshot: Any) -> int:
    """Return the number of triples visible to a query."""
    (row,) = snapshot.query(COUNT)
    return int(row["n"].value)


def test_what_is_added_is_seen_beside_the_rest_and_nowhere_else(tmp_path: Path) -> None:
    """The copy has both, with the number of the generation; the store has no new triples and no new files."""
    store = filled(tmp_path)
    with store.read() as snapshot:
        with overlaid(snapshot, ADDED, [lines(20, 25), lines(25, 30)], store.layout.cache) as extended:
            assert (size(extended), size(snapshot)) == (30, 20)
            assert extended.identity == snapshot.identity
            assert extended.graphs() == [ADDED, GRAPH]
        assert size(snapshot) == 20
    assert list(store.layout.cache.iterdir()) == []


def test_the_copy_is_removed_when_a_query_fails(tmp_path: Path) -> None:
    """The copy is deleted whatever ends the body."""
    store = filled(tmp_path)
    with store.read() as snapshot, pytest.raises(KeyError), overlaid(snapshot, ADDED, [], store.layout.cache):
        raise KeyError
    assert list(store.layout.cache.iterdir()) == []


def test_a_cache_that_cannot_be_written_is_done_without(tmp_path: Path) -> None:
    """The copy is then in the system's temporary folder."""
    store = filled(tmp_path)
    (tmp_path / "file").write_text("")
    with store.read() as snapshot, overlaid(snapshot, ADDED, [lines(20, 21)], tmp_path / "file") as extended:
        assert size(extended) == 21
