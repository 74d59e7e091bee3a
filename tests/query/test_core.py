"""Tests of running a query."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import pyoxigraph
import pytest
from hypothesis import given
from hypothesis import strategies as st
from patience import patient
from pyoxigraph import Literal, NamedNode

from kg.errors import Exit, QueryError
from kg.query.binding import bind, defaults
from kg.query.core import run
from kg.query.evaluation import Dataset, prepare
from kg.query.guard import MAX_CHAIN
from kg.query.result import Boolean, Graph, Solutions

if TYPE_CHECKING:
    from kg.store.snapshot import EmbeddedSnapshot

PRODUCT = "SELECT (COUNT(*) AS ?n) {" + " ".join(f"?a{i} ?b{i} ?c{i} ." for i in range(9)) + "}"
"""Takes seconds, but not forever: the engine continues after the deadline, in the process of the tests."""


def rows(snapshot: EmbeddedSnapshot, text: str, **parameters: str) -> list[tuple[object, ...]]:
    """Return the rows of a query as plain texts."""
    result = run(snapshot, text, parameters={name: Literal(value) for name, value in parameters.items()})
    assert isinstance(result, Solutions)
    return [tuple(getattr(term, "value", None) for term in row) for row in result.rows]


def failure(snapshot: EmbeddedSnapshot, text: str) -> QueryError:
    """Return the error of a query."""
    with pytest.raises(QueryError) as caught:
        run(snapshot, text)
    return caught.value


def test_prefixes_are_known(snapshot: EmbeddedSnapshot) -> None:
    """Well-known prefixes need no declaration, and the default graph is the union of all."""
    assert rows(snapshot, "SELECT DISTINCT ?n { ?s rnkg:name ?n } ORDER BY ?n") == [("a",), ("b|c",)]


def test_a_declared_prefix_wins(snapshot: EmbeddedSnapshot) -> None:
    """A prefix declared in the query overrides the well-known one."""
    assert rows(snapshot, "PREFIX rnkg: <https://example.org/> SELECT ?n { ?s rnkg:size ?n }") == [("3",)]


def test_forms_of_answers(snapshot: EmbeddedSnapshot) -> None:
    """SELECT returns rows, ASK a boolean, CONSTRUCT and DESCRIBE a graph, all with the snapshot's identity."""
    answers = [
        run(snapshot, "SELECT * { ?s ?p ?o }"),
        run(snapshot, "ASK { ?s ?p ?o }"),
        run(snapshot, "CONSTRUCT { ?s ?p 1 } { ?s ?p ?o }"),
        run(snapshot, "DESCRIBE <https://example.org/b>"),
    ]
    assert [type(answer) for answer in answers] == [Solutions, Boolean, Graph, Graph]
    assert {answer.snapshot for answer in answers} == {"1"}


@pytest.mark.parametrize(("limit", "count", "cut"), [(None, 7, None), (7, 7, None), (6, 6, 6), (0, 0, 0)])
def test_truncation_is_said(snapshot: EmbeddedSnapshot, limit: int | None, count: int, cut: int | None) -> None:
    """The result records whether there were more rows than the limit."""
    result = run(snapshot, "SELECT * { ?s ?p ?o }", limit=limit)
    assert isinstance(result, Solutions)
    assert len(result.rows) == count
    assert result.limit == cut


def test_deadline(snapshot: EmbeddedSnapshot) -> None:
    """A query that runs too long ends near its deadline, with the exit code of timeouts."""
    began = time.perf_counter()
    with pytest.raises(QueryError) as caught:
        run(snapshot, PRODUCT, timeout=0.2)
    assert time.perf_counter() - began < 0.2 + patient(0.5)
    assert caught.value.code == "KG503"
    assert caught.value.exit_code == Exit.TIMEOUT


