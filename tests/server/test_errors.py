"""Tests that errors have one form on every route: C32, and C27 for their headers."""

from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING, Any, Final

import pytest
from serving import TOKEN, application
from starlette.requests import HTTPConnection
from starlette.routing import BaseRoute, Mount, Route

from kg.errors import CATALOGUE, KgError, Place, QueryError
from kg.server import errors
from kg.server.errors import STATUS, RequestError, problem
from kg.server.safety.headers import HEADERS

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from starlette.applications import Starlette
    from starlette.testclient import TestClient

MEMBERS: Final = {
    "type", "title", "status", "code", "message", "hint", "line", "column", "endLine", "endColumn", "docs",
}  # fmt: skip
QUERY = {"Content-Type": "application/sparql-query"}
CURL = {"User-Agent": "curl/8.5.0"}
BROWSER = {"Accept": "text/html,application/xhtml+xml,*/*;q=0.8"}


def assert_error(answer: Any, status: int | None = None, code: str | None = None) -> dict[str, Any]:
    """Assert that a response is an error of the common form, and return its members."""
    assert answer.headers["content-type"] == "application/problem+json", (answer.status_code, answer.text[:200])
    members: dict[str, Any] = answer.json()
    assert set(members) == MEMBERS
    assert members["code"] in CATALOGUE
    assert members["status"] == answer.status_code == STATUS.get(members["code"], 400)
    assert members["type"] == members["docs"] == f"/errors/{members['code']}"
    assert members["title"] == CATALOGUE[members["code"]].title
    assert members["message"]
    assert members["hint"]
    assert "Traceback" not in answer.text
    assert (members["line"] is None) == (members["column"] is None) == (members["endLine"] is None)
    for name, value in HEADERS.items():
        assert answer.headers[name.decode()] == value.decode()
    assert answer.headers["cache-control"] == "no-store"
    assert "Accept" in answer.headers["vary"]
    assert status in {None, answer.status_code}
    assert code in {None, members["code"]}
    return members


def routes(app: Starlette) -> Iterator[Route]:
    """Yield the routes of an application, except those of mounts."""
    remaining: list[BaseRoute] = list(app.routes)
    for route in remaining:
        if isinstance(route, Route):
            yield route
        else:
            assert isinstance(route, Mount), route


@pytest.fixture(scope="module")
def writing(store: Path) -> Iterator[TestClient]:
    """A server writable with a token."""
    with application(store, write=True, token=TOKEN, log="off") as found:
        yield found


def test_every_route_and_every_kind_of_refusal(client: TestClient) -> None:
    """Every rejection before a route, and every wrong method, has the common form."""
    app: Any = client.app
    for route in routes(app):
        path = re.sub(r"\{[^}]*\}", "x", route.path)
        assert_error(client.get(path, headers={"Host": "evil.example"}), 421, "KG527")
        assert_error(client.get(path + "?" + "x" * 9000), 414, "KG526")
        assert_error(client.get(path, headers={"Cookie": "x" * 40_000}), 431, "KG535")
        assert_error(client.post(path, headers={"Content-Encoding": "gzip"}), 415, "KG524")
        assert_error(client.post(path, headers={"Content-Length": str(1 << 40)}), 413, "KG525")
        assert_error(client.post(path, headers={"Origin": "http://evil.example"}), 403, "KG528")
        answer = client.request("FROBNICATE", path)
        if answer.status_code == 405:
            assert_error(answer, 405, "KG522")
            assert "GET" in answer.headers["allow"] or "POST" in answer.headers["allow"]
        else:
            assert_error(answer, 403, "KG530")


@pytest.mark.parametrize(
    ("method", "path", "expected", "named"),
    [
        ("GET", "/nothing", (404, "KG521"), {}),
        ("GET", "/api/nothing", (404, None), {}),
        ("GET", "/errors/KG000", (404, "KG521"), {}),
        ("GET", "/sparql?query=SELECT", (400, "KG501"), {}),
        ("GET", "/sparql?query=ASK{}&query=ASK{}", (400, "KG520"), {}),
        ("GET", "/sparql?query=ASK{}&timeout=x", (400, "KG520"), {}),
        ("GET", "/sparql?query=ASK{}&timeout=99999", (403, "KG534"), {}),
        ("GET", "/sparql?query=ASK{}&format=none", (406, None), {}),
        ("GET", "/sparql?query=ASK{}&snapshot=99", (409, "KG512"), {}),
        ("GET", "/sparql?query=ASK{}", (406, None), {"headers": {"Accept": "image/png"}}),
        ("GET", "/sparql?query=ASK{SERVICE<http://a.example/>{}}", (403, "KG502"), {}),
        ("POST", "/sparql", (415, "KG524"), {"content": "x", "headers": {"Content-Type": "text/css"}}),
        ("POST", "/sparql", (400, "KG520"), {"data": {"x": "y"}}),
        ("POST", "/sparql", (400, None), {"content": b"\xff\xfe", "headers": QUERY}),
        ("GET", "/sparql?query=" + "%7B" * 2000, (400, "KG516"), {}),
        ("POST", "/update", (403, "KG530"), {"data": {"update": "CLEAR ALL"}}),
        ("GET", "/sparql?update=CLEAR+ALL", (403, "KG530"), {}),
        ("GET", "/jobs/0123456789abcdef", (404, "KG521"), {}),
    ],
)
def test_errors_of_routes(
    client: TestClient, method: str, path: str, expected: tuple[int, str | None], named: Any
) -> None:
    """Errors raised by a route have the common form, with a suitable status."""
    assert_error(client.request(method, path, **named), *expected)


