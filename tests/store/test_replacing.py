"""A server receives the graphs of a store, and afterwards only the changed ones."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from pyoxigraph import NamedNode
from store.servers import oxigraph_server, virtuoso_server

from kg.store.backups import canonical
from kg.store.embedded import EmbeddedStore
from kg.store.layout import Layout
from kg.store.remote import RemoteStore
from kg.store.remote_reading import RemoteReading
from kg.store.replacing import Limits, Replaced, replace_on

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

A, B, BLANK, OTHER = (NamedNode(f"https://example.org/{name}") for name in ("a", "b", "blank", "other"))


def _lines(name: str, count: int) -> bytes:
    return b"".join(f"<urn:{name}:{number}> <urn:p> \"text ; 'of' {number}\" .\n".encode() for number in range(count))


@pytest.fixture(scope="module", params=["oxigraph", pytest.param("virtuoso", marks=pytest.mark.virtuoso)])
def addresses(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[tuple[str, str | None]]:
    """The addresses of a server for queries and for updates."""
    if request.param == "oxigraph":
        with oxigraph_server() as found:
            yield f"{found}/query", f"{found}/update"
    else:
        with virtuoso_server(tmp_path_factory.mktemp("virtuoso")) as found:
            yield found, None


@pytest.fixture
def remote(addresses: tuple[str, str | None]) -> RemoteStore:
    """The server, without the graphs of this file."""
    remote = RemoteStore(*addresses)
    for graph in (A, B, BLANK, OTHER):
        remote.update(f"DROP SILENT GRAPH {graph}")
    assert not _staged(remote)
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


def _staged(remote: RemoteStore) -> list[NamedNode]:
    """Return the temporary graphs on the server."""
    return [graph for graph in remote.read().graphs() if graph.value.startswith("urn:kg:")]


def _there(remote: RemoteStore, tmp_path: Path) -> list[bytes]:
    """Return the graphs of this file on the server."""
    with RemoteReading(Layout(tmp_path, remote.address)) as snapshot:
        return canonical(quad for quad in snapshot.quads() if str(quad.graph_name).startswith("<https://example.org/"))


def _here(store: EmbeddedStore) -> list[bytes]:
    with store.read() as snapshot:
        return canonical(snapshot.quads())


def _replaced(graphs: int, triples: int, requests: int) -> Replaced:
    return Replaced(graphs, triples, 0, requests)


def test_the_server_has_the_graphs_of_the_store(store: EmbeddedStore, remote: RemoteStore, tmp_path: Path) -> None:
    """Blank nodes shared by graphs are shared on the server, too; it is one request."""
    assert replace_on(store.layout, remote) == _replaced(3, 1205, 1)
    assert _there(remote, tmp_path) == _here(store)


@pytest.mark.parametrize("limits", [Limits(1000, 100), Limits(1 << 26, 4)], ids=["bytes", "operations"])
def test_large_changes_are_moved_into_place(
    store: EmbeddedStore, remote: RemoteStore, tmp_path: Path, limits: Limits
) -> None:
    """The requests before the last one leave the graphs as they were; their own graphs are removed."""
    remote.update(f"INSERT DATA {{ GRAPH {A} {{ <urn:old> <urn:p> <urn:o> }} }}")
    seen: list[int] = []
    update = remote.update

    def watched(text: str) -> None:
        seen.append(remote.read().count(A))
        update(text)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(remote, "update", watched)
        replaced = replace_on(store.layout, remote, limits=limits)
    assert (replaced.graphs, replaced.triples, replaced.missing) == (3, 1205, 0)
    assert seen == [1] * replaced.requests
    assert replaced.requests > 1
    assert _there(remote, tmp_path) == _here(store)
    assert not _staged(remote)


def test_an_interrupted_copy_is_repeated(store: EmbeddedStore, remote: RemoteStore, tmp_path: Path) -> None:
    """Graphs that it left behind are removed, and those of the store were not changed."""
    replace_on(store.layout, remote)
    with store.write("test") as transaction:
        transaction.replace_graphs({B: [_lines("c", 3)]})
    left = "INSERT DATA { GRAPH <urn:kg:staged:0> { <urn:c:1> <urn:p> 1 } }"
    remote.update(left)
    assert replace_on(store.layout, remote) == _replaced(1, 3, 2)
    assert _there(remote, tmp_path) == _here(store)
    assert not _staged(remote)


def test_values_survive(store: EmbeddedStore, remote: RemoteStore, tmp_path: Path) -> None:
    """Long texts, languages, escapes and datatypes are stored as they are."""
    values = [
        '"' + "long text " * 40_000 + '"',
        '"Grüße"@de',
        r'"tab\tquote\"backslash\\ line\nend"',
        '"\u0001\u007f {{ } ; # \' <urn:x>"',
        '""',
        '"true"^^<http://www.w3.org/2001/XMLSchema#boolean>',
        '"0.25"^^<http://www.w3.org/2001/XMLSchema#double>',
        '"0.25"^^<http://www.w3.org/2001/XMLSchema#decimal>',
        '"-7"^^<http://www.w3.org/2001/XMLSchema#integer>',
        '"2026-03-01T10:20:30.123456Z"^^<http://www.w3.org/2001/XMLSchema#dateTime>',
        '"x"^^<urn:type>',
        "<https://example.org/a%20b?c=d&e#f>",
    ]
    with store.write("test") as transaction:
        lines = [f"<urn:{number}> <urn:p> {value} .\n".encode() for number, value in enumerate(values)]
        transaction.replace_graphs({A: lines, B: [], BLANK: []})
    replace_on(store.layout, remote)
    assert _there(remote, tmp_path) == _here(store)


def test_equal_values_of_a_server_do_not_count_as_changes(store: EmbeddedStore, remote: RemoteStore) -> None:
    """Virtuoso stores a decimal and an equal double as one value; the next call writes nothing."""
    types = ("http://www.w3.org/2001/XMLSchema#decimal", "http://www.w3.org/2001/XMLSchema#double")
    with store.write("test") as transaction:
        transaction.replace_graphs({A: [f'<urn:a> <urn:p> "0.25"^^<{one}> .\n'.encode() for one in types]})
    missing = replace_on(store.layout, remote).missing
    assert missing == 2 - remote.read().count(A)
    assert replace_on(store.layout, remote) == Replaced(0, 0, 0, 0, missing)


def test_nothing_is_written_twice(store: EmbeddedStore, remote: RemoteStore) -> None:
    """A store without changes sends nothing."""
    replace_on(store.layout, remote)
    assert replace_on(store.layout, remote) == _replaced(0, 0, 0)


def test_only_changed_graphs_are_written(store: EmbeddedStore, remote: RemoteStore, tmp_path: Path) -> None:
    """A change that preserves the number of triples counts, too."""
    replace_on(store.layout, remote)
    with store.write("test") as transaction:
        transaction.replace_graphs({B: [_lines("c", 3)]})
    assert replace_on(store.layout, remote) == _replaced(1, 3, 1)
    assert _there(remote, tmp_path) == _here(store)


def test_a_graph_with_blank_nodes_is_written_with_those_that_may_share_them(
    store: EmbeddedStore, remote: RemoteStore, tmp_path: Path
) -> None:
    """Otherwise the shared node would become two."""
    replace_on(store.layout, remote)
    with store.write("test") as transaction:
        transaction.replace_graphs({BLANK: [b"<urn:t> <urn:p> _:x .\n"]})
    assert replace_on(store.layout, remote) == _replaced(2, 1202, 1)
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
    assert replace_on(store.layout, remote) == _replaced(1, 3, 1)
    assert _there(remote, tmp_path) == _here(store)
