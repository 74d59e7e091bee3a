"""Tests of responses: a body with status 200 is complete, and headers describe it; C7, C10, C31."""

from __future__ import annotations

import csv
import io
import json
import os
import re
import signal
import threading
import time
from contextlib import closing, suppress
from http.client import HTTPConnection, IncompleteRead
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final
from urllib.parse import urlencode

import pyoxigraph
import pytest
from lxml import etree
from patience import patient
from serving import application, served
from workspaces import copied

from kg.server import protocol_answer
from kg.store.embedded import EmbeddedStore
from kg.store.layout import Layout

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from serving import Serving
    from starlette.testclient import TestClient

ENDLESS_ROWS: Final = "SELECT * WHERE { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i }"
ENDLESS_GRAPH: Final = "CONSTRUCT { [] ?b ?c } WHERE { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i }"
COUNT: Final = "SELECT (COUNT(*) AS ?n) WHERE { ?s ?p ?o }"


MOMENT: Final = 0.2
"""Seconds of processor time exceeded only by endless queries."""


def rdf(name: str) -> Callable[[bytes], object]:
    """Return a reader that parses a format of RDF to its end."""
    found = pyoxigraph.RdfFormat.from_extension(name)
    assert found is not None
    return lambda body: list(pyoxigraph.parse(body, found))


def table(body: bytes) -> None:
    """Read CSV whose rows are all as long as the first, and whose last line is terminated."""
    assert body.endswith(b"\r\n")
    rows = list(csv.reader(io.StringIO(body.decode(), newline="")))
    assert {len(row) for row in rows} == {len(rows[0])}


def lines(body: bytes) -> None:
    """Read lines that are all terminated."""
    assert body.endswith(b"\n")


def json_lines(body: bytes) -> None:
    """Read an object from each line."""
    lines(body)
    assert all(isinstance(json.loads(line), dict) for line in body.splitlines())


READERS: Final[Mapping[str, tuple[str, Callable[[bytes], object]]]] = {
    "json": (ENDLESS_ROWS, json.loads),
    "xml": (ENDLESS_ROWS, etree.fromstring),
    "csv": (ENDLESS_ROWS, table),
    "tsv": (ENDLESS_ROWS, lines),
    "jsonl": (ENDLESS_ROWS, json_lines),
    "markdown": (ENDLESS_ROWS, lines),
    "turtle": (ENDLESS_GRAPH, rdf("ttl")),
    "ntriples": (ENDLESS_GRAPH, rdf("nt")),
    "rdfxml": (ENDLESS_GRAPH, rdf("rdf")),
    "jsonld": (ENDLESS_GRAPH, rdf("jsonld")),
    "trig": (ENDLESS_GRAPH, rdf("trig")),
    "nquads": (ENDLESS_GRAPH, rdf("nq")),
}
"""Format to an endless query and a reader of the format."""


@pytest.fixture(scope="module")
def unbounded(store: Path) -> Iterator[Serving]:
    """A server whose row limit exceeds the rows a query finds in its time."""
    with served(store, forks_readers=False, rows=1 << 40, seconds=patient(20), cache=0, log="off") as found:
        yield found


def get(server: Serving, **parameters: str) -> tuple[int, Mapping[str, str], bytes]:
    """Return status, headers and body; IncompleteRead if the server closes the connection early."""
    connection = HTTPConnection("127.0.0.1", server.port, timeout=patient(60))
    try:
        connection.request("GET", "/sparql?" + urlencode(parameters))
        answer = connection.getresponse()
        return answer.status, {name.lower(): value for name, value in answer.getheaders()}, answer.read()
    finally:
        connection.close()


@pytest.mark.parametrize("name", READERS)
def test_deadline_is_never_a_broken_answer(unbounded: Serving, name: str) -> None:
    """A response cut off by its deadline is an error, in every format."""
    status, headers, body = get(unbounded, query=READERS[name][0], format=name, timeout="0.4")
    assert status == 503, body
    assert headers["content-type"] == "application/problem+json"
    assert json.loads(body)["code"] == "KG503"


