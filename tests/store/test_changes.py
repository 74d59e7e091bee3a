from __future__ import annotations

from typing import TYPE_CHECKING

from pyoxigraph import NamedNode

from kg.store.changes import since
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from pathlib import Path

G, H = NamedNode("urn:g"), NamedNode("urn:h")
ONE, TWO = b"<urn:a> <urn:b> <urn:c> .\n", b"<urn:a> <urn:b> <urn:d> .\n"


def test_generations_tell_which_graphs_they_changed(tmp_path: Path) -> None:
    """Patches follow one another; a graph that was replaced has none."""
    store = EmbeddedStore.create(tmp_path / ".kg")
    with store.write("test") as transaction:
        transaction.replace_graphs({G: [ONE], H: [ONE]})
    with store.write("test") as transaction:
        transaction.patch_graph(G, ONE, TWO)
    with store.write("test") as transaction:
        transaction.append(G, ONE)
        transaction.load(H, [TWO])
    assert since(store.layout, 1, 3).graphs == {"urn:g": [(ONE, TWO), (b"", ONE)], "urn:h": None}
    assert since(store.layout, 3, 3).graphs == {}


def test_what_may_write_anywhere_is_not_known(tmp_path: Path) -> None:
    """After a SPARQL update, a missing record or a record of an older generation, nothing is known."""
    store = EmbeddedStore.create(tmp_path / ".kg")
    with store.write("test") as transaction:
        transaction.load(G, [ONE])
    with store.write("test") as transaction:
        transaction.update("INSERT DATA { <urn:a> <urn:b> <urn:c> }")
    assert since(store.layout, 1, 2).graphs is None
    (store.layout.root / "changes" / "2").unlink()
    assert since(store.layout, 1, 2).graphs is None
    assert since(store.layout, 2, 1).graphs is None


def test_patches_with_blank_nodes_say_what_is_in_the_store(tmp_path: Path) -> None:
    """A blank node keeps its label, so a patch that names it is valid."""
    store, line = EmbeddedStore.create(tmp_path / ".kg"), b"_:a <urn:b> _:c .\n"
    with store.write("test") as transaction:
        transaction.append(G, ONE)
    with store.write("test") as transaction:
        transaction.append(G, line)
    assert since(store.layout, 1, 2).graphs == {"urn:g": [(b"", line)]}
    with store.read() as snapshot:
        assert set(snapshot.content(G).splitlines(keepends=True)) == {ONE, line}
