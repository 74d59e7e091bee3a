"""Triples given as N-Triples, or as terms, made columns; patches of graphs applied to columns."""

from __future__ import annotations

from itertools import groupby
from operator import itemgetter
from typing import TYPE_CHECKING

from pyoxigraph import Quad, RdfFormat, Store, parse

from kg.rules.columns import EVERYTHING, read_columns
from kg.rules.engine.facts import Facts
from kg.store.snapshot import MemorySnapshot

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pyoxigraph import Triple

    from kg.rules.engine.terms import Dictionary

__all__ = ["patched", "stated"]


def stated(triples: Iterable[Triple], dictionary: Dictionary) -> Facts:
    """Return triples as columns."""
    quads = [Quad(triple.subject, triple.predicate, triple.object) for triple in triples]
    if not quads:
        return Facts()
    store = Store()
    store.bulk_extend(quads)
    return read_columns(MemorySnapshot(store), EVERYTHING, [None], dictionary)[1]


def patched(facts: Facts, patches: Iterable[tuple[bytes, bytes]], dictionary: Dictionary) -> tuple[Facts, set[int]]:
    """Return the columns of a graph after patches, and the predicates that these name."""
    found, touched = facts.copy(), set[int]()
    parts = ((adds, text) for patch in patches for adds, text in enumerate(patch) if text.strip())
    for adds, together in groupby(parts, itemgetter(0)):  # each reading costs more than a few triples
        for predicate, keys in _columns(b"".join(text for _, text in together), dictionary):
            (found.add if adds else found.remove)(predicate, keys)
            touched.add(predicate)
    return found, touched


def _columns(text: bytes, dictionary: Dictionary) -> Facts:
    return stated((quad.triple for quad in parse(text, RdfFormat.N_TRIPLES, lenient=True)), dictionary)