@pytest.mark.parametrize(
    ("text", "line", "column", "words"),
    [
        ("SELECT * {\n  ?s ex:p ?o\n}", 2, 6, "the prefix `ex:` is not declared"),
        ("SELECT * {\n ?s ?p ?o .\n FILTER(?o = )}", 3, 14, "expected an expression, found `)`"),
        ("SELECT ?s WHERE { ?s ?p }", 1, 25, "expected an object, found `}`"),
        ("SELECT * { ?s ?p ?o } LIMIT x", 1, 29, "expected a whole number, found `x`"),
        ("SELECT * { ?s ?p 'abc }", 1, 18, "this quote is never closed"),
        ("SELECT * {?s ?p ?o} PREFIX a: <b:>", 1, 21, "expected the end of the query, found `PREFIX`"),
        ("SELEC ?x {}", 1, 1, "a query does not begin with `SELEC`"),
        ("PREFIX a: <b:c>\nINSERT DATA {}", 2, 1, "this is an update, not a query"),
        ("SELECT * {?s ?p ?o", 1, 19, "expected `}` or a pattern, found the end of the text"),
        ("  ", 1, 3, "the query is empty"),
        ("SELECT ?x (COUNT(?y) AS ?c) {?x ?p ?y}", 1, 8, "`?x` is not a GROUP BY key and not aggregated"),
        ("SELECT ?x { ?x ?y ?z } ORDER BY COUNT(?y)", 1, 8, "`?x` is not a GROUP BY key and not aggregated"),
        ("SELECT * { ?x ?y ?z\n BIND(1 AS ?x) }", 2, 12, "BIND assigns to `?x`, which is bound before it"),
        ("SELECT (1 AS ?x) { ?x ?y ?z }", 1, 8, "SELECT assigns to `?x`, which is bound before it"),
        ("SELECT ?x ?x { ?x ?y ?z }", 1, 11, "SELECT has `?x` twice"),
        ("SELECT * { ?x ?y ?z } GROUP BY ?x", 1, 1, "`SELECT *` conflicts with GROUP BY"),
        ("ASK { ?x ?y ?z FILTER(COUNT(?z) > 1) }", 1, 23, "the aggregate COUNT is not allowed here"),
        ("ASK { <a> ?y ?z }", 1, 7, "the IRI `<a>` is relative"),
        ("DESCRIBE <a>", 1, 10, "the IRI `<a>` is relative"),
        ("ASK { ?x <http://e/a b> ?z }", 1, 10, "an IRI must not contain U+0020"),
        ("ASK { _:x ?y ?z OPTIONAL { _:x ?p ?o } }", 1, 28, "`_:x` occurs in two patterns"),
        ("ASK { VALUES (?x ?y) { (1 2) (1) } }", 1, 30, "a row of 1 for 2 variables"),
        ("ASK { ?x ?y ?z } VALUES (?x ?y) { (1) }", 1, 35, "a row of 1 for 2 variables"),
        ("ASK { FILTER(STRLEN(?x, ?y) = 1) }", 1, 14, "STRLEN takes 1 argument, not 2"),
        ("ASK { << ?x ?y >> ?p 1 }", 1, 16, "expected an object, found `>>`"),
        ("SELECT * {?s '\u00e9\U0001f600' ?o }", 1, 14, None),
    ],
)
def test_syntax_errors_have_a_place(
    snapshot: EmbeddedSnapshot, text: str, line: int, column: int, words: str | None
) -> None:
    """A syntax error has line and column in characters, the line itself, and a description."""
    error = failure(snapshot, text)
    assert error.code == "KG501"
    assert error.place is not None
    assert (error.place.line, error.place.column) == (line, column)
    assert error.place.excerpt == text.split("\n")[line - 1]
    assert words is None or error.message == words


def test_a_base_makes_iris_absolute(snapshot: EmbeddedSnapshot) -> None:
    """With a base, a syntax error is not attributed to a relative IRI."""
    with pytest.raises(QueryError) as caught:
        prepare("ASK { <a> ?y ?z FILTR }", {}).evaluate(snapshot, Dataset(), "https://example.org/")
    assert (caught.value.message, caught.value.hint) == (
        "expected a pattern or `}`, found `FILTR`",
        "Did you mean `FILTER`?",
    )


