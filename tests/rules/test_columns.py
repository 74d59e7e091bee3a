from __future__ import annotations

from typing import Final

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyoxigraph import NamedNode, Quad, Store

from kg.rules import columns
from kg.rules.columns import Wanted, read
from kg.rules.engine.terms import Dictionary
from kg.store import bulk

NAMES: Final = [NamedNode(f"http://example.org/{letter}") for letter in "abcdef"]
GRAPHS: Final = [NamedNode(f"http://example.org/graph/{number}") for number in range(12)]
WANTED: Final = Wanted(frozenset(NAMES[:2]), frozenset([(NAMES[2], NAMES[3]), (NAMES[2], NAMES[4])]))


class Tables:
    """A store in memory as a source of columns."""

    def __init__(self, store: Store) -> None:
        self._store = store

    def table(self, select: str, graph: NamedNode | None) -> bytes:
        """Return the rows of a SELECT over one graph."""
        return bulk.table(lambda: self._store, select, graph)

    def graphs(self) -> list[NamedNode]:
        """Return the named graphs."""
        return [graph for graph in self._store.named_graphs() if isinstance(graph, NamedNode)]


def triples(store: Store, *, small: int) -> dict[NamedNode | None, set[tuple[str, ...]]]:
    """Return the triples read from each graph; a graph with fewer wanted triples than `small` counts as small."""
    dictionary = Dictionary()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(columns, "_SMALL", small)
        found = read(Tables(store), WANTED, GRAPHS, dictionary)
    return {
        graph: {
            tuple(str(dictionary.term(number)) for number in (int(key) >> 32, predicate, int(key) & 0xFFFFFFFF))
            for predicate, keys in facts
            for key in keys
        }
        for graph, facts in found.items()
    }


@given(st.lists(st.tuples(*[st.sampled_from(NAMES)] * 3, st.sampled_from(GRAPHS))), st.integers(2, 20))
def test_small_graphs_are_read_as_large_ones_are(quads: list[tuple[NamedNode, ...]], small: int) -> None:
    """One query per graph and one per predicate give the same result, and large graphs are read in parts."""
    store = Store()
    store.extend(Quad(*quad) for quad in quads)
    assert triples(store, small=small) == triples(store, small=1)
