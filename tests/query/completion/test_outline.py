from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.query.completion.outline import TYPE, Slot, Step, outline
from kg.syntax.lexer import tokens
from kg.syntax.names import PREFIXES

RNKG = PREFIXES["rnkg"]


@pytest.mark.parametrize(
    ("text", "slot"),
    [
        ("", Slot.BEGIN),
        ("PREFIX", Slot.PREFIX),
        ("PREFIX a:", Slot.NAMESPACE),
        ("PREFIX a: <urn:a>", Slot.BEGIN),
        ("SELECT ?x", Slot.PROJECTION),
        ("SELECT (COUNT(?x) AS", Slot.NEW),
        ("SELECT (COUNT(?x) AS ?n)", Slot.PROJECTION),
        ("SELECT * FROM", Slot.DATASET),
        ("SELECT * WHERE", Slot.CLAUSE),
        ("SELECT * {", Slot.SUBJECT),
        ("SELECT * { ?x", Slot.PREDICATE),
        ("SELECT * { ?x a", Slot.OBJECT),
        ("SELECT * { ?x a ?y", Slot.AFTER),
        ("SELECT * { ?x a ?y .", Slot.SUBJECT),
        ("SELECT * { ?x a ?y ;", Slot.PREDICATE),
        ("SELECT * { ?x a ?y ,", Slot.OBJECT),
        ("SELECT * { ?x rnkg:a/", Slot.PREDICATE),
        ("SELECT * { ?x (rnkg:a|^rnkg:b)*", Slot.OBJECT),
        ("SELECT * { ?x rnkg:a [", Slot.PREDICATE),
        ("SELECT * { ?x rnkg:a [ rnkg:b 1 ]", Slot.AFTER),
        ("SELECT * { [ rnkg:b 1 ]", Slot.PREDICATE),
        ("SELECT * { (1 2)", Slot.PREDICATE),
        ("SELECT * { ?x rnkg:a (1 2)", Slot.AFTER),
        ("SELECT * { ?x a ?y OPTIONAL", Slot.OPENING),
        ("SELECT * { ?x a ?y OPTIONAL {", Slot.SUBJECT),
        ("SELECT * { ?x a ?y OPTIONAL { ?x ?p ?o }", Slot.SUBJECT),
        ("SELECT * { FILTER", Slot.CONSTRAINT),
        ("SELECT * { FILTER(", Slot.EXPRESSION),
        ("SELECT * { FILTER NOT EXISTS {", Slot.SUBJECT),
        ("SELECT * { FILTER(?a < 1)", Slot.SUBJECT),
        ("SELECT * { FILTER(EXISTS { ?x ?y ?z })", Slot.SUBJECT),
        ("SELECT * { BIND(1 AS", Slot.NEW),
        ("SELECT * { GRAPH", Slot.GRAPH),
        ("SELECT * { GRAPH ?g", Slot.OPENING),
        ("SELECT * { VALUES", Slot.COLUMNS),
        ("SELECT * { VALUES ?x {", Slot.DATA),
        ("SELECT * { VALUES ?x { 1 }", Slot.SUBJECT),
        ("SELECT * { VALUES (?x ?y) { (1", Slot.DATA),
        ("SELECT * { ?x a ?y }", Slot.MODIFIER),
        ("SELECT * { ?x a ?y } ORDER BY", Slot.ORDER),
        ("SELECT * { ?x a ?y } LIMIT", Slot.NUMBER),
        ("SELECT * { ?x a ?y } LIMIT 1", Slot.MODIFIER),
        ("SELECT * { { SELECT ?x", Slot.PROJECTION),
        ("SELECT * { { SELECT ?x { ?x a ?y }", Slot.MODIFIER),
        ("CONSTRUCT {", Slot.SUBJECT),
        ("CONSTRUCT { ?x a ?y }", Slot.CLAUSE),
        ("CONSTRUCT { ?x a ?y } WHERE { ?x a ?y }", Slot.MODIFIER),
        ("SELECT * { ?x OPTIONAL {", Slot.SUBJECT),
    ],
)
def test_what_is_expected(text: str, slot: Slot) -> None:
    """At the end of a query, the outline contains the expected slot."""
    assert outline(tokens(text)).frame.slot is slot


def test_patterns_have_paths_and_terms() -> None:
    """Patterns are parsed with their paths, through blank nodes, with IRIs of declared and known prefixes."""
    found = outline(tokens("PREFIX e: <urn:e/> SELECT * { ?x a e:C ; rnkg:a/^rnkg:b [ rnkg:c 'v' ] , ?y . e:s ?p 1 }"))
    assert [each[:3] for each in found.patterns] == [
        ("?x", (Step(TYPE, inverse=False),), "urn:e/C"),
        ("?x", (Step(RNKG + "a", inverse=False), Step(RNKG + "b", inverse=True)), "_:2"),
        ("_:2", (Step(RNKG + "c", inverse=False),), "'v'"),
        ("?x", (Step(RNKG + "a", inverse=False), Step(RNKG + "b", inverse=True)), "?y"),
        ("urn:e/s", (Step(None, inverse=False),), "1"),
    ]


def test_variables_of_values_are_columns() -> None:
    """In a VALUES block, the outline contains the variable of each value."""
    found = outline(tokens("SELECT * { VALUES (?a ?b) { (1 2) (3"))
    assert (found.frame.columns, found.frame.column) == (["?a", "?b"], 1)


@given(
    st.lists(st.sampled_from([*"{}()[].;,^/|?*", "<<", ">>", "a", "SELECT", "VALUES", "GRAPH", "?x", "b:c", "1", "AS"]))
)
def test_reads_anything(pieces: list[str]) -> None:
    """Any text has an outline, and its outermost bracket stays open."""
    found = outline(tokens(" ".join(pieces)))
    assert found.frames[0].closes == ""
    assert all(frame.closes for frame in found.frames[1:])
