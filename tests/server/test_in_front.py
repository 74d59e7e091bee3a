"""`kg serve` in front of a SPARQL server shows the same as for a store with the same graph."""

from __future__ import annotations

import re
from contextlib import ExitStack
from typing import TYPE_CHECKING

import pytest
from patience import until
from serving import TOKEN, application
from store.servers import load_server, oxigraph_server

from kg.errors import StoreError
from kg.store.remote import RemoteStore

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from starlette.testclient import TestClient

COMPLETIONS = "/api/complete?text=SELECT+*+{+?x+ros:&position=21"
PAGES = [
    "/",
    "/search?q=laser+scan",
    "/query",
    "/rule-blocks",
    "/node?name=patrol",
    "/channel?kind=topic&name=/cmd_vel",
    "/system?name=rover_robot/launch/rover.launch",
    "/system?name=rover_robot/launch/rover.launch&camera=false",
    "/resource?iri=https://w3id.org/rnkg/topic/cmd_vel",
    "/why?subject=patrol&predicate=subscribes&object=scan_filtered",
    "/nodes",
    "/topics",
    "/services",
    "/actions",
    "/packages",
    "/systems",
    "/parameters",
    "/types",
    "/hardware",
    "/functions",
    "/capabilities",
    "/findings",
    "/openapi.json",
    "/api/choices",
    COMPLETIONS,
    "/api/diagnose?text=SELECT+*+{+?x+ros:foo+?y+}",
    "/api/find?text=laser+scan",
    "/api/lint",
    "/api/node?name=patrol",
    "/api/overview",
    "/api/parameter?name=max_speed",
    "/api/prefixes",
    "/api/stored",
    "/api/systems",
    "/api/why?subject=patrol&predicate=subscribes&object=scan_filtered",
    "/api/why_not?subject=patrol&predicate=subscribes&object=topic/cmd_vel",
    "/sparql",
]
QUERIES = [
    "ASK { ?node a ros:Node }",
    "SELECT ?node ?topic { ?node rnkg:publishes/rdfs:label ?topic } ORDER BY ?node ?topic",
    "SELECT ?g (COUNT(*) AS ?n) { GRAPH ?g { ?s ?p ?o } } GROUP BY ?g ORDER BY ?g",
    "SELECT (COUNT(*) AS ?n) FROM <https://w3id.org/rnkg/graph/inferred> { ?s ?p ?o }",
    "CONSTRUCT { ?node a ros:Node } { ?node a ros:Node } ORDER BY ?node",
    "SELECT * { SERVICE <http://127.0.0.1:9/> { ?s ?p ?o } }",
    "SELECT * {",
    "SELECT ?s { ?s ?p ?o } LIMIT -1",
]


@pytest.fixture(scope="module")
def server(store: Path) -> Iterator[str]:
    """The query address of an Oxigraph server with the graph of the store."""
    with oxigraph_server() as found:
        load_server(store, RemoteStore(f"{found}/query", f"{found}/update"))
        yield f"{found}/query"


@pytest.fixture(scope="module")
def front(server: str, client: TestClient) -> Iterator[TestClient]:
    """A client of `kg serve` in front of the server, when both have counted the terms that they complete."""
    # The default deadline of a test depends on the load when its server starts, and the query page shows it.
    seconds = client.app.state.server.options.seconds  # type: ignore[attr-defined]  # an application of Starlette
    with application(server, log="off", seconds=seconds) as found:
        until(lambda: bool(client.get(COMPLETIONS).json()["ready"]))
        until(lambda: bool(found.get(COMPLETIONS).json()["ready"]))
        yield found


def _shown(client: TestClient, address: str) -> tuple[int, str]:
    """Return status and text of a response without the number of the snapshot, which a front gets a moment later."""
    found = client.get(address)
    return found.status_code, re.sub(
        r'(Snapshot <strong>|"snapshot": ?"?|&#34;snapshot&#34;:|data-snapshot=")(?:\d+|none|null)', r"\1", found.text
    )


@pytest.mark.parametrize("address", PAGES)
def test_a_page_is_that_of_the_store(client: TestClient, front: TestClient, address: str) -> None:
    """Status and text are equal."""
    here = _shown(client, address)
    assert _shown(front, address) == here
    assert here[0] == 200


@pytest.mark.parametrize("graphs", [{}, {"default-graph-uri": "https://w3id.org/rnkg/graph/inferred"}], ids=len)
@pytest.mark.parametrize("query", QUERIES)
def test_a_query_has_the_answer_of_the_store(
    client: TestClient, front: TestClient, query: str, graphs: dict[str, str]
) -> None:
    """Responses to queries, including rejected ones, are equal."""
    here, there = (one.post("/sparql", data={"query": query, **graphs}) for one in (client, front))
    assert (there.status_code, sorted(there.text.splitlines())) == (here.status_code, sorted(here.text.splitlines()))


@pytest.mark.parametrize("method", ["PUT", "POST", "DELETE"])
def test_nothing_is_changed(front: TestClient, method: str) -> None:
    """The error explains where to make changes."""
    found = front.request(method, "/store?graph=urn:g", headers={"Content-Type": "text/turtle"})
    assert found.status_code == 403
    assert "Send changes to the SPARQL server itself" in found.text


def test_writing_is_refused_at_the_start(server: str) -> None:
    """`--write` in front of a server is KG309."""
    refused = pytest.raises(StoreError, match="does not change the data of another server")
    with refused as caught, application(server, write=True, token=TOKEN):
        pass
    assert caught.value.code == "KG309"


def test_a_server_must_answer_at_the_start() -> None:
    """An unreachable server is KG225."""
    with pytest.raises(StoreError, match="cannot connect to the server"), application("http://127.0.0.1:9/query"):
        pass


def test_a_server_that_went_away_is_reported() -> None:
    """Queries and views get 502 with the reason."""
    with ExitStack() as stack:
        with oxigraph_server() as found:
            client = stack.enter_context(application(f"{found}/query", log="off"))
        answers = [client.get("/sparql?query=ASK{?s ?p ?o}"), client.get("/api/overview")]
    assert [answer.status_code for answer in answers] == [502, 502]
    assert "cannot connect to the server" in answers[0].text
