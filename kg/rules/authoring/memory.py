"""A small graph in memory and its inferences."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from pyoxigraph import NamedNode, Quad, RdfFormat, Store, Triple, parse

from kg.rules.columns import lines, stated, stored
from kg.rules.engine.evaluate import Program, RuleReport, evaluate
from kg.rules.engine.terms import Dictionary
from kg.rules.explain.view import Vocabulary
from kg.store.snapshot import MemorySnapshot

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.rules.engine.facts import Facts
    from kg.rules.engine.limits import Limits

VOCABULARY: Final = Vocabulary(NamedNode("urn:kg:inferred"))
"""The graph of the inferred triples of a world."""


def triples_of(facts: Facts, dictionary: Dictionary) -> Iterator[Triple]:
    """Yield the triples of columns, sorted as text, without those that decomposition introduced."""
    text = b"".join(lines(stored(facts, dictionary), dictionary))
    for quad in parse(b"".join(sorted(text.splitlines(keepends=True))), RdfFormat.N_TRIPLES):
        yield quad.triple


def infer(
    program: Program, triples: Iterable[Triple], limits: Limits | None = None
) -> tuple[list[Triple], list[RuleReport]]:
    """Return what rules infer from triples, and what each rule did; raises what `evaluate` raises."""
    dictionary = Dictionary()
    outcome = evaluate(program, dictionary, stated(triples, dictionary), limits=limits)
    return list(triples_of(outcome.inferred, dictionary)), outcome.reports


def world_of(asserted: Iterable[Triple], inferred: Iterable[Triple]) -> MemorySnapshot:
    """Return asserted and inferred triples, the latter in the graph of `VOCABULARY`."""
    store = Store()
    store.extend(Quad(one.subject, one.predicate, one.object) for one in asserted)
    store.extend(Quad(one.subject, one.predicate, one.object, VOCABULARY.inferred) for one in inferred)
    return MemorySnapshot(store)
