"""Tests of the query protocol apart from those of W3C: methods, parameters, limits; C9, C16, C35."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from patience import patient
from serving import TOKEN, application

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from starlette.testclient import TestClient

QUERY = {"content-type": "application/sparql-query"}
SECONDS = patient(5)
COUNT = "SELECT (COUNT(*) AS ?n) WHERE { ?s ?p ?o }"


@pytest.fixture(scope="module")
def limited(store: Path) -> Iterator[TestClient]:
    """A server with a token, which limits other clients to SECONDS and 10 rows."""
    with application(store, token=TOKEN, seconds=SECONDS, rows=10, log="off") as found:
        yield found


@pytest.fixture(scope="module")
def writing(store: Path) -> Iterator[TestClient]:
    """A writable server and a client with its token; no test here makes changes."""
    with application(store, write=True, token=TOKEN, log="off") as found:
        found.headers["authorization"] = f"Bearer {TOKEN}"
        yield found


def asked(client: TestClient, query: str, **parameters: str) -> Any:
    """Return the response to a query by GET."""
    return client.get("/sparql", params={"query": query, **parameters})


@pytest.mark.parametrize("path", ["/sparql", "/sparql/"])
def test_each_way_answers_the_same(client: TestClient, path: str) -> None:
    """GET, POST of a form, POST of the query and QUERY give the same response."""
    answers = [
        client.get(path, params={"query": COUNT}),
        client.post(path, data={"query": COUNT}),
        client.post(path, content=COUNT, headers=QUERY),
        client.request("QUERY", path, content=COUNT, headers=QUERY),
    ]
    assert {answer.status_code for answer in answers} == {200}
    assert len({answer.text for answer in answers}) == 1


def test_head(client: TestClient) -> None:
    """HEAD has the headers of GET and no body."""
    got, head = client.get("/sparql", params={"query": COUNT}), client.head("/sparql", params={"query": COUNT})
    assert head.content == b""
    names = {"content-type", "content-length", "etag", "x-kg-rows", "x-kg-snapshot"}
    assert {name: head.headers[name] for name in names} == {name: got.headers[name] for name in names}


@pytest.mark.parametrize(
    ("path", "allowed"),
    [
        ("/sparql", "GET, HEAD, OPTIONS, POST, QUERY"),
        ("/update", "OPTIONS, POST"),
        ("/store", "DELETE, GET, HEAD, OPTIONS, POST, PUT"),
        ("/store/a", "DELETE, GET, HEAD, OPTIONS, POST, PUT"),
        ("/jobs", "GET, HEAD, OPTIONS"),
        ("/jobs/x", "DELETE, GET, HEAD, OPTIONS"),
        ("/health", "GET, HEAD, OPTIONS"),
    ],
)
def test_methods(writing: TestClient, path: str, allowed: str) -> None:
    """OPTIONS lists the methods of each address; an unsupported method gets 405 with the same list (C35)."""
    options = writing.options(path)
    assert (options.status_code, options.headers["allow"]) == (204, allowed)
    other = writing.request("BREW", path)
    assert (other.status_code, other.headers["allow"]) == (405, allowed)
    assert other.json()["code"] == "KG522"


@pytest.mark.parametrize(
    ("method", "arguments", "status", "code"),
    [
        ("GET", {"params": {"query": "SELECT"}}, 400, "KG501"),
        ("GET", {"params": {"update": "CLEAR ALL"}}, 403, "KG530"),
        ("GET", {"params": [("query", COUNT), ("query", COUNT)]}, 400, "KG520"),
        ("GET", {"params": {"query": COUNT, "limit": "many"}}, 400, "KG520"),
        ("GET", {"params": {"query": COUNT, "format": "pdf"}}, 406, "KG523"),
        ("GET", {"params": {"query": COUNT, "format": "turtle"}}, 406, "KG504"),
        ("GET", {"params": {"query": COUNT}, "headers": {"accept": "image/png"}}, 406, "KG523"),
        ("GET", {"params": {"query": COUNT}, "headers": {"accept": "text/turtle"}}, 406, "KG504"),
        ("GET", {"params": {"query": COUNT, "job": "short"}}, 400, "KG520"),
        ("GET", {"params": {"query": COUNT, "timeout": "0"}}, 400, "KG520"),
        ("GET", {"params": {"query": COUNT, "timeout": "9999"}}, 403, "KG534"),
        ("GET", {"params": {"query": COUNT, "limit": "99999999"}}, 403, "KG534"),
        ("GET", {"params": {"query": "SELECT * { SERVICE <http://127.0.0.1:1/> { ?s ?p ?o } }"}}, 403, "KG502"),
        ("POST", {}, 415, "KG524"),
        ("POST", {"content": COUNT}, 415, "KG524"),
        ("POST", {"content": COUNT, "headers": {"content-type": "text/plain"}}, 415, "KG524"),
        ("POST", {"content": b"\xff", "headers": QUERY}, 400, "KG520"),
        ("POST", {"data": {"other": "x"}}, 400, "KG520"),
        ("POST", {"content": COUNT, "headers": QUERY, "params": {"query": COUNT}}, 400, "KG520"),
    ],
)
def test_refusals(client: TestClient, method: str, arguments: dict[str, Any], status: int, code: str) -> None:
    """An invalid request is rejected with the status of its kind."""
    answer = client.request(method, "/sparql", **arguments)
    assert (answer.status_code, answer.json()["code"]) == (status, code)


def test_place_of_error(client: TestClient) -> None:
    """The place of a query error is in code points of the text sent."""
    answer = asked(client, 'SELECT * WHERE {\n  ?s ?p "🤖🤖" ; }}')
    assert (answer.status_code, answer.json()["line"], answer.json()["column"]) == (400, 2, 17)


def test_timeout_may_be_lowered_only(limited: TestClient) -> None:
    """A client may lower the time limit of the server, and raise it only with the token (C9)."""
    less, more = str(SECONDS - 0.5), str(SECONDS + 1)
    assert asked(limited, COUNT, timeout=less).status_code == 200
    assert asked(limited, COUNT, timeout=more).status_code == 403
    bearer = {"authorization": f"Bearer {TOKEN}"}
    assert limited.get("/sparql", params={"query": COUNT, "timeout": more}, headers=bearer).status_code == 200


def test_remembered_requests_are_told_apart(limited: TestClient) -> None:
    """The cache of posted queries distinguishes requests by parameters, headers, token and body."""
    bearer = {"authorization": f"Bearer {TOKEN}"}
    more = {"timeout": str(SECONDS + 1)}
    sparql = {"content-type": "application/sparql-query"}
    for _ in range(2):
        for headers, status in ((bearer, 200), ({}, 403)):
            posted = limited.post("/sparql", params=more, content=COUNT, headers={**sparql, **headers})
            assert posted.status_code == status
        for name in ("application/sparql-results+json", "text/csv"):
            answer = limited.post("/sparql", content=COUNT, headers={**sparql, "accept": name})
            assert answer.headers["content-type"].startswith(name)
        form = limited.post("/sparql", content=COUNT, headers={"content-type": "application/x-www-form-urlencoded"})
        assert form.status_code == 400
        for text in ("ASK {}", "ASK { FILTER(false) }", "ASK {} #" + "x" * 5000):
            answer = limited.post("/sparql", content=text, headers=sparql)
            assert answer.json()["boolean"] == ("false" not in text)


def test_lowered_timeout_ends_the_query(client: TestClient) -> None:
    """A query that exceeds the time limit of the client ends with an error."""
    answer = asked(client, "SELECT (COUNT(*) AS ?n) { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i }", timeout="0.5")
    assert (answer.status_code, answer.json()["code"]) == (503, "KG503")


def test_rows_may_be_lowered_only(limited: TestClient) -> None:
    """A client may lower the row limit, and raise it only with the token."""
    every = "SELECT * WHERE { ?s ?p ?o }"
    assert len(asked(limited, every, limit="3").json()["results"]["bindings"]) == 3
    assert asked(limited, every, limit="11").status_code == 403
    bearer = {"authorization": f"Bearer {TOKEN}"}
    answer = limited.get("/sparql", params={"query": every, "limit": "11"}, headers=bearer)
    assert len(answer.json()["results"]["bindings"]) == 11


def test_variables(client: TestClient) -> None:
    """A parameter `$name` binds a variable to a term."""
    term = "<http://www.w3.org/1999/02/22-rdf-syntax-ns#type>"
    answer = asked(client, "SELECT ?p (COUNT(*) AS ?n) WHERE { ?s ?p ?o } GROUP BY ?p", **{"$p": term})
    (row,) = answer.json()["results"]["bindings"]
    assert int(row["n"]["value"]) > 1
    wrong = asked(client, COUNT, **{"$nothing": term})
    assert (wrong.status_code, wrong.json()["code"]) == (400, "KG505")


def test_a_link_that_is_followed_shows_the_page(client: TestClient) -> None:
    """A browser that follows a link to the endpoint gets the query page, unless the link names a format."""
    browser = {"accept": "text/html,*/*;q=0.8"}
    answer = client.get("/sparql", params={"query": COUNT}, headers=browser)
    assert answer.status_code == 303
    assert answer.headers["location"].startswith("/query?query=SELECT")
    named = client.get("/sparql", params={"query": COUNT, "format": "csv"}, headers=browser)
    assert named.headers["content-type"] == "text/csv; charset=utf-8"


@pytest.mark.parametrize(
    ("method", "path", "arguments"),
    [
        ("POST", "/update", {"data": {"update": "CLEAR ALL"}}),
        ("POST", "/update", {"content": "CLEAR ALL", "headers": {"content-type": "application/sparql-update"}}),
        ("POST", "/update/", {"content": "LOAD <http://127.0.0.1/>", "headers": {"content-type": "text/plain"}}),
        ("GET", "/update", {"params": {"update": "CLEAR ALL"}}),
        ("GET", "/sparql", {"params": {"update": "CLEAR ALL"}}),
        ("POST", "/sparql", {"content": "CLEAR ALL", "headers": {"content-type": "application/sparql-update"}}),
        ("POST", "/sparql", {"data": {"update": "CLEAR ALL"}}),
        ("PUT", "/store?default", {"content": "", "headers": {"content-type": "text/turtle"}}),
        ("POST", "/store", {"content": "", "headers": {"content-type": "text/turtle"}}),
        ("DELETE", "/store?default", {}),
        ("PATCH", "/store?default", {}),
        ("DELETE", "/store/a", {}),
    ],
)
def test_nothing_is_changed(client: TestClient, method: str, path: str, arguments: dict[str, Any]) -> None:
    """A read-only server rejects every form of change (C16)."""
    before = asked(client, COUNT).headers["etag"]
    answer = client.request(method, path, **arguments)
    assert 400 <= answer.status_code < 500
    assert answer.json()["code"] in {"KG530", "KG520", "KG524"}
    assert asked(client, COUNT).headers["etag"] == before
