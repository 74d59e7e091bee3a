"""Tests that the endpoint calls no other server, C18 and C19, and opens no file named by a client, C20."""

from __future__ import annotations

import contextlib
import os
import socket
import threading
from typing import TYPE_CHECKING, Any

import pytest
from pyoxigraph import NamedNode
from serving import TOKEN, application

from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from starlette.testclient import TestClient

QUERIES = [
    "SELECT * { SERVICE <IRI> { ?s ?p ?o } }",
    "SELECT * { service <IRI> { ?s ?p ?o } }",
    "SELECT * { SERVICE#comment\n<IRI> { ?s ?p ?o } }",
    "SELECT * { SERVICE SILENT <IRI> { ?s ?p ?o } }",
    "SELECT * { VALUES ?g { <IRI> } SERVICE ?g { ?s ?p ?o } }",
    "SELECT * { BIND(<IRI> AS ?g) SERVICE SILENT ?g { ?s ?p ?o } }",
    "SELECT * { { SELECT * { SERVICE <IRI> { ?s ?p ?o } } } }",
    "SELECT * { OPTIONAL { SERVICE <IRI> { ?s ?p ?o } } }",
    "SELECT * { FILTER EXISTS { SERVICE <IRI> { ?s ?p ?o } } }",
    "SELECT * { FILTER NOT EXISTS { ?s ?p ?o MINUS { SERVICE <IRI> { ?s ?p ?o } } } }",
    "PREFIX : <IRI> SELECT * { SERVICE:a { ?s ?p ?o } }",
    "BASE <IRI> SELECT * { SERVICE <a> { ?s ?p ?o } }",
    "CONSTRUCT { ?s ?p ?o } WHERE { SERVICE <IRI> { ?s ?p ?o } }",
    "DESCRIBE ?s WHERE { SERVICE <IRI> { ?s ?p ?o } }",
    "ASK { SERVICE <IRI> { ?s ?p ?o } }",
    "SELECT * {FILTER(1<2)SERVICE<IRI>#>\n{?s ?p ?o}}",
    "SELECT * {# \rSERVICE <IRI> {?s ?p ?o}\n}",
]
UPDATES = [
    "LOAD <IRI>",
    "load <IRI>",
    "LOAD SILENT <IRI>",
    "LOAD <IRI> INTO GRAPH <a:g>",
    "LOAD#comment\n<IRI>",
    "CLEAR DEFAULT ; LOAD <IRI>",
    "PREFIX a: <IRI> LOAD a:b",
    "INSERT { ?s ?p ?o } WHERE { SERVICE <IRI> { ?s ?p ?o } }",
    "DELETE { ?s ?p ?o } WHERE { SERVICE SILENT <IRI> { ?s ?p ?o } }",
]
HARMLESS = [
    "ASK { ?s ?p 'SERVICE <IRI> {}' }",
    "ASK { ?s ?p '''LOAD <IRI>''' }",
    "ASK { ?s <IRI/SERVICE> ?SERVICE }",
    "ASK { ?s <IRI#LOAD> $service } # SERVICE <IRI> {}",
    "PREFIX service: <IRI> ASK { service:SERVICE ?p service:load }",
    "PREFIX kg: <IRI> ASK { kg:SERVICE ?load ?SERVICE }",
    "SELECT * FROM <IRI> { ?s ?p ?o }",
    "SELECT * FROM NAMED <IRI> { GRAPH ?g { ?s ?p ?o } }",
    "SELECT * { GRAPH <IRI> { ?s ?p ?o } }",
    "DESCRIBE <IRI>",
]


