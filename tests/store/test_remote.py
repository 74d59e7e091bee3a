"""The content of a SPARQL server conforms to the interface of stores."""

from __future__ import annotations

import socket
import threading
from http.server import BaseHTTPRequestHandler, HTTPServer
from io import BytesIO
from typing import TYPE_CHECKING, ClassVar

import pytest
from ports import own_port
from pyoxigraph import NamedNode, QueryBoolean, QuerySolutions, QueryTriples, RdfFormat
from store.servers import append, oxigraph_server

from kg.errors import Exit, StoreError
from kg.store.http import Endpoint
from kg.store.remote import RemoteStore

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.store.interface import Snapshot

GRAPH = NamedNode("https://example.org/g")
OTHER = NamedNode("https://example.org/h")


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    """One server for all tests of this file."""
    with oxigraph_server() as found:
        yield found


@pytest.fixture
def store(address: str) -> RemoteStore:
    """The server, empty."""
    remote = RemoteStore(f"{address}/query", f"{address}/update")
    remote.update("DROP ALL")
    return remote


def _read(snapshot: Snapshot) -> tuple[int, bytes]:
    """Read through the interface only."""
    return snapshot.count(GRAPH), snapshot.dump(RdfFormat.N_TRIPLES, graph=GRAPH)


def test_a_server_keeps_to_the_interface(store: RemoteStore) -> None:
    """Operations of one request run in their order, and their result is read back through the interface."""
    store.update(
        "PREFIX g: <https://example.org/> INSERT DATA { GRAPH g:g { <urn:a> <urn:b> <urn:c>, <urn:d> } } ;"
        " DELETE DATA { GRAPH g:g { <urn:a> <urn:b> <urn:c> } }"
    )
    with store.read() as snapshot:
        assert _read(snapshot) == (1, b"<urn:a> <urn:b> <urn:d> .\n")


@pytest.mark.parametrize("in_memory", [1, 1 << 20], ids=["through a file", "in memory"])
def test_each_kind_of_query_gives_its_kind_of_result(
    store: RemoteStore, monkeypatch: pytest.MonkeyPatch, in_memory: int
) -> None:
    """SELECT, ASK and CONSTRUCT over the union of graphs have the same results as in the embedded engine."""
    monkeypatch.setattr("kg.store.http._IN_MEMORY", in_memory)
    append(store, GRAPH, b"<urn:a> <urn:b> <urn:d> .\n")
    snapshot: Snapshot = store.read()
    rows = snapshot.query("SELECT ?o { ?s ?p ?o }")
    assert isinstance(rows, QuerySolutions)
    assert [row["o"] for row in rows] == [NamedNode("urn:d")]
    found = snapshot.query("ASK { ?s u:b ?o }", prefixes={"u": "urn:"})
    assert isinstance(found, QueryBoolean)
    assert found
    triples = snapshot.query("CONSTRUCT { ?o ?p ?s } WHERE { ?s ?p ?o }")
    assert isinstance(triples, QueryTriples)
    assert [str(triple.subject) for triple in triples] == ["<urn:d>"]


def test_all_graphs_are_listed_counted_and_dumped(store: RemoteStore) -> None:
    """Named graphs and the default graph are counted; a format without graphs has each triple once."""
    store.update('INSERT DATA { GRAPH <urn:g> { <urn:a> <urn:b> _:c } <urn:a> <urn:b> "x" }')
    append(store, GRAPH, b'<urn:a> <urn:b> "x" .\n')
    append(store, OTHER, b"_:c <urn:b> _:d .\n")
    with store.read() as snapshot:
        assert snapshot.graphs() == [GRAPH, OTHER, NamedNode("urn:g")]
        assert snapshot.count() == 4
        assert snapshot.count(OTHER) == 1
        assert len(snapshot.dump(RdfFormat.N_QUADS).splitlines()) == 4
        assert len(snapshot.dump(RdfFormat.N_TRIPLES).splitlines()) == 3


def test_a_refused_request_tells_status_and_first_line(store: RemoteStore) -> None:
    """The message contains the server's text, and the place is the address."""
    with pytest.raises(
        StoreError, match=r"^http://127.0.0.1:\d+/update: KG225: the server answered 400 Bad Request: e"
    ):
        store.update("INSERT nonsense")


def test_a_server_that_is_not_there_is_tried_again_and_named_without_password() -> None:
    """User, password and parameters of the address are not shown."""
    with own_port() as port:
        store = RemoteStore(f"http://me:secret@127.0.0.1:{port}/query?key=secret")
        with pytest.raises(StoreError, match="cannot connect") as caught:
            store.read().count()
    error = caught.value
    assert error.code == "KG225"
    assert error.exit_code == Exit.STORE
    assert "secret" not in f"{error} {error.hint} {store.address}"


def test_an_address_that_is_none_is_refused() -> None:
    """Only http and https are supported."""
    with pytest.raises(StoreError, match="not the address of a server"):
        RemoteStore("file:///etc/passwd")


