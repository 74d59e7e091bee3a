"""Tests with common Python clients of endpoints: SPARQLWrapper and rdflib's SPARQLStore."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import pyoxigraph
import pytest
import rdflib
import SPARQLWrapper
from rdflib.plugins.stores.sparqlstore import SPARQLStore, SPARQLUpdateStore
from serving import TOKEN, Serving, served

from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

pytestmark = pytest.mark.filterwarnings("ignore:ConjunctiveGraph is deprecated", "ignore:Sending Accept header")

ROWS: Final = "SELECT ?s ?o { ?s <http://www.w3.org/2000/01/rdf-schema#label> ?o } ORDER BY ?s ?o LIMIT 3"
TRUE: Final = "ASK { ?s ?p ?o }"
GRAPH: Final = "CONSTRUCT { ?s ?p ?o } { ?s ?p ?o FILTER(!isBlank(?s) && !isBlank(?o)) } LIMIT 5"
REQUESTS: Final = [("GET", "urlencoded"), ("POST", "urlencoded"), ("POST", "postdirectly")]


@pytest.fixture(scope="module")
def server(store: Path) -> Iterator[Serving]:
    """A read-only server."""
    with served(store, log="off") as found:
        yield found


def asked(server: Serving, text: str, returned: str, request: tuple[str, str]) -> tuple[str, Any]:
    """Query with SPARQLWrapper; return the media type and the parsed response."""
    wrapper = SPARQLWrapper.SPARQLWrapper(f"{server.address}/sparql")
    wrapper.setQuery(text)
    wrapper.setMethod(request[0])
    wrapper.setRequestMethod(request[1])
    wrapper.setReturnFormat(returned)
    answer = wrapper.query()
    return answer.info()["content-type"].partition(";")[0], answer.convert()


@pytest.mark.parametrize("request_method", REQUESTS)
@pytest.mark.parametrize(
    ("returned", "media_type"),
    [
        (SPARQLWrapper.JSON, "application/sparql-results+json"),
        (SPARQLWrapper.XML, "application/sparql-results+xml"),
        (SPARQLWrapper.CSV, "text/csv"),
        (SPARQLWrapper.TSV, "text/tab-separated-values"),
    ],
)
@pytest.mark.parametrize("text", [ROWS, TRUE])
def test_sparqlwrapper_reads_rows(
    server: Serving, text: str, returned: str, media_type: str, request_method: tuple[str, str]
) -> None:
    """Each row format of the library is the format of the response."""
    found, content = asked(server, text, returned, request_method)
    assert found == media_type
    if returned == SPARQLWrapper.JSON:
        assert content["boolean"] if text == TRUE else len(content["results"]["bindings"]) == 3
    else:
        assert content


@pytest.mark.parametrize("request_method", REQUESTS)
@pytest.mark.parametrize(
    "returned",
    [
        SPARQLWrapper.TURTLE,
        SPARQLWrapper.N3,
        SPARQLWrapper.RDF,
        SPARQLWrapper.RDFXML,
        SPARQLWrapper.XML,
        SPARQLWrapper.JSONLD,
    ],
)
def test_sparqlwrapper_reads_graphs(server: Serving, returned: str, request_method: tuple[str, str]) -> None:
    """Each graph format of the library has the triples."""
    found, content = asked(server, GRAPH, returned, request_method)
    graph = content if isinstance(content, rdflib.Graph) else rdflib.Graph().parse(data=content, format=found)
    assert len(graph) == 5


def test_sparqlstore_reads(server: Serving) -> None:
    """An rdflib graph on the endpoint gives the same results for queries and patterns as one in memory."""
    graph = rdflib.Graph(SPARQLStore(f"{server.address}/sparql"))
    rows = list(graph.query(ROWS))
    assert len(rows) == 3
    subject, label = rows[0]  # type: ignore[misc]  # a row of a SELECT
    assert (subject, rdflib.RDFS.label, label) in graph
    assert label in set(graph.objects(subject, rdflib.RDFS.label))
    assert len(graph) > 100
    assert bool(graph.query(TRUE))
    assert len(graph.query(GRAPH).graph or ()) == 5


def test_sparqlstore_writes(tmp_path: Path) -> None:
    """Triples added by rdflib through the endpoint are in the store; removed ones are not."""
    layout = EmbeddedStore.create(tmp_path / ".kg").layout
    with EmbeddedStore(layout).write("test") as transaction:
        transaction.replace_graphs({pyoxigraph.NamedNode("urn:g"): [b"<urn:a> <urn:b> <urn:c> .\n"]})
    triple = (rdflib.URIRef("urn:s"), rdflib.URIRef("urn:p"), rdflib.Literal("a text", lang="en"))
    with served(layout.root, write=True, token=TOKEN, log="off") as server:
        headers = {"Authorization": f"Bearer {TOKEN}"}
        address = server.address
        store = SPARQLUpdateStore(f"{address}/sparql", f"{address}/update", headers=headers)
        graph = rdflib.Graph(store, rdflib.URIRef("urn:g"))
        assert len(graph) == 1
        graph.add(triple)
        assert triple in graph
        graph.remove(triple)
        assert triple not in graph
