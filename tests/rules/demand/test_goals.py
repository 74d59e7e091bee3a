"""The goals of queries: these triples are sufficient for the same results."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import pytest
from hypothesis import HealthCheck, given, settings
from patience import examples
from pyoxigraph import NamedNode, Quad, Store
from rules.demand.test_magic import SHAPES, graph, graphs, on_demand, rules_of
from rules.engine.comparing import tuples
from rules.engine.oracle import infer

from kg.rules.demand.deriving import Base, derive, goals_of, open_ended
from kg.rules.engine.limits import Limits
from kg.rules.files import Documentation, RuleFile, RuleSet
from kg.rules.recording import Names
from kg.store.snapshot import MemorySnapshot
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from rules.engine.oracle import Fact

    from kg.rules.form import Rule

INFERRED: Final = NamedNode("urn:inferred")

QUERIES: Final = [
    "SELECT * { ?a :up :n1 }",
    "SELECT * { :n0 :up ?b ; :up ?c }",
    "SELECT * { ?a :p ?b . ?b :up ?c }",
    "SELECT * { ?a :q ?b . ?b :up ?c . ?c a :C3 }",
    "SELECT * { ?a :up ?b . ?a :q :n0 }",
    "SELECT * { ?a a :C1 . ?a :up/:p ?b }",
    "SELECT * { ?a ^:up :n1 }",
    "SELECT * { :n0 :up|:p ?b }",
    "SELECT * { :n0 :up+ ?b }",
    "SELECT * { ?a !(:p|:q) :n1 }",
    "SELECT * { :n0 ?p ?b }",
    "SELECT * { ?a :q ?b OPTIONAL { ?b :up ?c } }",
    "SELECT * { ?a :q ?b OPTIONAL { ?b :p ?d OPTIONAL { ?a :up ?d } } }",
    "SELECT * { ?a :p ?b OPTIONAL { ?b :up ?x } ?x :q ?c }",
    "SELECT * { ?a :p ?b { ?b :q ?c OPTIONAL { ?c :up ?a } } }",
    "SELECT * { ?a :p ?b { { ?b :up ?c } UNION { ?c :up ?a } } }",
    "SELECT * { ?a :p ?b MINUS { ?a :up ?b } }",
    "SELECT * { ?a :p ?b MINUS { ?c :up ?b OPTIONAL { ?a :q ?c } } }",
    "SELECT * { ?a :p ?b FILTER NOT EXISTS { ?b :up ?a } }",
    "SELECT * { ?a :p ?b FILTER(?a = :n0 || EXISTS { ?b :up :n1 }) }",
    "SELECT * { ?a :p ?b BIND(EXISTS { ?b :up ?a } AS ?c) }",
    "SELECT ?a (COUNT(?b) AS ?n) { ?a :q ?c . ?a :up ?b } GROUP BY ?a HAVING (COUNT(?b) > 1)",
    "SELECT (EXISTS { ?a :up ?b } AS ?e) ?a ?b { ?a :q ?b }",
    "SELECT ?a { ?a :q ?b } GROUP BY ?a HAVING (EXISTS { ?a :up :n1 })",
    "SELECT * { ?a :q ?b { SELECT ?b (COUNT(?c) AS ?n) { ?b :up ?c } GROUP BY ?b } }",
    "SELECT * { ?a :q ?b { SELECT ?c { ?c :up ?b } } }",
    "SELECT * { VALUES ?a { :n0 :n1 } ?a :up ?b }",
    "SELECT * { VALUES (?a ?b) { (:n0 UNDEF) (UNDEF :n1) } ?a :up ?b }",
    "SELECT * { ?a :up ?b } VALUES ?a { :n0 }",
    "SELECT * { GRAPH ?g { :n0 :up ?b } }",
    "SELECT * { ?a :q ?b GRAPH <urn:inferred> { ?b :up ?c } }",
    "SELECT * FROM <urn:inferred> { :n0 :up ?b }",
    "SELECT * { [] :up [ a :C1 ] }",
    "ASK { :n0 :up :n1 }",
    "CONSTRUCT { ?b :down ?a } WHERE { ?a :up ?b . ?b a :C1 }",
    "CONSTRUCT WHERE { :n0 :up ?b }",
    "DESCRIBE :n0",
]


def answer(text: str, stated: set[Fact], inferred: set[Fact]) -> Any:
    """Return the result of a query over asserted triples in one graph and inferred ones in another."""
    store = Store()
    store.extend(Quad(*fact, NamedNode("urn:stated")) for fact in stated)  # type: ignore[arg-type]  # subjects are nodes
    store.extend(Quad(*fact, INFERRED) for fact in inferred)  # type: ignore[arg-type]  # the same
    found: Any = store.query(
        "PREFIX : <urn:> " + text, prefixes=dict(PREFIXES), use_default_graph_as_union="FROM" not in text
    )
    return bool(found) if text.startswith("ASK") else sorted(map(str, found))


def derived_for(text: str, rules: list[Rule], asserted: set[Fact]) -> set[Fact]:
    """Return the derivations of rules for a query from the triples of a store, read as far as needed."""
    store = Store()
    store.extend(Quad(*fact, NamedNode("urn:stated")) for fact in asserted)  # type: ignore[arg-type]  # as above
    file = RuleFile("test/rules", Path("rules.srl"), "", Documentation(), tuple(rules))
    nowhere = Path("/dev/null/cache")
    base = Base.of(RuleSet((file,)), MemorySnapshot(store), 0, Names.of("urn:", "urn:ns#"), nowhere)
    found = derive("PREFIX : <urn:> " + text, RuleSet((file,)), base, Limits())
    return tuples(found.facts, found.dictionary)


@pytest.mark.parametrize("text", QUERIES)
@settings(max_examples=examples(12, 50), deadline=None, suppress_health_check=list(HealthCheck))
@given(asserted=graphs)
def test_a_query_has_the_answers_that_it_has_over_everything_inferred(text: str, asserted: set[Fact]) -> None:
    """Each kind of pattern gets the inferred triples it needs."""
    for shape in ("right recursive", "double recursive", "classes by name"):
        rules: list[Rule] = rules_of(SHAPES[shape])
        expected = answer(text, asserted, infer(rules, asserted))
        assert answer(text, asserted, derived_for(text, rules, asserted)) == expected


@pytest.mark.parametrize(
    ("text", "derived"),
    [
        ("SELECT * { :n3 :q ?a OPTIONAL { ?b :up ?a } }", 1),
        ("SELECT * { :n3 :q ?a FILTER EXISTS { ?b :up ?a } }", 1),
        ("SELECT * { :n3 :q ?a { { ?b :up ?a } UNION { ?a :up ?b } } }", 4),
        ("SELECT * { { ?b :up ?a } :n3 :q ?a }", 1),
        ("SELECT * { VALUES ?a { :n1 } ?b :up ?a }", 1),
        ("SELECT * { ?b ^:up/^:q :n3 }", 3),
        ("SELECT * { ?a :p ?b }", 0),
        ("SELECT * { ?b :up ?a }", 10),
        ("SELECT * { :n3 :q ?a { SELECT ?a { ?b :up ?a } LIMIT 9 } }", 10),
        ("SELECT * { ?b :up ?a", 0),
    ],
)
def test_what_stands_around_a_pattern_restricts_it(text: str, derived: int) -> None:
    """Of ten pairs along a chain, only those are derived that can join with the rest of the query."""
    asserted = graph(":n0 :p :n1 . :n1 :p :n2 . :n2 :p :n3 . :n3 :p :n4 . :n3 :q :n1 .")
    rules = rules_of(SHAPES["left recursive"])
    assert len(on_demand(rules, list(goals_of("PREFIX : <urn:> " + text)), asserted)) == derived


def test_what_this_grammar_lacks_asks_for_everything() -> None:
    """DESCRIBE and EXISTS outside of groups may read any triple."""
    assert open_ended(goals_of("DESCRIBE <urn:a>"))
    assert open_ended(goals_of("SELECT ?a { ?a <urn:p> ?b } ORDER BY (EXISTS { ?a <urn:q> ?c })"))
    assert not open_ended(goals_of("SELECT ?a { ?a <urn:p> ?b FILTER EXISTS { ?a <urn:q> ?c } }"))
