"""Tests of what a query looks like that nothing is known of."""

from __future__ import annotations

import time

import pytest

from kg.query.readers.looks import looks_bounded


@pytest.mark.parametrize(
    "text",
    [
        "ASK {}",
        "ASK { ?s a <x:Node> }",
        "PREFIX kg: <x:> SELECT ?a ?b WHERE { ?a a kg:Node ; kg:has ?b . ?b ?p 2 . ?b kg:is 1 } ORDER BY ?a",
        "SELECT * { GRAPH ?g { <x:s> ?p ?o } OPTIONAL { ?o a ?t } FILTER(?o != ?other) }",
        "SELECT * { { SELECT ?s { ?s a 'text' } } UNION { ?s <x:p>/<x:q> 'a { b . c' } } # { ?x ?y ?z }",
        "SELECT * { ?a <x:p> ?b . ?c <x:p> ?d . ?b <x:p> ?c }",
    ],
)
def test_patterns_that_hang_together(text: str) -> None:
    """Patterns that share variables, each with a constant, look bounded, whatever clauses stand around them."""
    assert looks_bounded(text)


@pytest.mark.parametrize(
    "text",
    [
        "ASK { ?s ?p ?o }",
        "SELECT (COUNT(*) AS ?n) { ?a ?b ?c . ?d ?e ?f }",
        "SELECT ?a ?b { ?a a <x:Node> . ?b a <x:Node> }",
        "SELECT ?a ?b { { ?a a <x:Node> } { ?b a <x:Node> } FILTER(?a = ?b) }",
        "SELECT * {" + "".join(f"?a{number} a 1 ." for number in range(20)) + "}",
        "ASK { ?s a <x:Node> } #" + " " * 5000,
    ],
)
def test_products_and_scans(text: str) -> None:
    """A pattern of variables alone, patterns with nothing in common, and texts too long to look at do not."""
    assert not looks_bounded(text)


@pytest.mark.parametrize("part", ["{", "?a ", "?a a 1 .", "<", "'", "a:b ", ". ", "SELECT{", "#"])
def test_a_look_costs_little(part: str) -> None:
    """No text takes the process that all requests go through more than a moment."""
    began = time.process_time()
    for _ in range(5):
        looks_bounded(("{" + part * 4096)[:4096])
    assert time.process_time() - began < 1