@pytest.mark.parametrize("name", READERS)
def test_stream_is_seen_to_be_cut(unbounded: Serving, name: str) -> None:
    """A client detects that a streamed response was cut off by its deadline."""
    for given in ({"timeout": "0.6"}, {"timeout": "3"}, {"timeout": "12"}, {}):
        try:
            status, _, _ = get(unbounded, query=READERS[name][0], format=name, stream="true", **given)
        except IncompleteRead:
            return
        # On a busy machine the deadline may come before the first part, which is then an error.
        assert status == 503
    pytest.fail("nothing was streamed")


@pytest.mark.parametrize("name", READERS)
def test_rows_cut_an_answer_that_is_whole(unbounded: Serving, name: str) -> None:
    """A response at the row limit can be parsed to its end, and is marked as truncated."""
    query, read = READERS[name]
    for rows in (0, 1, 300):
        status, headers, body = get(unbounded, query=query, format=name, limit=str(rows))
        assert (status, headers["x-kg-rows"], headers["x-kg-truncated"]) == (200, str(rows), "true")
        if rows or name not in {"tsv", "csv", "jsonl"}:
            read(body)


@pytest.mark.parametrize("stream", [False, True])
def test_crash_is_never_a_broken_answer(unbounded: Serving, *, stream: bool) -> None:
    """If its reader dies, a response is an error, or the client detects that it is incomplete."""
    said: list[Any] = []
    streams = threading.Event()

    def ask() -> None:
        form = {"query": ENDLESS_ROWS, "format": "json", **({"stream": "true"} if stream else {})}
        with closing(HTTPConnection("127.0.0.1", unbounded.port, timeout=patient(60))) as connection:
            connection.request("GET", "/sparql?" + urlencode(form))
            answer = connection.getresponse()
            streams.set()
            try:
                said.append((answer.status, answer.read()))
            except IncompleteRead as error:
                said.append(error)

    before = worked(unbounded)
    asking = threading.Thread(target=ask)
    asking.start()
    # The reader has used processor time since, and a stream has begun.
    while not (readers := busy(unbounded, before)) or (stream and not streams.is_set()):
        assert asking.is_alive(), said
        time.sleep(0.05)
    for process in readers:
        os.kill(process, signal.SIGKILL)
    asking.join(patient(30))
    (found,) = said
    if stream:
        assert isinstance(found, IncompleteRead)
    else:
        assert (found[0], json.loads(found[1])["code"]) == (503, "KG508")
    assert get(unbounded, query=COUNT)[0] == 200


def readers_of(server: Serving) -> list[int]:
    """Return the reader processes: the grandchildren of a server process."""
    parents = {}
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            parents[int(path.parent.name)] = int(path.read_text().rpartition(")")[2].split()[1])
        except OSError:
            continue
    # Their fork server uses processor time, too: it loads modules, at its start and when idle.
    return [process for process, parent in parents.items() if parents.get(parent) == server.process.pid]


