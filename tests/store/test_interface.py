"""The content of the embedded store conforms to the interface; the type checker reads this file too."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pyoxigraph import NamedNode, RdfFormat

from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from pathlib import Path

    from kg.store.interface import Snapshot

GRAPH = NamedNode("https://example.org/g")


def _read(snapshot: Snapshot) -> tuple[str, int, bytes]:
    """Read through the interface only."""
    return snapshot.identity, snapshot.count(GRAPH), snapshot.dump(RdfFormat.N_TRIPLES, graph=GRAPH)


def test_the_embedded_store_keeps_to_the_interface(tmp_path: Path) -> None:
    """Data that was written is read back through the interface."""
    store = EmbeddedStore.create(tmp_path / ".kg")
    with store.write("test") as transaction:
        transaction.replace_graphs({GRAPH: [b"<urn:a> <urn:b> <urn:c> .\n"]})
        transaction.append(GRAPH, b"<urn:a> <urn:b> <urn:d> .\n")
        transaction.update("DELETE DATA { GRAPH <https://example.org/g> { <urn:a> <urn:b> <urn:c> } }")
    with store.read() as snapshot:
        assert _read(snapshot) == ("1", 1, b"<urn:a> <urn:b> <urn:d> .\n")
