"""The graph of what sources share (`kg.graph.shared`), kept in step with the sources of the store."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from pyoxigraph import NamedNode

from kg.graph.shared import SHARED

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.graph.iris import Iris
    from kg.store.transaction import EmbeddedTransaction

__all__ = ["keep_shared", "patch_shared"]

_FEW: Final = 20
"""Triples are taken out one by one when they are less than one in so many; else the graph is written anew."""


def patch_shared(
    transaction: EmbeddedTransaction, iris: Iris, gone: Iterable[bytes], came: Iterable[bytes], kept: Iterable[bytes]
) -> None:
    """Change the graph, which holds just the triples of `gone` and `kept`, into one of those of `came` and `kept`.

    `kept` is taken only where something changes.
    """
    before = {line for content in gone for line in content.splitlines(keepends=True)}
    after = {line for content in came for line in content.splitlines(keepends=True)}
    removed, added = before - after, after - before
    for content in kept if removed or added else ():
        there = content.splitlines(keepends=True)
        removed.difference_update(there)
        added.difference_update(there)
    if removed or added:
        transaction.patch_graph(NamedNode(iris.graph(SHARED)), b"".join(sorted(removed)), b"".join(sorted(added)))


def keep_shared(
    transaction: EmbeddedTransaction, iris: Iris, contents: Iterable[bytes], sources: Iterable[str]
) -> None:
    """Give the graph the triples in `contents`, each once; `sources` are those that the contents come from.

    Where the store has a source besides these, whose contents are therefore not known, nothing is taken out.
    """
    graph = NamedNode(iris.graph(SHARED))
    wanted = {line for content in contents for line in content.splitlines(keepends=True)}
    present = set(transaction.content(graph).splitlines(keepends=True))
    removed, added = present - wanted, wanted - present
    known = {iris.source_graph(name) for name in sources}
    others = iris.source_graph("")
    if any(other.value.startswith(others) and other.value not in known for other in transaction.graphs()):
        removed = set()
    if len(removed) * _FEW > len(present):
        transaction.replace_graphs({graph: sorted(wanted)})
    elif removed:
        transaction.patch_graph(graph, b"".join(sorted(removed)), b"".join(sorted(added)))
    elif added:
        transaction.load(graph, sorted(added))
