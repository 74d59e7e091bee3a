"""Tests that a read-only server changes nothing, C16, for any request."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Any

import pytest

from kg.store.layout import Layout

if TYPE_CHECKING:
    from pathlib import Path

    from starlette.testclient import TestClient

UPDATES = [
    "INSERT DATA { <a:a> <a:b> <a:c> }",
    "DELETE DATA { <a:a> <a:b> <a:c> }",
    "DELETE WHERE { ?s ?p ?o }",
    "DELETE { ?s ?p ?o } INSERT { ?o ?p ?s } WHERE { ?s ?p ?o }",
    "WITH <a:g> DELETE { ?s ?p ?o } WHERE { ?s ?p ?o }",
    "CLEAR ALL",
    "CLEAR SILENT DEFAULT",
    "DROP ALL",
    "CREATE GRAPH <a:g>",
    "COPY DEFAULT TO <a:g>",
    "MOVE DEFAULT TO <a:g>",
    "ADD DEFAULT TO <a:g>",
    "LOAD <http://127.0.0.1:9/>",
    "LOAD SILENT <file:///etc/passwd> INTO GRAPH <a:g>",
    "PREFIX a: <a:> BASE <a:b> insert data { a:a a:b a:c } ; clear all",
]
TRIPLE = b"<a:a> <a:b> <a:c> ."
TURTLE = {"Content-Type": "text/turtle"}
PATHS = ("/store?default", "/store?graph=a:g", "/store", "/store/", "/store/name", "/store/a/b")


def digest(store: Path) -> dict[str, str]:
    """Return a hash of every file of the store except the log that the engine writes while reading."""
    folder = Layout(store).generation(Layout(store).current() or 0)
    files = [store / "current", *sorted(folder.glob("*.sst"))]
    return {str(file): hashlib.sha256(file.read_bytes()).hexdigest() for file in files}


@pytest.fixture
def unchanged(store: Path, client: TestClient) -> Any:
    """Assert after a test that the store is unchanged: its files and its number of quads."""
    counting = {"query": "SELECT (COUNT(*) AS ?n) { GRAPH ?g { ?s ?p ?o } }", "format": "csv"}
    before, count = digest(store), client.get("/sparql", params=counting).text
    yield
    assert digest(store) == before
    assert client.get("/sparql", params=counting).text == count


@pytest.mark.usefixtures("unchanged")
def test_no_update_is_taken(client: TestClient) -> None:
    """Every form of update at every update address is rejected: 403, or 400 if it is not a query."""
    for text in UPDATES:
        direct = {"Content-Type": "application/sparql-update"}
        answers = [
            client.post("/update", content=text, headers=direct),
            client.post("/update/", content=text, headers=direct),
            client.post("/update", data={"update": text}),
            client.post("/update", files={"update": text}),
            client.put("/update", content=text, headers=direct),
            client.get("/update", params={"update": text}),
            client.get("/sparql", params={"update": text}),
            client.post("/sparql", params={"update": text}),
            client.post("/", params={"update": text}),
        ]
        for answer in answers:
            assert (answer.status_code, answer.json()["code"]) == (403, "KG530"), answer.request.url
        for answer in (
            client.post("/sparql", content=text, headers=direct),
            client.post("/sparql", data={"update": text}),
            client.get("/sparql", params={"query": text}),
            client.post("/sparql", data={"query": text}),
            client.request("QUERY", "/sparql", content=text, headers={"Content-Type": "application/sparql-query"}),
        ):
            assert answer.status_code in {400, 403, 415}, (answer.request.url, answer.text)


@pytest.mark.usefixtures("unchanged")
@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize("method", ["PUT", "POST", "DELETE", "PATCH"])
def test_no_graph_is_changed(client: TestClient, method: str, path: str) -> None:
    """Every changing method of the Graph Store Protocol is rejected."""
    answer = client.request(method, path, content=TRIPLE, headers=TURTLE)
    assert (answer.status_code, answer.json()["code"]) == (403, "KG530")


@pytest.mark.usefixtures("unchanged")
@pytest.mark.parametrize(
    "headers",
    [
        {"X-HTTP-Method-Override": "DELETE"},
        {"X-HTTP-Method": "PUT"},
        {"X-Method-Override": "PUT"},
        {"Authorization": "Bearer "},
        {"Authorization": "Bearer None"},
    ],
)
def test_no_header_makes_it_write(client: TestClient, headers: dict[str, str]) -> None:
    """A header that other servers use to override the method, or an empty token, changes nothing."""
    client.get("/store?default", headers=headers)
    client.post("/sparql", data={"query": "ASK{}"}, headers=headers)
    answer = client.post("/update", data={"update": "CLEAR ALL"}, headers=headers)
    assert (answer.status_code, answer.json()["code"]) == (403, "KG530")
