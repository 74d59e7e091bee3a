"""Tests of snippets in the graph."""

from __future__ import annotations

from dataclasses import replace

from graph.samples import FACTS
from pyoxigraph import NamedNode, RdfFormat, Store

from kg.facts import Repository, Snippet
from kg.graph.iris import Iris
from kg.graph.packages import package_triples, repository_triples
from kg.graph.snippets import quoted_lines
from kg.store.snapshot import MemorySnapshot

BASE = "https://example.org/kg/"


def test_lines_that_were_written_are_read_again() -> None:
    """Punctuation, colons and spaces survive, for this file alone, whatever the base of the IRIs."""
    lines = ((1, ""), (7, '  a: "b\\n" # ä'), (12, "12: x"))
    facts = replace(FACTS, snippets=(Snippet("src/a b.cpp", lines), Snippet("src/c.cpp", ((1, "c"),))))
    iris, store = Iris(BASE), Store()
    for content in (package_triples(facts, iris), repository_triples(Repository(facts.repository, "/r"), iris, ())):
        store.load(content, RdfFormat.N_TRIPLES, to_graph=NamedNode(iris.source_graph(facts.repository)))
    snapshot = MemorySnapshot(store)
    assert quoted_lines(snapshot, facts.repository, "src/a b.cpp") == dict(lines)
    assert quoted_lines(snapshot, facts.repository, "src/other.cpp") == {}
    assert quoted_lines(snapshot, "local/unknown", "src/c.cpp") == {}
