"""Tests of the sizes of requests, C26, as the application sees them."""

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
    """A server that takes small bodies only, and may be changed."""
    with application(store, body=MOST, write=True, token=TOKEN, log="off") as found:
        yield found


def refused(answer: Any) -> tuple[int, str]:
    """Return status and code of an error."""
    return answer.status_code, answer.json()["code"]


def test_a_body_that_announces_too_much_is_not_read(small: TestClient) -> None:
    """Content-Length is believed before anything is read."""

    def never() -> Iterator[bytes]:
        yield b"x" * (MOST + 1)
        pytest.fail("the body was read")

    headers = {**QUERY, "Content-Length": str(MOST + 1)}
    assert refused(small.post("/sparql", content=never(), headers=headers)) == (413, "KG525")


def test_queries_are_bounded_more_closely(store: Path) -> None:
    """What is read into memory for whoever may read is smaller than what the holder of the token may write."""
    with application(store, write=True, token=TOKEN, log="off") as found:
        headers = {"Content-Length": str(QUERY_BYTES + 1), "Authorization": f"Bearer {TOKEN}"}
        for address in ("/sparql", "/api/find", "/login"):
            assert refused(found.post(address, content=b"", headers=headers)) == (413, "KG525")
        for address in ("/update", "/store?default"):
            assert refused(found.post(address, content=b"", headers=headers))[1] != "KG525"


def test_a_body_that_grows_is_stopped() -> None:
    """A body without a length is counted while it comes, and read no further than the limit."""
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
    """A body that does not come, or byte by byte, is given up."""
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
    """The limit itself passes."""
    text = "ASK{}#".ljust(MOST, "x")
    assert small.post("/sparql", content=text, headers=QUERY).status_code == 200


@pytest.mark.parametrize("encoding", ["gzip", "deflate", "br", "x-gzip", "gzip, gzip"])
def test_compressed_bodies_are_refused(small: TestClient, encoding: str) -> None:
    """A bomb of ten kilobytes is not unpacked to ten gigabytes: 415, and which encoding is taken."""
    headers = {**QUERY, "Content-Encoding": encoding}
    answer = small.post("/sparql", content=gzip.compress(b"ASK{}"), headers=headers)
    assert refused(answer) == (415, "KG524")
    assert answer.headers["accept-encoding"] == "identity"


def test_long_addresses(client: TestClient) -> None:
    """Path and query together may be 8 KB; the way out is a POST."""
    fitting = "/sparql?query=" + "ASK{}%23".ljust(ADDRESS_BYTES - len("/sparqlquery="), "x")
    assert client.get(fitting).status_code == 200
    answer = client.get(fitting + "xx")
    assert refused(answer) == (414, "KG526")
    assert "POST" in answer.json()["hint"]
    assert refused(client.get("/" + "x" * ADDRESS_BYTES)) == (414, "KG526")


def test_many_or_long_headers(client: TestClient) -> None:
    """A request with more headers than any browser sends, or much longer ones, is refused."""
    many = {f"X-{number}": "x" for number in range(HEADERS + 1)}
    assert refused(client.get("/health", headers=many)) == (431, "KG535")
    assert refused(client.get("/health", headers={"Cookie": "x" * 40_000})) == (431, "KG535")


@pytest.mark.parametrize("length", ["-1", "ten", "1e3", "0x10"])
def test_lengths_that_are_no_numbers(client: TestClient, length: str) -> None:
    """Content-Length has digits, and nothing else."""
    answer = client.request("GET", "/health", headers={"Content-Length": length})
    assert refused(answer) == (400, "KG520")
