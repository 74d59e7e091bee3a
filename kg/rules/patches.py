"""Triples given as N-Triples, or as terms, made columns; patches of graphs applied to columns."""

from __future__ import annotations

from itertools import groupby
from operator import itemgetter
from typing import TYPE_CHECKING

from pyoxigraph import Quad, RdfFormat, Store, parse

from kg.rules.columns import EVERYTHING, Wanted, read_columns
from kg.rules.engine.facts import Facts
from kg.store.snapshot import MemorySnapshot

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pyoxigraph import Triple

    from kg.rules.engine.terms import Dictionary

__all__ = ["patched", "stated"]


def stated(triples: Iterable[Triple], dictionary: Dictionary, what: Wanted = EVERYTHING) -> Facts:
    """Return those of some triples that are wanted."""
    quads = [Quad(triple.subject, triple.predicate, triple.object) for triple in triples]
    if not quads:
        return Facts()
    store = Store()
    store.bulk_extend(quads)
    return read_columns(MemorySnapshot(store), what, [None], dictionary)[1]


def patched(
    facts: Facts, patches: Iterable[tuple[bytes, bytes]], what: Wanted, dictionary: Dictionary
) -> tuple[Facts, set[int]]:
    """Return the columns of a graph after patches, and the predicates that these name."""
    found, touched = facts.copy(), set[int]()
    parts = ((adds, text) for patch in patches for adds, text in enumerate(patch) if text.strip())
    for adds, together in groupby(parts, itemgetter(0)):  # each reading costs more than a few triples
        for predicate, keys in _columns(b"".join(text for _, text in together), what, dictionary):
            (found.add if adds else found.remove)(predicate, keys)
            touched.add(predicate)
    return found, touched


def _columns(text: bytes, what: Wanted, dictionary: Dictionary) -> Facts:
    """Return the wanted triples of a text; what is not is left out before it is read, since patches may be large."""
    names = None if what.predicates is None else what.predicates | {predicate for predicate, _ in what.members}
    quads = parse(text, RdfFormat.N_TRIPLES, lenient=True)
    return stated((quad.triple for quad in quads if names is None or quad.predicate in names), dictionary, what)