class _Told(BaseHTTPRequestHandler):
    """Responds as its path says (/moved to /queries); /flaky breaks the first connection."""

    seen: ClassVar[list[tuple[str, str | None]]] = []

    def do_POST(self) -> None:
        self.rfile.read(int(self.headers["Content-Length"] or 0))
        self.seen.append((self.path, self.headers["Authorization"]))
        if self.path == "/flaky" and len(self.seen) == 1:
            return
        status, kind, body = {
            "/moved": (301, "text/plain", b""),
            "/secret": (401, "text/plain", b"\n  who are you\nmore"),
            "/kept": (403, "application/problem+json", b'{"message": "the graph is kept", "hint": "Leave it out."}'),
            "/html": (200, "text/html", b"<p>welcome"),
            "/broken": (200, "application/sparql-results+json", b"{"),
            "/cut": (200, "application/sparql-results+json", b"{"),
            "/queries": (400, "text/plain", b"the query must be set"),
            "/flaky": (200, "application/sparql-results+json", b'{"head":{},"boolean":true}'),
        }[self.path]
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Location", "http://127.0.0.1:1/")
        if self.path == "/cut":
            self.send_header("Content-Length", "1000")
        self.end_headers()
        self.wfile.write(body)

    do_GET = do_POST  # noqa: N815 - the name that the base class calls

    def log_message(self, *_: object) -> None:
        """Log nothing."""


@pytest.fixture
def told() -> Iterator[str]:
    """Run a server with scripted responses."""
    _Told.seen.clear()
    with HTTPServer(("127.0.0.1", 0), _Told) as server:
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
        thread.start()
        yield f"127.0.0.1:{server.server_port}"
        server.shutdown()
        thread.join()


def test_how_long_was_waited_is_told() -> None:
    """The error about a silent server contains the timeout of this request."""
    with socket.create_server(("127.0.0.1", 0)) as silent:
        store = RemoteStore(f"http://127.0.0.1:{silent.getsockname()[1]}/query")
        with pytest.raises(StoreError, match=r"did not answer within 0\.05 s"):
            store.read().query("ASK {}", timeout=0.05)


def test_a_connection_closed_early_is_told_with_likely_reasons() -> None:
    """A server that closes the connection without reading a large request is not reported as unreachable."""
    with socket.create_server(("127.0.0.1", 0)) as server:

        def close() -> None:
            server.accept()[0].close()

        closing = threading.Thread(target=close)
        closing.start()
        store = RemoteStore(f"http://127.0.0.1:{server.getsockname()[1]}/update")
        with pytest.raises(StoreError, match="closed the connection before it had the whole request") as caught:
            store.update("#" + "-" * (8 << 20))
        closing.join()
    assert "login" in str(caught.value.hint)


@pytest.mark.parametrize(
    ("path", "message"),
    [
        ("/moved", "answered 301"),
        ("/secret", "answered 401 Unauthorized: who are you"),
        ("/html", "`text/html`, which is not a result"),
        ("/broken", "cannot be read"),
        ("/cut", "closed the connection before its response was complete"),
    ],
)
def test_answers_that_are_no_results_are_errors(told: str, path: str, message: str) -> None:
    """A redirection, a refusal, an HTML page, and half a response are errors with a code and the way out."""
    with pytest.raises(StoreError, match=message):
        RemoteStore(f"http://{told}{path}").read().count()


def test_a_reported_problem_is_told_with_its_hint(told: str) -> None:
    """The hint in a problem document replaces the one about logins, which would not help."""
    with pytest.raises(StoreError, match="answered 403 Forbidden: the graph is kept") as caught:
        RemoteStore(f"http://{told}/kept").read().count()
    assert caught.value.hint == "Leave it out."


def test_an_update_at_an_address_for_queries_names_the_option(told: str) -> None:
    """The hint says how to give an address for updates."""
    with pytest.raises(StoreError, match="answered 400 Bad Request: the query must be set") as caught:
        RemoteStore(f"http://{told}/queries").update("CLEAR ALL")
    assert "--update-url" in str(caught.value.hint)


def test_user_and_password_are_sent(told: str) -> None:
    """Basic authentication works with characters that an address must escape."""
    with pytest.raises(StoreError):
        RemoteStore(f"http://me:a%40b@{told}/secret").read().count()
    assert _Told.seen == [("/secret", "Basic bWU6YUBi"), ("/secret", None)]  # the second one looks for a challenge


def test_a_download_that_is_cut_off_is_an_error(told: str) -> None:
    """A file that is shorter than its announced length is not taken for complete."""
    with pytest.raises(StoreError, match="closed the connection before its response was complete"):
        Endpoint(f"http://{told}/cut").get(BytesIO(), 10_000)


def test_a_query_is_sent_again_when_the_connection_breaks_and_an_update_is_not(told: str) -> None:
    """An update may have run although its response was lost."""
    store = RemoteStore(f"http://{told}/flaky")
    assert store.read().query("ASK {}", union=False)
    _Told.seen.clear()
    with pytest.raises(StoreError, match="closed the connection before its response was complete"):
        store.update("CLEAR ALL")
    assert len(_Told.seen) == 1


def test_an_address_that_takes_queries_only_is_told(address: str) -> None:
    """The error about an address that refuses updates names the option for the other address."""
    with pytest.raises(StoreError, match="KG225") as caught:
        RemoteStore(f"{address}/query").update("DROP ALL")
    assert "--update-url" in (caught.value.hint or "")
