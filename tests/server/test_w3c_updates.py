"""C4: the update suite of SPARQL 1.1 through HTTP, except LOAD, because no other server is called."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from pyoxigraph import DefaultGraph, NamedNode, Quad, RdfFormat, parse
from w3c import Case, parameters, path_of, put, same_graphs

from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from w3c_http import Answer, Standard

UPDATE = "application/sparql-update"
SUITE = "manifest-sparql11-update.ttl"


def send(standard: Standard, case: Case) -> Answer:
    """Return the response to the update of a case."""
    return standard.endpoint.send("POST", "/update", case.query.encode(), content_type=UPDATE)


def is_load(case: Case) -> bool:
    """Whether a case makes the store call another server."""
    return "load " in case.query.partition("\n")[2].lower()


def quads(default: list[Any], named: dict[str, Any]) -> list[Any]:
    """Return the quads of files of the default graph and of named graphs."""
    files: list[tuple[Any, Any]] = [
        *((file, DefaultGraph()) for file in default),
        *((file, NamedNode(name)) for name, file in named.items()),
    ]
    return [
        Quad(one.subject, one.predicate, one.object, graph)
        for file, graph in files
        for one in parse(path_of(file).read_bytes(), RdfFormat.TURTLE, base_iri=file.value)
    ]


@pytest.mark.parametrize("case", parameters(SUITE, "UpdateEvaluationTest"))
def test_evaluation(case: Case, standard: Standard) -> None:
    """The store has the data expected by the suite; LOAD SILENT is rejected, which leaves the expected data, too."""
    put(standard.layout, case.default, case.named)
    answer = send(standard, case)
    assert (answer.status, b"KG502" in answer.body) == ((403, True) if is_load(case) else (200, False)), answer
    with EmbeddedStore(standard.layout).read() as snapshot:
        assert same_graphs(quads(*case.after), list(snapshot.quads()))


@pytest.mark.parametrize("case", parameters(SUITE, "PositiveUpdateSyntaxTest11"))
def test_positive_syntax(case: Case, standard: Standard) -> None:
    """A valid update succeeds, fails for a missing graph, or is rejected as LOAD."""
    put(standard.layout)
    answer = send(standard, case)
    refused = is_load(case) and b"KG502" in answer.body
    assert answer.status == 200 or refused or b"KG560" in answer.body, answer


@pytest.mark.parametrize("case", parameters(SUITE, "NegativeUpdateSyntaxTest11", "NegativeSyntaxTest11"))
def test_negative_syntax(case: Case, standard: Standard) -> None:
    """An invalid update is a syntax error, and LOAD is rejected in any spelling."""
    put(standard.layout)
    answer = send(standard, case)
    expected = (403, b"KG502") if is_load(case) else (400, b"KG501")
    assert answer.status == expected[0], answer
    assert expected[1] in answer.body
