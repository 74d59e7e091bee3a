from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kg.errors import QueryError
from kg.query.core import run
from kg.query.diagnosis.problems import diagnose
from kg.query.stored import StoredQuery, discover
from kg.syntax.lexer import normalise

if TYPE_CHECKING:
    from kg.store.snapshot import EmbeddedSnapshot


JOIN = "Join them by a variable, or by a FILTER that compares them."
MEANT = "Did you mean `rnkg:publishes`, `rnkg:publishesUpon` or `rnkg:neverPublishes`?"
PIECES = [
    "SELECT ", "* ", "?x ", "a ", "ros:Topic ", "b:c ", "{ ", "} ", "( ", ") ", ". ", "'", '"', "\r\n", "\t",
    "\U0001f600", "#", "FILTER",
]  # fmt: skip


def under(text: str, problem: dict[str, Any]) -> str:
    """Return the characters in the range of a problem, by its line and its columns."""
    lines = normalise(text).split("\n")
    assert problem["line"] == problem["endLine"]
    found: str = lines[problem["line"] - 1][problem["column"] - 1 : problem["endColumn"] - 1]
    return found


def mended(text: str, fix: dict[str, Any]) -> str:
    """Return a text after a fix."""
    for edit in sorted(fix["edits"], key=lambda each: -each["start"]):
        text = text[: edit["start"]] + edit["text"] + text[edit["end"] :]
    return text


@pytest.mark.parametrize(
    ("text", "code", "culprit", "hint"),
    [
        ("SELECT ?x { ?x rnk:publishes ?y }", "KG501", "rnk:publishes", "Did you mean `rnkg:`?"),
        ("SELECT ?x { ?x foaf:name ?y }", "KG501", "foaf:name", "Declare it: PREFIX foaf: <http://xmlns.com/foaf/0.1/>"),
        ("SELEC ?x {}", "KG501", "SELEC", "Did you mean `SELECT`?"),
        ("SELECT ?x { ?x ?y ?z FILTR(?z) }", "KG501", "FILTR", "Did you mean `FILTER`?"),
        ("SELECT ?x {\t?x ?y '\U0001f600' foo }", "KG501", "foo", None),
        ("SELECT ?x {\r\n\t?x ?y '\U0001f600\u00e9' \U0001f600 }", "KG501", "\U0001f600", None),
        ("SELECT ?x (COUNT(?y) AS ?n) { ?x ?p ?y }", "KG501", "?x", "Group by it, or aggregate it, as in SAMPLE."),
        ("SELECT ?x { SERVICE <http://a/> { ?x ?y ?z } }", "KG502", "SERVICE", "Query the other server itself."),
        ("SELECT ?nod { ?node ?p ?o }", "KG514", "?nod", "Did you mean `?node`?"),
        ("SELECT * { ?a ?b ?c FILTER(?d > 1) }", "KG514", "?d", None),
        ("SELECT * { ?a ?b ?c . ?d ?e ?f }", "KG515", "?d ?e ?f", JOIN),
        ("SELECT * { ?n rnkg:publshes ?t }", "KG513", "rnkg:publshes", MEANT),
        ("SELECT * {\r\n ?n a ros:NodeType }", "KG513", "ros:NodeType", "Did you mean `rnkg:NodeType` or `ros:Node`?"),
    ],
)  # fmt: skip
def test_problems_stand_under_their_characters(
    examples: EmbeddedSnapshot, text: str, code: str, culprit: str, hint: str | None
) -> None:
    """Each problem has its code, its range of characters, and a suggestion (C33)."""
    (problem,) = diagnose(text, examples)
    assert (problem["code"], under(text, problem), problem["hint"]) == (code, culprit, hint)
    assert text[problem["start"] : problem["end"]] == culprit


@pytest.mark.parametrize(
    "text",
    [
        "SELECT ?x { ?x rnk:publishes ?y }",
        "SELECT ?x { ?x foaf:name ?y }",
        "SELEC ?x { ?x ?y ?z }",
        "SELECT ?x { ?x ?y ?z FILTR(?z) }",
        "SELECT ?x { ?x ?y ?z OPTIONAL { ?x ?a ?b",
        "SELECT ?nod { ?node ?p ?o }",
        "# who\r\nSELECT * { ?n\r\n rnkg:publshes ?t }",
        "SELECT * {\r\n ?x foaf:name ?y }",
    ],
)
def test_the_first_fix_mends(examples: EmbeddedSnapshot, text: str) -> None:
    """The first fix of a problem removes it."""
    (problem,) = diagnose(text, examples)
    left = {each["code"] for each in diagnose(mended(text, problem["fixes"][0]), examples)}
    assert problem["code"] not in left


@pytest.mark.parametrize(
    "text",
    [
        "",
        " \n",
        "ASK {}",
        "SELECT * { ?x a ros:Topic ; rdfs:label ?l . ?y a rnkg:NodeType ; rnkg:name ?m FILTER(?l = ?m) }",
        "SELECT * { { ?x ?y ?z } UNION { ?a ?b ?c } }",
        "SELECT * { ?x ?y ?z . VALUES ?k { 1 } }",
        "SELECT * { ?x ?y ?z . OPTIONAL { ?x ?a ?b . ?c ?d ?b } }",
        "SELECT (COUNT(*) AS ?n) { ?x ?y ?z } ORDER BY ?n",
        "CONSTRUCT { ?x ?y ?z } WHERE { ?x ?y ?z }",
        "SELECT ?x { { SELECT ?x { ?x ?y ?z } } }",
    ],
)
def test_what_is_right_has_no_problems(examples: EmbeddedSnapshot, text: str) -> None:
    """Valid queries, and a text without a query, have no problems."""
    assert diagnose(text, examples) == []


@pytest.mark.parametrize("query", discover().values(), ids=lambda query: query.name)
def test_stored_queries_have_no_problems(examples: EmbeddedSnapshot, query: StoredQuery) -> None:
    """Stored queries have no problem, except names missing from a small store."""
    assert {each["code"] for each in diagnose(query.text, examples)} <= {"KG513"}


@settings(max_examples=100, deadline=None)
@given(st.lists(st.sampled_from(PIECES), max_size=12).map("".join))
def test_tells_what_running_tells(examples: EmbeddedSnapshot, text: str) -> None:
    """The diagnostics match the error of running the query: the same code, message and place."""
    problems = diagnose(text, examples)
    assert all(0 <= each["start"] <= each["end"] <= len(text) for each in problems)
    errors = [each for each in problems if each["severity"] == "error"]
    try:
        run(examples, text, limit=1)
    except QueryError as error:
        told = [(error.code, error.message, error.place and (error.place.line, error.place.column))]
    else:
        told = []
    if text.strip():
        assert [(each["code"], each["message"], (each["line"], each["column"])) for each in errors] == told
