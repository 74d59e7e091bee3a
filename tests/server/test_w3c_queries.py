"""C4: the query, syntax and results suites of SPARQL 1.1 through HTTP, except the failures of the engine."""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING, Any

import pyoxigraph
import pytest
from pyoxigraph import QueryResultsFormat
from w3c import (
    KNOWN,
    Case,
    expected_solutions,
    parameters,
    path_of,
    put,
    same_graphs,
    same_solutions,
    solutions,
    triples,
)

if TYPE_CHECKING:
    from w3c_http import Answer, Standard

QUERY = "application/sparql-query"
UPDATE = "application/sparql-update"
FORMATS = ("application/sparql-results+json", "application/sparql-results+xml", "text/tab-separated-values")


def ask(standard: Standard, case: Case, accept: str = "*/*") -> Answer:
    """Return the response to the query of a case."""
    return standard.endpoint.send("POST", "/sparql", case.query.encode(), content_type=QUERY, accept=accept)


def is_right(case: Case, answer: Answer) -> bool:
    """Whether a response is the one expected by a case."""
    assert answer.status == 200, answer
    results_format = QueryResultsFormat.from_media_type(answer.media_type)
    if results_format is not None:
        return same_solutions(expected_solutions(case.result), solutions(answer.body, results_format))
    found = pyoxigraph.parse(answer.body, pyoxigraph.RdfFormat.TURTLE)
    return same_graphs(triples(case.result), [quad.triple for quad in found])


def accepted(number: int) -> str:
    """Yield the result formats in turn, each with Turtle."""
    return f"{FORMATS[number % len(FORMATS)]}, text/turtle"


def evaluations() -> list[Any]:
    """Return the evaluation cases, with those that the engine fails marked."""
    found = []
    for case in parameters("manifest-sparql11-query.ttl", "QueryEvaluationTest"):
        identity = case.values[0].identity if case.values[0] else ""
        marks = [pytest.mark.xfail(reason=KNOWN[identity])] if identity in KNOWN else list(case.marks)
        found.append(pytest.param(*case.values, id=case.id, marks=marks))
    return found


@pytest.mark.parametrize("case", evaluations())
def test_evaluation(case: Case, standard: Standard) -> None:
    """A query returns the result expected by the suite, in each result format in turn."""
    put(standard.layout, case.default, case.named)
    accept = accepted(sum(case.identity.encode()))
    assert is_right(case, ask(standard, case, accept))


@pytest.mark.parametrize("case", parameters("manifest-sparql11-results.ttl", "QueryEvaluationTest"))
def test_results(case: Case, standard: Standard) -> None:
    """Results in JSON and TSV are those expected by the suite."""
    put(standard.layout, case.default, case.named)
    extension = case.result.value.rpartition(".")[2]
    results_format = QueryResultsFormat.from_extension(extension)
    assert results_format is not None
    answer = ask(standard, case, results_format.media_type)
    assert answer.media_type == results_format.media_type.partition(";")[0]
    assert is_right(case, answer)


@pytest.mark.parametrize("case", parameters("manifest-sparql11-results.ttl", "CSVResultFormatTest"))
def test_csv(case: Case, standard: Standard) -> None:
    """Results in CSV are those of the suite, apart from the order of rows and columns and blank node labels."""
    put(standard.layout, case.default, case.named)
    answer = ask(standard, case, "text/csv")
    assert answer.media_type == "text/csv"
    expected = _cells(path_of(case.result).read_text(encoding="utf-8"))
    assert _cells(answer.body.decode()) == expected


def _cells(text: str) -> list[list[tuple[str, object]]]:
    """Return the cells of CSV in a canonical order, with numbers parsed: the engine stores their values."""
    rows = csv.DictReader(io.StringIO(text))
    return sorted([sorted((name, _cell(value)) for name, value in row.items()) for row in rows], key=repr)


def _cell(text: str) -> object:
    try:
        return float(text)
    except ValueError:
        return "_:" if text.startswith("_:") else text


@pytest.mark.parametrize("case", parameters("manifest-sparql11-query.ttl", "PositiveSyntaxTest11"))
def test_positive_syntax(case: Case, standard: Standard) -> None:
    """Valid SPARQL is never a syntax error; unknown functions may be rejected."""
    answer = ask(standard, case)
    assert answer.status == 200 or b"custom function" in answer.body


@pytest.mark.parametrize("case", parameters("manifest-sparql11-query.ttl", "NegativeSyntaxTest11"))
def test_negative_syntax(case: Case, standard: Standard) -> None:
    """Invalid SPARQL is a syntax error."""
    answer = ask(standard, case)
    assert answer.status == 400
    assert b"KG501" in answer.body


@pytest.mark.parametrize("case", parameters("syntax-fed/manifest.ttl", "PositiveSyntaxTest11"))
def test_federation_is_refused(case: Case, standard: Standard) -> None:
    """A query with SERVICE is rejected, and not as a syntax error."""
    answer = ask(standard, case)
    assert answer.status == 403
    assert b"KG502" in answer.body