def test_what_may_pass_says_when_to_ask_again() -> None:
    """Each rejection for lack of space or time has `Retry-After`; errors for the owner to fix do not."""
    request = HTTPConnection({"type": "http", "method": "GET", "path": "/", "query_string": b"", "headers": []})
    told = {code for code in STATUS if "retry-after" in errors.answer(request, KgError(code, "x")).headers}
    assert {STATUS[code] for code in told} == {429, 503}
    assert {"KG302", "KG503", "KG509", "KG531", "KG533"} <= told
    assert not told & {"KG301", "KG303", "KG306", "KG510"}


@pytest.mark.parametrize("headers", [CURL, {"User-Agent": "Wget/1.21"}, {"Accept": "text/plain"}])
def test_people_at_a_terminal_read_text(client: TestClient, headers: dict[str, str]) -> None:
    """A client like curl gets the code, the place, the line with the error underlined, and instructions."""
    answer = client.get("/sparql?query=SELECT+%7B", headers=headers)
    assert answer.headers["content-type"] == "text/plain; charset=utf-8"
    assert re.fullmatch(r"KG501: line 1, column 8: .+\n    SELECT \{\n           \^\n.+\n", answer.text)


def test_people_in_a_browser_see_a_page(client: TestClient) -> None:
    """A browser gets a page that links to the explanation of the code; the request is shown as text."""
    answer = client.get("/<script>alert(1)</script>", headers=BROWSER)
    assert answer.status_code == 404
    assert 'action="/search"' in answer.text
    assert answer.headers["content-type"] == "text/html; charset=utf-8"
    assert "<script>alert" not in answer.text
    assert "/errors/KG521" in answer.text
    assert client.get("/errors/KG521", headers=BROWSER).status_code == 200


@pytest.mark.parametrize("accept", ["application/json", "application/sparql-results+json", "text/turtle", "*/*", ""])
def test_programs_get_json(client: TestClient, accept: str) -> None:
    """Other clients get a problem of RFC 9457, whatever format they accept."""
    assert_error(client.get("/nothing", headers={"Accept": accept}), 404)


def test_every_code_is_explained(client: TestClient) -> None:
    """`docs` of every error leads to a page of this server."""
    for code, entry in CATALOGUE.items():
        answer = client.get(f"/errors/{code}", headers=CURL)
        assert answer.status_code == 200
        assert entry.way_out in answer.text


def test_every_status_is_of_a_code() -> None:
    """The map of codes to statuses has only existing codes and error statuses."""
    assert set(STATUS) <= set(CATALOGUE)
    assert all(400 <= status < 600 for status in STATUS.values())
    assert all(code in STATUS for code in CATALOGUE if "KG521" <= code < "KG540")


@pytest.mark.parametrize(
    ("line", "column", "excerpt", "end"),
    [(1, 1, "SELEC ?x", 6), (3, 4, "\tä\U0001f600?x foo", 6), (1, 9, "SELECT *", 10), (2, 1, None, 2)],
)
def test_the_place_of_an_error(line: int, column: int, excerpt: str | None, end: int) -> None:
    """The place of a query error has start and end, in code points."""
    place = Place("query", line, column, excerpt)
    members = problem(QueryError("KG501", "no", place=place))
    found = (members["line"], members["column"], members["endLine"], members["endColumn"])
    assert found[:3] == (line, column, line)
    assert found[3] >= column
    if excerpt is not None:
        assert found[3] == end


def test_no_path_of_this_machine_is_told(client: TestClient) -> None:
    """The place of an error is included only if it is in the client's request."""
    members = problem(KgError("KG303", "damaged", place=Place("/secret/current", 1, 1)))
    assert "secret" not in json.dumps(members)
    assert client.get("/nothing").json()["line"] is None


def test_what_may_be_tried_again_says_when() -> None:
    """Temporary errors give the time to wait."""
    with pytest.raises(LookupError):
        RequestError("KG599", "no such code")


def test_defects_are_told_by_an_identity(writing: TestClient, capfd: pytest.CaptureFixture[str]) -> None:
    """An unforeseen error is a 500 with an identity; the details are in the log only."""
    app: Any = writing.app

    async def broken(_request: Any) -> None:
        raise ZeroDivisionError("a secret of the server")

    app.router.routes.insert(0, Route("/broken", broken))
    try:
        answer = writing.get("/broken")
    finally:
        app.router.routes.pop(0)
    members = assert_error(answer, 500, "KG900")
    assert "secret" not in answer.text
    assert re.search(r"\b[0-9a-f]{16}\b", members["message"])
    capfd.readouterr()
