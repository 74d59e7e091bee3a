"""A small graph in memory, its inferences, and queries about both."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, cast

from pyoxigraph import NamedNode, Quad, QuerySolutions, RdfFormat, Store, Triple, parse

from kg.rules.engine.blocks import lines
from kg.rules.engine.evaluate import evaluate
from kg.rules.engine.terms import Dictionary
from kg.rules.explain.view import Vocabulary
from kg.rules.form import AUXILIARY
from kg.rules.patches import stated

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    import pyoxigraph
    from pyoxigraph import QueryBoolean, QueryTriples

    from kg.rules.engine.evaluate import Program, RuleReport
    from kg.rules.engine.facts import Facts
    from kg.rules.engine.limits import Limits
    from kg.rules.form import Term

__all__ = ["VOCABULARY", "World", "infer", "triples_of"]

VOCABULARY: Final = Vocabulary(NamedNode("urn:kg:inferred"))
"""Where the inferred triples of a world stand."""


def triples_of(facts: Facts, dictionary: Dictionary) -> Iterator[Triple]:
    """Yield the triples of columns, sorted as text, without those that decomposition introduced."""
    hidden = b"<" + AUXILIARY.encode()
    shown = [each for each in facts.predicates if not dictionary.spelling(each).startswith(hidden)]
    for quad in parse(b"".join(sorted(lines(dictionary, facts, shown))), RdfFormat.N_TRIPLES):
        yield quad.triple


def infer(
    program: Program, triples: Iterable[Triple], limits: Limits | None = None
) -> tuple[list[Triple], list[RuleReport]]:
    """Return what rules infer from triples, and what each rule did; raises what `evaluate` raises."""
    dictionary = Dictionary()
    outcome = evaluate(program, dictionary, stated(triples, dictionary), limits=limits)
    return list(triples_of(outcome.inferred, dictionary)), outcome.reports


class World:
    """Asserted and inferred triples, to be queried as a snapshot of a store is."""

    def __init__(self, asserted: Iterable[Triple], inferred: Iterable[Triple]) -> None:
        self._store = Store()
        self._store.extend(Quad(one.subject, one.predicate, one.object) for one in asserted)
        graph = VOCABULARY.inferred
        self._store.extend(Quad(one.subject, one.predicate, one.object, graph) for one in inferred)

    def query(
        self,
        text: str,
        *,
        prefixes: Mapping[str, str] | None = None,
        union: bool = True,
        substitutions: Mapping[pyoxigraph.Variable, Term] | None = None,
    ) -> QuerySolutions | QueryBoolean | QueryTriples:
        """Run a SPARQL query; with `union` its default graph is the union of all."""
        return self._store.query(
            text,
            prefixes=dict(prefixes or {}),
            use_default_graph_as_union=union,
            substitutions=dict(substitutions) if substitutions else None,
        )

    def matches(self, patterns: str, names: Iterable[str]) -> Iterator[dict[str, Term]]:
        """Yield the matches of triple patterns in the inferred triples."""
        names = list(names)
        columns = " ".join(f"?{name}" for name in names) or "(1 AS ?one)"
        text = f"SELECT DISTINCT {columns} WHERE {{ GRAPH {VOCABULARY.inferred} {{ {patterns} }} }}"
        for row in cast("QuerySolutions", self.query(text)):
            yield {name: cast("Term", row[name]) for name in names}
