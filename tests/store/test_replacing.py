"""A server receives the graphs of a store, and afterwards only the changed ones."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from pyoxigraph import NamedNode
from store.servers import oxigraph_server

from kg.store.backups import canonical
from kg.store.embedded import EmbeddedStore
from kg.store.layout import Layout
from kg.store.remote import RemoteStore
from kg.store.remote_reading import RemoteReading
from kg.store.replacing import Replaced, replace_on

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

A, B, BLANK, OTHER = (NamedNode(f"https://example.org/{name}") for name in ("a", "b", "blank", "other"))


def _lines(name: str, count: int) -> bytes:
    return b"".join(f"<urn:{name}:{number}> <urn:p> \"text ; 'of' {number}\" .\n".encode() for number in range(count))


@pytest.fixture(scope="module")
def addresses() -> Iterator[tuple[str, str]]:
    """The addresses of a server for queries and for updates."""
    with oxigraph_server() as found:
        yield f"{found}/query", f"{found}/update"


@pytest.fixture
def remote(addresses: tuple[str, str]) -> RemoteStore:
    """The server, without the graphs of this file."""
    remote = RemoteStore(*addresses)
    for graph in (A, B, BLANK, OTHER):
        remote.update(f"DROP SILENT GRAPH {graph}")
    return remote


@pytest.fixture
def store(tmp_path: Path) -> EmbeddedStore:
    """A store with three graphs, two of which share a blank node."""
    store = EmbeddedStore.create(tmp_path / ".kg")
    with store.write("test") as transaction:
        transaction.replace_graphs(
            {
                A: [_lines("a", 1200), b"_:x <urn:p> <urn:o> .\n"],
                B: [_lines("b", 3)],
                BLANK: [b"<urn:s> <urn:p> _:x .\n"],
            }
        )
    return store


def _there(remote: RemoteStore, tmp_path: Path) -> list[bytes]:
    """Return the graphs of this file on the server."""
    with RemoteReading(Layout(tmp_path, remote.address)) as snapshot:
        return canonical(quad for quad in snapshot.quads() if str(quad.graph_name).startswith("<https://example.org/"))


def _here(store: EmbeddedStore) -> list[bytes]:
    with store.read() as snapshot:
        return canonical(snapshot.quads())


@pytest.mark.parametrize(("most", "requests"), [(1 << 26, 1), (1000, 3)], ids=["one request", "three requests"])
def test_the_server_has_the_graphs_of_the_store(
    store: EmbeddedStore, remote: RemoteStore, tmp_path: Path, most: int, requests: int
) -> None:
    """Blank nodes shared by graphs are shared on the server, too."""
    assert replace_on(store.layout, remote, request_bytes=most) == Replaced(3, 1205, 0, requests)
    assert _there(remote, tmp_path) == _here(store)


def test_nothing_is_written_twice(store: EmbeddedStore, remote: RemoteStore) -> None:
    """A store without changes sends nothing."""
    replace_on(store.layout, remote)
    assert replace_on(store.layout, remote) == Replaced(0, 0, 0, 0)


def test_only_changed_graphs_are_written(store: EmbeddedStore, remote: RemoteStore, tmp_path: Path) -> None:
    """A change that preserves the number of triples counts, too."""
    replace_on(store.layout, remote)
    with store.write("test") as transaction:
        transaction.replace_graphs({B: [_lines("c", 3)]})
    assert replace_on(store.layout, remote) == Replaced(1, 3, 0, 1)
    assert _there(remote, tmp_path) == _here(store)


def test_a_graph_with_blank_nodes_is_written_with_those_that_may_share_them(
    store: EmbeddedStore, remote: RemoteStore, tmp_path: Path
) -> None:
    """Otherwise the shared node would become two."""
    replace_on(store.layout, remote)
    with store.write("test") as transaction:
        transaction.replace_graphs({BLANK: [b"<urn:t> <urn:p> _:x .\n"]})
    assert replace_on(store.layout, remote) == Replaced(2, 1202, 0, 1)
    assert _there(remote, tmp_path) == _here(store)


def test_a_graph_that_is_gone_is_removed(store: EmbeddedStore, remote: RemoteStore, tmp_path: Path) -> None:
    """Graphs that the store never had remain."""
    remote.update(f"INSERT DATA {{ GRAPH {OTHER} {{ <urn:a> <urn:b> <urn:c> }} }}")
    replace_on(store.layout, remote)
    with store.write("test") as transaction:
        transaction.drop_graph(B)
    assert replace_on(store.layout, remote) == Replaced(0, 0, 1, 1)
    stray = b"<urn:a> <urn:b> <urn:c> <https://example.org/other> .\n"
    assert _there(remote, tmp_path) == sorted([*_here(store), stray])


def test_what_others_removed_is_written_again(store: EmbeddedStore, remote: RemoteStore, tmp_path: Path) -> None:
    """Detected by the number of triples."""
    replace_on(store.layout, remote)
    remote.update(f"DELETE WHERE {{ GRAPH {B} {{ <urn:b:1> ?p ?o }} }}")
    assert replace_on(store.layout, remote) == Replaced(1, 3, 0, 1)
    assert _there(remote, tmp_path) == _here(store)
