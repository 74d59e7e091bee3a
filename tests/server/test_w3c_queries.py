"""C4: the query, syntax and results suites of SPARQL 1.1 through HTTP, the failures of the engine left out."""

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
    """Return the answer to the query of a case."""
    return standard.endpoint.send("POST", "/sparql", case.query.encode(), content_type=QUERY, accept=accept)


def is_right(case: Case, answer: Answer) -> bool:
    """Tell whether an answer is the one that a case expects."""
    assert answer.status == 200, answer
    results_format = QueryResultsFormat.from_media_type(answer.media_type)
    if results_format is not None:
        return same_solutions(expected_solutions(case.result), solutions(answer.body, results_format))
    found = pyoxigraph.parse(answer.body, pyoxigraph.RdfFormat.TURTLE)
    return same_graphs(triples(case.result), [quad.triple for quad in found])


def accepted(number: int) -> str:
    """Return the formats of results in turn, each beside Turtle."""
    return f"{FORMATS[number % len(FORMATS)]}, text/turtle"


def evaluations() -> list[Any]:
    """Return the cases of evaluation, those that the engine fails marked."""
    found = []
    for case in parameters("manifest-sparql11-query.ttl", "QueryEvaluationTest"):
        identity = case.values[0].identity if case.values[0] else ""
        marks = [pytest.mark.xfail(reason=KNOWN[identity])] if identity in KNOWN else list(case.marks)
        found.append(pytest.param(*case.values, id=case.id, marks=marks))
    return found


@pytest.mark.parametrize("case", evaluations())
def test_evaluation(case: Case, standard: Standard) -> None:
    """A query answers what the suite expects, in each format of results in turn."""
    put(standard.layout, case.default, case.named)
    accept = accepted(sum(case.identity.encode()))
    assert is_right(case, ask(standard, case, accept))


@pytest.mark.parametrize("case", parameters("manifest-sparql11-results.ttl", "QueryEvaluationTest"))
def test_results(case: Case, standard: Standard) -> None:
    """Results in JSON and TSV say what the suite expects."""
    put(standard.layout, case.default, case.named)
    extension = case.result.value.rpartition(".")[2]
    results_format = QueryResultsFormat.from_extension(extension)
    assert results_format is not None
    answer = ask(standard, case, results_format.media_type)
    assert answer.media_type == results_format.media_type.partition(";")[0]
    assert is_right(case, answer)


@pytest.mark.parametrize("case", parameters("manifest-sparql11-results.ttl", "CSVResultFormatTest"))
def test_csv(case: Case, standard: Standard) -> None:
    """Results in CSV are those of the suite, whatever the order of rows and columns and the names of blank nodes."""
    put(standard.layout, case.default, case.named)
    answer = ask(standard, case, "text/csv")
    assert answer.media_type == "text/csv"
    expected = _cells(path_of(case.result).read_text(encoding="utf-8"))
    assert _cells(answer.body.decode()) == expected


def _cells(text: str) -> list[list[tuple[str, object]]]:
    """Return the cells of CSV in an order of their own, numbers as such: the engine keeps their values."""
    rows = csv.DictReader(io.StringIO(text))
    return sorted([sorted((name, _cell(value)) for name, value in row.items()) for row in rows], key=repr)


def _cell(text: str) -> object:
    try:
        return float(text)
    except ValueError:
        return "_:" if text.startswith("_:") else text


@pytest.mark.parametrize("case", parameters("manifest-sparql11-query.ttl", "PositiveSyntaxTest11"))
def test_positive_syntax(case: Case, standard: Standard) -> None:
    """What is SPARQL is answered, or refused for a function that there is not, but not for how it is written."""
    answer = ask(standard, case)
    assert answer.status == 200 or b"custom function" in answer.body


@pytest.mark.parametrize("case", parameters("manifest-sparql11-query.ttl", "NegativeSyntaxTest11"))
def test_negative_syntax(case: Case, standard: Standard) -> None:
    """What is not SPARQL is told to be none."""
    answer = ask(standard, case)
    assert answer.status == 400
    assert b"KG501" in answer.body


@pytest.mark.parametrize("case", parameters("syntax-fed/manifest.ttl", "PositiveSyntaxTest11"))
def test_federation_is_refused(case: Case, standard: Standard) -> None:
    """A query with SERVICE is refused, and not as one that does not parse."""
    answer = ask(standard, case)
    assert answer.status == 403
    assert b"KG502" in answer.body
