"""Union of the named graphs of several stores, for the duration of a command."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from pyoxigraph import DefaultGraph, RdfFormat, Store

from kg.store.failure import translated
from kg.store.snapshot import EmbeddedSnapshot, MemorySnapshot


@contextmanager
def union_of(snapshots: Sequence[EmbeddedSnapshot]) -> Iterator[EmbeddedSnapshot]:
    """Yield a snapshot with the quads of all `snapshots`, in a temporary folder.

    The files of the largest are copied; the quads of the others are loaded, at some microseconds each. Blank nodes of
    different stores are different nodes, but a graph with the same content in several, such as an ontology, exists
    once.

    Raises:
        StoreError: KG304 if the disk is full.
    """
    first, *others = sorted(snapshots, key=lambda one: -one.count())
    with tempfile.TemporaryDirectory(prefix="kg-union-") as temporary, translated(temporary):
        folder = str(Path(temporary) / "store")
        first.backup(folder)
        _load(Store(folder), first, others)
        yield MemorySnapshot(Store.read_only(folder))


def _load(engine: Store, first: EmbeddedSnapshot, others: Sequence[EmbeddedSnapshot]) -> None:
    """Add the quads of `others` to those of `first`, which `engine` has; it is closed when this returns."""
    for other in others:
        for graph in other.every_graph():
            content = other.content(graph)
            if sorted(content.splitlines()) != sorted(first.content(graph).splitlines()):
                engine.bulk_load(content, RdfFormat.N_TRIPLES, to_graph=graph)
            elif graph != DefaultGraph():
                engine.add_graph(graph)
    engine.flush()
