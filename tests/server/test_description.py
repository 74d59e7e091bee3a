"""C3: the service description, by the three tests of W3C and details they leave open."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import pyoxigraph
import pytest
import rdflib
from serving import TOKEN, application
from w3c import cases

from kg.server.negotiation import GRAPH, RESULTS

if TYPE_CHECKING:
    from pathlib import Path

    from starlette.testclient import TestClient

SD: Final = rdflib.Namespace("http://www.w3.org/ns/sparql-service-description#")
VOID: Final = rdflib.Namespace("http://rdfs.org/ns/void#")
FORMATS: Final = rdflib.Namespace("http://www.w3.org/ns/formats/")


def described(client: TestClient, path: str = "/sparql", **headers: str) -> rdflib.Graph:
    """Return the description sent for GET without a query."""
    answer = client.get(path, headers=headers)
    assert answer.status_code == 200
    return rdflib.Graph().parse(data=answer.content, format=answer.headers["content-type"].partition(";")[0])


def count(client: TestClient, query: str) -> int:
    """Return the single number that a query returns."""
    return int(client.get("/sparql", params={"query": query}).json()["results"]["bindings"][0]["n"]["value"])


def test_the_suite_is_covered() -> None:
    """The suite consists of the three tests in the next three functions."""
    known = {"has-endpoint-triple", "returns-rdf", "conforms-to-schema"}
    found = {case.identity.rpartition("#")[2] for case in cases("service-description/manifest.ttl")}
    if not found:
        pytest.skip("the suites of W3C are not beside the repository")
    assert found == known


@pytest.mark.parametrize("media_type", sorted({name for name, _ in GRAPH if name != "application/json"}))
def test_returns_rdf(client: TestClient, media_type: str) -> None:
    """GET on the endpoint returns RDF, in each format that a client accepts."""
    answer = client.get("/sparql", headers={"accept": media_type})
    assert answer.headers["content-type"].partition(";")[0] == media_type
    parsed = pyoxigraph.RdfFormat.from_media_type(media_type)
    assert len(list(pyoxigraph.parse(answer.content, parsed))) > 20


@pytest.mark.parametrize("path", ["/sparql", "/sparql/"])
@pytest.mark.parametrize("host", ["127.0.0.1:7878", "localhost:7878"])
def test_has_endpoint_triple(client: TestClient, path: str, host: str) -> None:
    """The description names the requested address as the endpoint."""
    graph = described(client, path, host=host)
    assert [str(found) for found in graph.objects(None, SD.endpoint)] == [f"http://{host}{path}"]


def test_conforms_to_schema(client: TestClient) -> None:
    """Each term of the vocabulary has the type and cardinality of the specification."""
    graph = described(client)
    (service,) = graph.subjects(rdflib.RDF.type, SD.Service)
    (dataset,) = graph.objects(service, SD.defaultDataset)
    assert (dataset, rdflib.RDF.type, SD.Dataset) in graph
    (default,) = graph.objects(dataset, SD.defaultGraph)
    assert (default, rdflib.RDF.type, SD.Graph) in graph
    for named in graph.objects(dataset, SD.namedGraph):
        assert (named, rdflib.RDF.type, SD.NamedGraph) in graph
        assert len(list(graph.objects(named, SD.name))) == 1
        (content,) = graph.objects(named, SD.graph)
        assert (content, rdflib.RDF.type, SD.Graph) in graph
    assert list(graph.objects(service, SD.supportedLanguage)) == [SD.SPARQL11Query]
    assert not list(graph.objects(service, SD.extensionFunction))
    known = {SD[name] for name in ("UnionDefaultGraph", "EmptyGraphs")}
    assert set(graph.objects(service, SD.feature)) == known


def test_formats_are_computed(client: TestClient) -> None:
    """The listed formats are exactly those of responses."""
    listed = {str(found).removeprefix(FORMATS) for found in described(client).objects(None, SD.resultFormat)}
    known = {name for _, name in (*RESULTS, *GRAPH)} - {"jsonl", "markdown", "parquet"}
    assert len(listed) == len(known)
    assert {"SPARQL_Results_JSON", "Turtle", "N-Triples"} <= listed


def test_counts(client: TestClient) -> None:
    """The counts of the default graph and of each named one equal those of queries."""
    graph = described(client)
    (default,) = graph.objects(None, SD.defaultGraph)
    assert int(str(graph.value(default, VOID.triples))) == count(client, "SELECT (COUNT(*) AS ?n) { ?s ?p ?o }")
    names = list(graph.subject_objects(SD.name))
    assert len(names) == count(client, "SELECT (COUNT(*) AS ?n) { SELECT DISTINCT ?g { GRAPH ?g { ?s ?p ?o } } }")
    for named, name in names[:5]:
        content: Any = graph.value(named, SD.graph)
        counted = count(client, f"SELECT (COUNT(*) AS ?n) {{ GRAPH <{name}> {{ ?s ?p ?o }} }}")
        assert int(str(graph.value(content, VOID.triples))) == counted


def test_what_is_not_there_is_not_described(store: Path) -> None:
    """Updates are described on writable servers, and the union of graphs if it is the default."""
    with application(store, write=True, token=TOKEN, no_union=True, log="off") as writing:
        graph = described(writing)
        assert SD.SPARQL11Update in set(graph.objects(None, SD.supportedLanguage))
        assert "http://127.0.0.1:7878/update" in {str(found) for found in graph.objects(None, SD.endpoint)}
        assert SD.UnionDefaultGraph not in set(graph.objects(None, SD.feature))
        (default,) = graph.objects(None, SD.defaultGraph)
        assert int(str(graph.value(default, VOID.triples))) == count(writing, "SELECT (COUNT(*) AS ?n) { ?s ?p ?o }")


def test_only_rdf(client: TestClient) -> None:
    """A client that accepts no RDF gets an error."""
    answer = client.get("/sparql", headers={"accept": "text/csv"})
    assert (answer.status_code, answer.json()["code"]) == (406, "KG523")