def worked(server: Serving) -> dict[int, float]:
    """Return the processor seconds of each reader of a server."""
    found = {}
    for process in readers_of(server):
        with suppress(OSError):
            fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
            found[process] = (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    return found


def busy(server: Serving, before: Mapping[int, float]) -> list[int]:
    """Return the readers of a server that have since used more than a moment of processor time."""
    return [process for process, seconds in worked(server).items() if seconds - before.get(process, 0) > MOMENT]


def test_broken_queries_are_no_answers(unbounded: Serving) -> None:
    """A failure before the first row is an error, streamed or not."""
    for stream in ({}, {"stream": "true"}):
        status, _, body = get(unbounded, query="SELECT", **stream)
        assert (status, json.loads(body)["code"]) == (400, "KG501")


def test_large_answer(unbounded: Serving) -> None:
    """A response larger than the memory buffer is complete, with its length."""
    status, headers, body = get(unbounded, query=ENDLESS_ROWS, format="json", limit="25000")
    assert status == 200
    assert len(body) == int(headers["content-length"]) > 8 << 20
    assert len(json.loads(body)["results"]["bindings"]) == 25000


def test_stream_has_no_cap(store: Path) -> None:
    """A streamed response is not limited to the rows of the server."""
    with application(store, rows=5, log="off") as small:
        every = {"query": "SELECT ?s WHERE { ?s ?p ?o } LIMIT 50"}
        assert len(small.get("/sparql", params=every).json()["results"]["bindings"]) == 5
        streamed = small.get("/sparql", params={**every, "stream": "true"})
        assert len(streamed.json()["results"]["bindings"]) == 50
        assert "x-kg-truncated" not in streamed.headers


def test_disk_that_is_full(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    """A response that cannot be buffered on disk is an error of the disk, not a defect."""

    def full() -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(protocol_answer, "_IN_MEMORY", 100)
    monkeypatch.setattr("tempfile.TemporaryFile", full)
    answer = client.get("/sparql", params={"query": "SELECT * WHERE { ?s ?p ?o } LIMIT 900"})
    assert (answer.status_code, answer.json()["code"]) == (507, "KG304")


def test_size_is_capped(store: Path) -> None:
    """A response with more bytes than the limit of the server is an error that names it (C10)."""
    with application(store, answer_bytes=2000, log="off") as small:
        answer = small.get("/sparql", params={"query": "SELECT * WHERE { ?s ?p ?o } LIMIT 500"})
        assert answer.status_code >= 400
        assert answer.json()["code"] == "KG511"
        assert small.get("/sparql", params={"query": COUNT}).status_code == 200


def test_pages_of_rows(store: Path) -> None:
    """The links of truncated responses give each row once; a response of exactly the limit is not truncated (C10)."""
    query = "SELECT DISTINCT ?c WHERE { ?s a ?c } ORDER BY ?c"
    with application(store, rows=7, log="off") as small:
        whole = small.get("/sparql", params={"query": query, "stream": "true"}).json()["results"]["bindings"]
        rows = []
        answer = small.get("/sparql", params={"query": query})
        while True:
            rows += answer.json()["results"]["bindings"]
            if "link" not in answer.headers:
                break
            assert answer.headers["x-kg-truncated"] == "true"
            following = re.fullmatch(r'<(.*)>; rel="next"', answer.headers["link"])
            assert following
            answer = small.get(following[1])
        assert rows == whole
        assert len(rows) > 14
        exact = small.get("/sparql", params={"query": query + " LIMIT 7"})
        assert exact.headers["x-kg-rows"] == "7"
        assert "x-kg-truncated" not in exact.headers


def test_the_next_page_of_a_post(store: Path) -> None:
    """The link after a POST is a GET of the rest of the same query; one too long for an address is left out."""
    query = "SELECT DISTINCT ?c WHERE { ?s a ?c } ORDER BY ?c"
    with application(store, rows=7, log="off") as small:
        direct = {"content-type": "application/sparql-query"}
        for first in (
            small.post("/sparql", data={"query": query}),
            small.post("/sparql", content=query, headers=direct),
            small.request("QUERY", "/sparql", content=query, headers=direct),
        ):
            following = re.fullmatch(r'<(.*)>; rel="next"', first.headers["link"])
            assert following
            second = small.get(following[1])
            assert second.status_code == 200
            rows = [row["c"]["value"] for answer in (first, second) for row in answer.json()["results"]["bindings"]]
            assert rows == sorted(set(rows))
            assert len(rows) == 14
        long = small.post("/sparql", data={"query": query + " #" + "x" * 9000})
        assert (long.headers["x-kg-truncated"], "link" in long.headers) == ("true", False)


def test_any_tag(client: TestClient) -> None:
    """`If-None-Match: *` is 304 for every query with a result, and an error takes precedence (RFC 9110, 13.2.1)."""
    anything = {"if-none-match": "*"}
    first = client.get("/sparql", params={"query": COUNT})
    for given in ({"query": COUNT}, {"query": COUNT, "stream": "true"}):
        again = client.get("/sparql", params=given, headers=anything)
        assert (again.status_code, again.content) == (304, b"")
    assert client.get("/sparql", params={"query": COUNT}, headers=anything).headers["etag"] == first.headers["etag"]
    assert client.get("/sparql", params={"query": "SELECT"}, headers=anything).status_code == 400
    assert client.post("/sparql", data={"query": COUNT}, headers=anything).status_code == 412


def test_what_the_accepted_formats_cannot_represent(client: TestClient) -> None:
    """A result that no accepted format represents is 406 with the formats that do."""
    answer = client.get("/sparql", params={"query": COUNT}, headers={"accept": "text/turtle, application/ld+json"})
    assert (answer.status_code, answer.json()["code"]) == (406, "KG504")
    assert answer.json()["message"] == "`turtle` cannot represent rows"
    assert "csv" in answer.json()["hint"]


def test_tags(client: TestClient) -> None:
    """The tag of a response identifies data and request; with it, an unchanged response is not sent again (C31)."""
    first = client.get("/sparql", params={"query": COUNT})
    tag = first.headers["etag"]
    again = client.get("/sparql", params={"query": COUNT}, headers={"if-none-match": tag})
    assert (again.status_code, again.content, again.headers["etag"]) == (304, b"", tag)
    weak = client.get("/sparql", params={"query": COUNT}, headers={"if-none-match": f'"x", W/{tag}'})
    assert weak.status_code == 304
    posted = client.post("/sparql", data={"query": COUNT}, headers={"if-none-match": tag})
    assert (posted.status_code, posted.json()["code"]) == (412, "KG536")
    assert client.post("/sparql", data={"query": COUNT}, headers={"if-none-match": '"x"'}).status_code == 200
    for other in ({"query": COUNT + " #"}, {"query": COUNT, "format": "csv"}, {"query": COUNT, "limit": "1"}):
        answer = client.get("/sparql", params=other, headers={"if-none-match": tag})
        assert (answer.status_code, answer.headers["etag"] != tag) == (200, True)


def test_no_tag_for_what_changes(client: TestClient) -> None:
    """A response that differs each time has no tag, and must not be cached."""
    answer = client.get("/sparql", params={"query": "SELECT (NOW() AS ?now) WHERE { }"})
    assert "etag" not in answer.headers
    assert answer.headers["cache-control"] == "no-store"


def test_other_data(store: Path, tmp_path: Path) -> None:
    """When the data changes, so do the tags; a link to old data gets an error and a link to the current data (C31)."""
    copied(store, tmp_path / ".kg")
    with application(tmp_path / ".kg", log="off") as changing:
        first = changing.get("/sparql", params={"query": COUNT})
        old = first.headers["x-kg-snapshot"]
        with EmbeddedStore(Layout(tmp_path / ".kg")).write("test") as transaction:
            graph = pyoxigraph.NamedNode("https://example.org/g")
            transaction.replace_graphs(
                {graph: [b"<https://example.org/a> <https://example.org/b> <https://x.y/z> .\n"]}
            )
        tag = {"if-none-match": first.headers["etag"]}
        second = changing.get("/sparql", params={"query": COUNT}, headers=tag)
        assert second.status_code == 200
        assert second.headers["x-kg-snapshot"] != old
        assert second.headers["etag"] != first.headers["etag"]
        gone = changing.get("/sparql", params={"query": COUNT, "snapshot": "999"})
        assert (gone.status_code, gone.json()["code"]) == (409, "KG512")
        link = re.fullmatch(r'<(.*)>; rel="latest-version"', gone.headers["link"])
        assert link
        assert changing.get(link[1]).text == second.text


_SABOTAGED: Final = """
from kg.server import app
from query.readers.asking import program
class Readers(app.Readers):
    def __init__(self, layout, **options):
        super().__init__(layout, **options, program=program("sabotaged.py"))
app.Readers = Readers
"""
"""Makes the readers of a server fail as instructed by queries."""


def test_a_failing_disk_is_not_the_fault_of_the_query(store: Path) -> None:
    """An unreadable store is status 503; a query the engine cannot execute is 400."""
    tests = str(Path(__file__).parents[1])
    with served(store, before=_SABOTAGED, environment={"PYTHONPATH": tests}, log="off") as server:
        for how, row, expected in (
            ("disk", 0, (503, "KG303")),
            ("disk", 9, (503, "KG303")),
            ("engine", 0, (400, "KG506")),
        ):
            connection = HTTPConnection("127.0.0.1", server.port, timeout=patient(60))
            query = f"SELECT * WHERE {{ ?s ?p ?o }} # {how}@{row}"
            connection.request("GET", "/sparql?" + urlencode({"query": query}))
            answer = connection.getresponse()
            assert (answer.status, json.loads(answer.read())["code"]) == expected
            connection.close()
