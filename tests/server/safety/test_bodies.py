"""Tests of request sizes, C26, at the level of the application."""

from __future__ import annotations

import asyncio
import gzip
from typing import TYPE_CHECKING, Any

import pytest
from serving import TOKEN, application

from kg.server.errors import RequestError
from kg.server.safety import bodies
from kg.server.safety.bodies import ADDRESS_BYTES, HEADERS, QUERY_BYTES, Bodies

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from starlette.testclient import TestClient

MOST = 10_000
QUERY = {"Content-Type": "application/sparql-query"}


@pytest.fixture(scope="module")
def small(store: Path) -> Iterator[TestClient]:
    """A writable server that accepts small bodies only."""
    with application(store, body=MOST, write=True, token=TOKEN, log="off") as found:
        yield found


def refused(answer: Any) -> tuple[int, str]:
    """Return status and code of an error."""
    return answer.status_code, answer.json()["code"]


def test_a_body_that_announces_too_much_is_not_read(small: TestClient) -> None:
    """An excessive Content-Length is rejected before reading the body."""

    def never() -> Iterator[bytes]:
        yield b"x" * (MOST + 1)
        pytest.fail("the body was read")

    headers = {**QUERY, "Content-Length": str(MOST + 1)}
    assert refused(small.post("/sparql", content=never(), headers=headers)) == (413, "KG525")


def test_queries_are_bounded_more_closely(store: Path) -> None:
    """The limit for queries, which are read into memory, is lower than that for writes with the token."""
    with application(store, write=True, token=TOKEN, log="off") as found:
        headers = {"Content-Length": str(QUERY_BYTES + 1), "Authorization": f"Bearer {TOKEN}"}
        for address in ("/sparql", "/api/find", "/login"):
            assert refused(found.post(address, content=b"", headers=headers)) == (413, "KG525")
        for address in ("/update", "/store?default"):
            assert refused(found.post(address, content=b"", headers=headers))[1] != "KG525"


def test_a_body_that_grows_is_stopped() -> None:
    """A body without a length is counted while it arrives, and read no further than the limit."""
    taken = 0

    async def receive() -> Any:
        nonlocal taken
        taken += 1
        return {"type": "http.request", "body": b"x" * 1000, "more_body": True}

    async def application(_scope: Any, receive: Any, _send: Any) -> None:
        while True:
            await receive()

    async def send(_message: Any) -> None:
        pass

    scope = {"type": "http", "path": "/update", "headers": [(b"transfer-encoding", b"chunked")]}
    with pytest.raises(RequestError) as caught:
        asyncio.run(Bodies(application, MOST)(scope, receive, send))
    assert caught.value.code == "KG525"
    assert taken == MOST // 1000 + 1


@pytest.mark.parametrize("pause", ["never", "dribble"])
def test_a_body_that_comes_too_slowly_is_stopped(pause: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A body that stalls or arrives byte by byte is aborted."""
    monkeypatch.setattr(bodies, "_PAUSE", 0.05)

    async def receive() -> Any:
        await asyncio.sleep(10 if pause == "never" else 0.01)
        return {"type": "http.request", "body": b"x", "more_body": True}

    async def application(_scope: Any, receive: Any, _send: Any) -> None:
        while True:
            await receive()

    async def send(_message: Any) -> None:
        pass

    scope = {"type": "http", "path": "/update", "headers": [(b"content-length", b"9")]}
    with pytest.raises(RequestError) as caught:
        asyncio.run(Bodies(application, MOST)(scope, receive, send))
    assert caught.value.code == "KG532"
    assert caught.value.headers["Connection"] == "close"


def test_a_body_that_is_just_small_enough(small: TestClient) -> None:
    """A body of exactly the limit is accepted."""
    text = "ASK{}#".ljust(MOST, "x")
    assert small.post("/sparql", content=text, headers=QUERY).status_code == 200


@pytest.mark.parametrize("encoding", ["gzip", "deflate", "br", "x-gzip", "gzip, gzip"])
def test_compressed_bodies_are_refused(small: TestClient, encoding: str) -> None:
    """A compression bomb of ten kilobytes is never unpacked: 415, with the accepted encoding."""
    headers = {**QUERY, "Content-Encoding": encoding}
    answer = small.post("/sparql", content=gzip.compress(b"ASK{}"), headers=headers)
    assert refused(answer) == (415, "KG524")
    assert answer.headers["accept-encoding"] == "identity"


def test_long_addresses(client: TestClient) -> None:
    """Path and query together may be 8 KB; the error suggests POST."""
    fitting = "/sparql?query=" + "ASK{}%23".ljust(ADDRESS_BYTES - len("/sparqlquery="), "x")
    assert client.get(fitting).status_code == 200
    answer = client.get(fitting + "xx")
    assert refused(answer) == (414, "KG526")
    assert "POST" in answer.json()["hint"]
    assert refused(client.get("/" + "x" * ADDRESS_BYTES)) == (414, "KG526")


def test_many_or_long_headers(client: TestClient) -> None:
    """A request with more headers than any browser sends, or much longer ones, is rejected."""
    many = {f"X-{number}": "x" for number in range(HEADERS + 1)}
    assert refused(client.get("/health", headers=many)) == (431, "KG535")
    assert refused(client.get("/health", headers={"Cookie": "x" * 40_000})) == (431, "KG535")


@pytest.mark.parametrize("length", ["-1", "ten", "1e3", "0x10"])
def test_lengths_that_are_no_numbers(client: TestClient, length: str) -> None:
    """Content-Length consists of digits only."""
    answer = client.request("GET", "/health", headers={"Content-Length": length})
    assert refused(answer) == (400, "KG520")