def test_a_query_in_syntax_of_rdf_12_is_not_blamed(snapshot: EmbeddedSnapshot) -> None:
    """An error behind valid syntax that rules do not have is at its own place."""
    error = failure(snapshot, "ASK { ?x ?y ?z ~ ?r {| ?p ?o |} . FILTER(?x = ) }")
    assert (error.place and error.place.column) == 47


def test_no_prefix_is_suggested_for_an_empty_one(snapshot: EmbeddedSnapshot) -> None:
    """An unknown prefix is not answered with the empty prefix that the query declares."""
    error = failure(snapshot, "PREFIX : <urn:x:> ASK { ?x zzz:y ?z }")
    assert error.hint == "Declare it: PREFIX zzz: <...>"


def test_unknown_prefix_is_guessed(snapshot: EmbeddedSnapshot) -> None:
    """A misspelt prefix gets a suggestion."""
    assert "`rdfs:`" in (failure(snapshot, "SELECT * { ?s rdf_s:label ?o }").hint or "")


@pytest.mark.parametrize("depth", [400])
def test_what_the_guard_lets_pass_does_not_crash(snapshot: EmbeddedSnapshot, depth: int) -> None:
    """The stack of the thread is large enough for queries within the limits."""
    run(snapshot, "ASK " + "{" * depth + "}" * depth)
    run(snapshot, "ASK {FILTER(" + "?a||" * (MAX_CHAIN - 10) + "true)}")


def test_parameters_replace_their_block(snapshot: EmbeddedSnapshot) -> None:
    """A value replaces the default between the braces; without one the default applies."""
    text = 'SELECT DISTINCT ?s { VALUES ?name { "a" } ?s rnkg:name ?name }'
    assert rows(snapshot, text) == [("https://example.org/a",)]
    assert rows(snapshot, text, name="b|c") == [("https://example.org/b",)]
    assert defaults(text) == {"name": '"a"'}


def test_parameters_of_free_queries(snapshot: EmbeddedSnapshot) -> None:
    """A variable without a VALUES block is bound in the outermost group, also after a CONSTRUCT template."""
    assert rows(snapshot, "SELECT DISTINCT ?s { ?s rnkg:name ?name }", name="a") == [("https://example.org/a",)]
    result = run(snapshot, "CONSTRUCT { ?s ?p ?n } { ?s ?p ?n }", parameters={"n": Literal("a")})
    assert isinstance(result, Graph)
    assert len(result.triples) == 1


def test_unknown_parameter(snapshot: EmbeddedSnapshot) -> None:
    """A value for an unknown variable is KG505."""
    with pytest.raises(QueryError) as caught:
        run(snapshot, "SELECT * { ?s ?p ?o }", parameters={"x": NamedNode("a:a")})
    assert caught.value.code == "KG505"


def test_errors_are_placed_in_the_text_as_typed(snapshot: EmbeddedSnapshot) -> None:
    """Values of parameters do not shift the place of a later error."""
    text = 'SELECT * { VALUES ?n { "a" } ?s rnkg:name ?n . ) }'
    with pytest.raises(QueryError) as caught:
        run(snapshot, text, parameters={"n": Literal("a much longer value")})
    assert caught.value.place is not None
    assert caught.value.place.column == text.index(")") + 1


@given(st.text())
def test_a_value_never_becomes_query(value: str) -> None:
    """Whatever its value, the bound query has the same other tokens and reads the same value back."""
    value = value.encode("utf-8", "ignore").decode()
    bound = bind('SELECT ?n { VALUES ?n { "a" } }', {"n": Literal(value)})
    answer = pyoxigraph.Store().query(bound)
    assert isinstance(answer, pyoxigraph.QuerySolutions)
    assert [row["n"] for row in answer] == [Literal(value)]
