"""Tests of graphs as resources, and of updates, apart from those of W3C."""

from __future__ import annotations

from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, cast

import pyoxigraph
import pytest
from serving import TOKEN, application

from kg.store.layout import create

if TYPE_CHECKING:
    from collections.abc import Iterator

    from starlette.applications import Starlette
    from starlette.testclient import TestClient

TURTLE = {"content-type": "text/turtle"}
ONE = "<https://example.org/s> <https://example.org/p> 1 ."
G = {"graph": "https://example.org/g"}


@pytest.fixture(scope="module")
def writing(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    """A server with a writable store of its own, and a client with its token."""
    layout = create(tmp_path_factory.mktemp("graphs") / ".kg")
    layout.generation(1).mkdir()
    pyoxigraph.Store(str(layout.generation(1))).flush()
    layout.switch(1)
    with application(layout.root, write=True, token=TOKEN, no_union=True, log="off") as found:
        found.headers["authorization"] = f"Bearer {TOKEN}"
        yield found


def test_formats(writing: TestClient) -> None:
    """A graph written in one format and read in each has the same triples."""
    assert writing.put("/store", params=G, content=ONE, headers=TURTLE).status_code in {201, 204}
    for name in ("turtle", "ntriples", "rdfxml", "jsonld", "trig", "nquads"):
        answer = writing.get("/store", params={**G, "format": name})
        parsed = pyoxigraph.RdfFormat.from_media_type(answer.headers["content-type"])
        (quad,) = pyoxigraph.parse(answer.content, parsed)
        assert quad.object == pyoxigraph.Literal(1)
    tag = writing.get("/store", params=G).headers["etag"]
    for known in (tag, "*"):
        assert writing.get("/store", params=G, headers={"if-none-match": known}).status_code == 304


def test_relative_names(writing: TestClient) -> None:
    """Relative IRIs of content are relative to its graph, and a graph below /store is named by its address."""
    path = "/store/a%2Fb/c"
    assert writing.put(path, content="<> <p> <#x> .", headers=TURTLE).status_code == 201
    (quad,) = pyoxigraph.parse(writing.get(path).content, pyoxigraph.RdfFormat.TURTLE)
    assert quad.subject == pyoxigraph.NamedNode(f"{writing.base_url}{path}")
    assert writing.get("/store", params={"graph": f"{writing.base_url}{path}"}).status_code == 200
    assert writing.get("/store/a/b/c").status_code == 404
    assert writing.delete(path).status_code == 204
    assert writing.get(path).status_code == 404


def test_empty_graph(writing: TestClient) -> None:
    """An empty graph exists, and an unknown one does not."""
    empty = {"graph": "https://example.org/empty"}
    assert writing.put("/store", params=empty, content="", headers=TURTLE).status_code == 201
    assert writing.get("/store", params=empty).status_code == 200
    assert writing.head("/store", params=empty).status_code == 200
    missing = writing.get("/store", params={"graph": "https://example.org/missing"})
    assert (missing.status_code, missing.json()["code"]) == (404, "KG521")


@pytest.mark.parametrize(
    ("method", "path", "arguments", "status"),
    [
        ("GET", "/store", {}, 400),
        ("GET", "/store?graph=not+an+iri", {}, 400),
        ("GET", "/store?graph=https://example.org/g&default", {}, 400),
        ("GET", "/store/a?default", {}, 400),
        ("GET", "/store?default", {"headers": {"accept": "text/csv"}}, 406),
        ("PUT", "/store", {"content": ONE, "headers": TURTLE}, 400),
        ("PUT", "/store?default", {"content": ONE}, 415),
        ("PUT", "/store?default", {"content": ONE, "headers": {"content-type": "text/html"}}, 415),
        ("PUT", "/store?default", {"content": ONE, "headers": {"content-type": "text/turtle; charset=latin-1"}}, 415),
        ("PUT", "/store?default", {"content": "<a", "headers": TURTLE}, 400),
        ("POST", "/store?default", {"data": {"a": "b"}, "files": {}}, 415),
        ("POST", "/store?default", {"files": {"a": ("a.html", ONE, "text/html")}}, 415),
        ("PATCH", "/store?default", {"content": ONE}, 405),
        ("DELETE", "/store?graph=https://example.org/missing", {}, 404),
        ("POST", "/update", {"data": {"update": "INSERT"}}, 400),
        ("POST", "/update", {"data": {"query": "ASK {}"}}, 400),
        ("POST", "/update", {"data": {"update": "LOAD <http://127.0.0.1:1/x>"}}, 403),
        ("POST", "/update?update=CLEAR+ALL", {"data": {"update": "CLEAR ALL"}}, 400),
        ("GET", "/update?update=CLEAR+ALL", {}, 405),
    ],
)
def test_refusals(writing: TestClient, method: str, path: str, arguments: dict[str, Any], status: int) -> None:
    """Impossible changes are rejected with the status of their kind, in the common form of errors."""
    answer = writing.request(method, path, **arguments)
    assert answer.status_code == status, answer.text
    assert answer.json()["status"] == status


def test_forms_with_files(writing: TestClient) -> None:
    """The files of a form go into one graph, by their media types or suffixes."""
    files = [
        ("a", ("a.ttl", ONE, "text/turtle")),
        ("b", ("b.nt", "<urn:s> <urn:p> <urn:o> .\n", "application/n-triples")),
    ]
    answer = writing.post("/store", files=files)
    assert answer.status_code == 201
    found = writing.get("/store", params={"graph": answer.headers["location"]}, headers={"accept": "text/turtle"})
    assert len(list(pyoxigraph.parse(found.content, pyoxigraph.RdfFormat.TURTLE))) == 2


def test_updates(writing: TestClient) -> None:
    """An update reports its changes, and the next query sees them."""
    answer = writing.post("/update", data={"update": "INSERT DATA { <urn:a> <urn:b> <urn:c>, <urn:d> }"})
    assert answer.status_code == 200
    assert answer.headers["x-kg-added"] == "2"
    assert answer.json()["snapshot"] == answer.headers["x-kg-snapshot"]
    asked = writing.get("/sparql", params={"query": "ASK { <urn:a> <urn:b> <urn:c> }"})
    assert asked.json()["boolean"] is True
    assert asked.headers["x-kg-snapshot"] == answer.headers["x-kg-snapshot"]


def test_updates_of_other_data(writing: TestClient) -> None:
    """An update that names its snapshot does not change any other."""
    before = writing.get("/sparql", params={"query": "ASK {}"}).headers["x-kg-snapshot"]
    changed = writing.put("/store", params={"graph": "https://example.org/other"}, content=ONE, headers=TURTLE)
    assert changed.status_code == 201
    answer = writing.post("/update", params={"snapshot": before}, data={"update": "CLEAR DEFAULT"})
    assert (answer.status_code, answer.json()["code"]) == (409, "KG512")


def test_content_has_a_mark_or_is_cut_off(writing: TestClient) -> None:
    """A byte order mark is skipped; RDF/XML that is cut off is an error with its line, and nothing of it is stored."""
    graph = {"graph": "https://example.org/marked"}
    assert (
        writing.put("/store", params=graph, content=b"\xef\xbb\xbf" + ONE.encode(), headers=TURTLE).status_code == 201
    )
    xml = '<rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#">\n<rdf:Description rdf:about="urn:a">'
    answer = writing.put("/store", params=graph, content=xml, headers={**TURTLE, "content-type": "application/rdf+xml"})
    assert (answer.status_code, answer.json()["code"], answer.json()["line"]) == (400, "KG562", 2)


def test_changes_of_what_was_read_only(writing: TestClient) -> None:
    """With If-Match a graph changes only if the data still has the tag: 412 otherwise (RFC 9110, 13.1.1)."""
    graph = {"graph": "https://example.org/guarded"}
    current = writing.put("/store", params=graph, content=ONE, headers=TURTLE).headers["x-kg-snapshot"]
    tag = writing.get("/store", params=graph).headers["etag"]
    for method, content in (("PUT", ONE.replace("1", "2")), ("POST", ONE), ("DELETE", None)):
        other = f'"{int(current) + 1}", W/{tag}'
        refused = writing.request(
            method, "/store", params=graph, content=content, headers={**TURTLE, "if-match": other}
        )
        assert (refused.status_code, refused.json()["code"]) == (412, "KG536")
        assert writing.get("/store", params=graph).headers["etag"] == tag
        given = {**TURTLE, "if-match": f'"0", {tag}'}
        done = writing.request(method, "/store", params=graph, content=content, headers=given)
        assert done.status_code == 204
        assert writing.request(method, "/store", params=graph, content=content, headers=given).status_code == 412
        tag = writing.get("/store", params=graph).headers.get("etag", "")
        current = done.headers["x-kg-snapshot"]


def test_changes_of_what_is_there_only(writing: TestClient) -> None:
    """If-Match: * allows changes of an existing graph, and creates none."""
    graph, anything = {"graph": "https://example.org/there"}, {**TURTLE, "if-match": "*"}
    assert writing.put("/store", params=graph, content=ONE, headers=anything).status_code == 412
    assert writing.put("/store", params=graph, content=ONE, headers=TURTLE).status_code == 201
    assert writing.post("/store", params=graph, content=ONE, headers=anything).status_code == 204
    assert writing.delete("/store", params=graph, headers=anything).status_code == 204
    assert writing.delete("/store", params=graph, headers=anything).status_code == 412
    assert writing.put("/store?default", content=ONE, headers=anything).status_code == 204
    assert writing.post("/store", content=ONE, headers=anything).status_code == 201


def test_what_is_made_replaces_nothing(writing: TestClient) -> None:
    """If-None-Match: * creates a graph and changes none; with tags only data with other tags is changed (13.1.2)."""
    graph, nothing = {"graph": "https://example.org/made"}, {**TURTLE, "if-none-match": "*"}
    made = writing.put("/store", params=graph, content=ONE, headers=nothing)
    assert made.status_code == 201
    for method in ("PUT", "POST", "DELETE"):
        refused = writing.request(method, "/store", params=graph, content=ONE.replace("1", "2"), headers=nothing)
        assert (refused.status_code, refused.json()["code"]) == (412, "KG536")
        assert refused.json()["hint"] == "Leave it out to change what exists."
    assert writing.put("/store?default", content=ONE, headers=nothing).status_code == 412
    tag = writing.get("/store", params=graph).headers["etag"]
    for other, status in ((tag, 412), (f"W/{tag}", 412), ('"0"', 204), ("malformed", 400)):
        given = {**TURTLE, "if-none-match": other}
        assert writing.put("/store", params=graph, content=ONE.replace("1", "2"), headers=given).status_code == status


def test_updates_of_what_was_read_only(writing: TestClient) -> None:
    """An update accepts the tag of any response from the current data; an invalid tag is rejected."""
    update = {"update": "INSERT DATA { <urn:matched> <urn:p> 1 }"}
    tag = writing.get("/sparql", params={"query": "ASK {}"}).headers["etag"]
    assert writing.post("/update", data=update, headers={"if-match": tag}).status_code == 200
    refused = writing.post("/update", data={"update": "CLEAR DEFAULT"}, headers={"if-match": tag})
    assert (refused.status_code, refused.json()["code"]) == (412, "KG536")
    assert writing.post("/update", data=update, headers={"if-match": "*"}).status_code == 200
    for other in ('"a,b"', '"0",', f', "0" , W/{tag}'):
        assert writing.post("/update", data=update, headers={"if-match": other}).status_code == 412
    for malformed in ("1", '"1', '"1" "2"', ",", "*, *", "W/1"):
        assert writing.post("/update", data=update, headers={"if-match": malformed}).status_code == 400
    current = writing.get("/sparql", params={"query": "ASK {}"}).headers["x-kg-snapshot"]
    both = writing.post("/update?snapshot=0", data=update, headers={"if-match": f'"{current}"'})
    assert (both.status_code, both.json()["code"]) == (409, "KG512")


def test_data_that_changes_behind_the_check(writing: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    """A concurrent change between the check of If-Match and the change is 412, too."""
    state = cast("Starlette", writing.app).state.server
    current = writing.get("/sparql", params={"query": "ASK {}"}).headers["x-kg-snapshot"]
    monkeypatch.setattr(state.readers, "layout", SimpleNamespace(current=lambda: int(current) - 1))
    refused = writing.post("/update", data={"update": "CLEAR ALL"}, headers={"if-match": f'"{int(current) - 1}"'})
    assert (refused.status_code, refused.json()["code"]) == (412, "KG536")