@pytest.fixture(scope="module")
def writing(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    """A writable server with a small store."""
    root = tmp_path_factory.mktemp("called") / ".kg"
    with EmbeddedStore.create(root).write("test") as transaction:
        transaction.replace_graphs({NamedNode("a:g"): [b"<a:a> <a:b> <a:c> .\n"]})
    with application(root, write=True, token=TOKEN, log="off") as found:
        found.headers["Authorization"] = f"Bearer {TOKEN}"
        yield found


@pytest.fixture
def listener() -> Iterator[str]:
    """The address of a server that must not be called; a call fails the test afterwards."""
    calls: list[Any] = []
    listening = socket.create_server(("127.0.0.1", 0))

    def serve() -> None:
        with contextlib.suppress(OSError):
            while True:
                connection, address = listening.accept()
                calls.append(address)
                connection.close()

    threading.Thread(target=serve, daemon=True).start()
    yield f"http://127.0.0.1:{listening.getsockname()[1]}/"
    listening.close()
    assert not calls


@pytest.mark.parametrize("text", QUERIES)
def test_no_query_calls_a_server(writing: TestClient, listener: str, text: str) -> None:
    """SERVICE, in any spelling and position, is rejected with the reason: 403."""
    text = text.replace("<IRI>", f"<{listener}>")
    for answer in (
        writing.get("/sparql", params={"query": text}),
        writing.post("/sparql", data={"query": text}),
        writing.post("/sparql", content=text, headers={"Content-Type": "application/sparql-query"}),
    ):
        assert (answer.status_code, answer.json()["code"]) == (403, "KG502"), answer.text
        assert "another server" in answer.json()["message"]


@pytest.mark.parametrize("text", UPDATES)
def test_no_update_calls_a_server(writing: TestClient, listener: str, text: str) -> None:
    """LOAD and SERVICE are rejected in updates, too."""
    text = text.replace("<IRI>", f"<{listener}>")
    for answer in (
        writing.post("/update", data={"update": text}),
        writing.post("/update", content=text, headers={"Content-Type": "application/sparql-update"}),
    ):
        assert (answer.status_code, answer.json()["code"]) == (403, "KG502"), answer.text


@pytest.mark.parametrize("text", HARMLESS)
def test_words_and_names_pass(writing: TestClient, listener: str, text: str) -> None:
    """The words are allowed unless they are keywords, and a graph's name is never fetched."""
    text = text.replace("<IRI", f"<{listener}")
    answer = writing.get("/sparql", params={"query": text})
    assert answer.status_code == 200, answer.text


def test_names_of_graphs_are_not_fetched(writing: TestClient, listener: str) -> None:
    """A graph named by a parameter is one of the store, whatever its name."""
    for parameter in ("default-graph-uri", "named-graph-uri"):
        answer = writing.get("/sparql", params={"query": "SELECT * { ?s ?p ?o }", parameter: listener})
        assert answer.status_code == 200
    body = {"update": "INSERT { <a:a> <a:b> ?o } WHERE { ?s ?p ?o }", "using-graph-uri": listener}
    assert writing.post("/update", data=body).status_code == 200
    assert writing.get("/store", params={"graph": listener}).status_code == 404


def test_documents_fetch_nothing(writing: TestClient, listener: str) -> None:
    """JSON-LD that names a remote context, and XML with an entity, are rejected or accepted, but nothing is fetched."""
    context = f'{{"@context": "{listener}", "@id": "a:a", "a:b": "c"}}'
    entity = (
        f'<!DOCTYPE r [<!ENTITY x SYSTEM "{listener}">]><r xmlns="http://www.w3.org/1999/02/22-rdf-syntax-ns#">&x;</r>'
    )
    for kind, content in (("application/ld+json", context), ("application/rdf+xml", entity)):
        answer = writing.put("/store?graph=a:g", content=content, headers={"Content-Type": kind})
        assert 400 <= answer.status_code < 500, answer.text


def is_read(pipe: Path) -> bool:
    """Whether a process has opened a pipe for reading: then it can be opened for writing."""
    try:
        os.close(os.open(pipe, os.O_WRONLY | os.O_NONBLOCK))
    except OSError:
        return False
    return True


def test_no_file_is_opened(writing: TestClient, tmp_path: Path) -> None:
    """`file:` is an ordinary name: a process that opened the file, a pipe, would block and be detected."""
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    iri = pipe.as_uri()
    queries = [text.replace("<IRI", f"<{iri}") for text in (*QUERIES, *HARMLESS)]
    for text in queries:
        assert writing.get("/sparql", params={"query": text}).status_code in {200, 403}
    for text in UPDATES:
        answer = writing.post("/update", data={"update": text.replace("<IRI", f"<{iri}")})
        assert answer.status_code == 403
    for parameter in ("default-graph-uri", "named-graph-uri"):
        writing.get("/sparql", params={"query": "SELECT * { ?s ?p ?o }", parameter: iri})
    for path in (
        f"/store?graph={iri}",
        f"/store/{iri}",
        f"/static/..{pipe}",
        f"/static/%2e%2e{pipe}",
        f"/vendor/{pipe}",
    ):
        assert writing.get(path).status_code in {400, 404}
    assert not is_read(pipe)
    descriptor = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    assert is_read(pipe)
    os.close(descriptor)
