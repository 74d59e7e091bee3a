"""Tests of running queries: listing, cancelling, disconnecting; C14, C15."""

from __future__ import annotations

import asyncio
import json
import re
import socket
import threading
import time
from contextlib import ExitStack
from functools import partial
from http.client import HTTPConnection
from typing import TYPE_CHECKING, Any, Final, NoReturn
from urllib.parse import urlencode

import pytest
from patience import patient
from serving import TOKEN, served

from kg.server.errors import RequestError
from kg.server.leaving import while_connected

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from serving import Serving

ENDLESS: Final = "SELECT (COUNT(*) AS ?n) WHERE { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i . ?j ?k ?l }"
JOB: Final = "0123456789abcdefghij"


@pytest.fixture(scope="module")
def server(store: Path) -> Iterator[Serving]:
    """A server with a token, whose queries may take long."""
    with served(store, token=TOKEN, seconds=patient(60), cache=0, log="off") as found:
        yield found


def send(server: Serving, method: str, path: str, **headers: str) -> tuple[int, Any]:
    """Return status and JSON of the response to a request, None without a body."""
    connection = HTTPConnection("127.0.0.1", server.port, timeout=patient(60))
    connection.request(method, path, headers=headers)
    answer = connection.getresponse()
    body = answer.read()
    connection.close()
    return answer.status, json.loads(body) if body else None


def until(found: Callable[[], bool], seconds: float = 20) -> float:
    """Wait until a condition holds; return the seconds it took."""
    began = time.monotonic()
    while not found():
        assert time.monotonic() - began < patient(seconds)
        time.sleep(0.02)
    return time.monotonic() - began


def running(server: Serving) -> int:
    """Return the number of running jobs."""
    return len(send(server, "GET", "/jobs")[1]["jobs"])


def runs(server: Serving, identity: str) -> bool:
    """Whether a job runs or waits."""
    return send(server, "GET", f"/jobs/{identity}")[0] == 200


def test_cancel(server: Serving) -> None:
    """A query can be inspected and cancelled by its identity, once or repeatedly (C15)."""
    answers: list[tuple[int, Any]] = []
    path = "/sparql?" + urlencode({"query": ENDLESS, "job": JOB})
    asking = threading.Thread(target=lambda: answers.append(send(server, "GET", path)))
    asking.start()
    until(lambda: send(server, "GET", f"/jobs/{JOB}")[0] == 200)
    _, told = send(server, "GET", f"/jobs/{JOB}")
    assert told["id"] == JOB
    assert told["query"] == ENDLESS
    assert told["seconds"] >= 0
    assert send(server, "GET", path)[0] == 400  # an identity belongs to one query at a time
    assert send(server, "DELETE", f"/jobs/{JOB}")[0] == 204
    asking.join(patient(20))
    status, problem = answers[0]
    assert (status, problem["code"]) == (503, "KG510")
    assert send(server, "DELETE", f"/jobs/{JOB}")[0] == 204
    assert send(server, "GET", f"/jobs/{JOB}")[0] == 404
    assert running(server) == 0


def test_identities_are_secret(server: Serving) -> None:
    """Without a token, the number of running queries is visible, but neither their text nor the way to cancel them."""
    path = "/sparql?" + urlencode({"query": ENDLESS, "job": JOB})
    asking = threading.Thread(target=send, args=(server, "GET", path))
    asking.start()
    until(lambda: running(server) == 1)
    (told,) = send(server, "GET", "/jobs")[1]["jobs"]
    assert set(told) == {"seconds", "rows"}
    (told,) = send(server, "GET", "/jobs", authorization=f"Bearer {TOKEN}")[1]["jobs"]
    assert told["id"] == JOB
    send(server, "DELETE", f"/jobs/{JOB}")
    asking.join(patient(20))


@pytest.mark.parametrize("stream", ["false", "true"])
def test_leaving_ends_the_query(server: Serving, stream: str) -> None:
    """When the client closes the connection its query ends (C14)."""
    endless = ENDLESS if stream == "false" else "SELECT * WHERE { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i . ?j ?k ?l }"
    with socket.create_connection(("127.0.0.1", server.port)) as connection:
        path = "/sparql?" + urlencode({"query": endless, "stream": stream})
        connection.sendall(f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\n\r\n".encode())
        until(lambda: running(server) == 1)
        time.sleep(0.5)
        assert running(server) == 1
    # The guarantee is one second; the rest allows for busy machines.
    assert until(lambda: running(server) == 0) < patient(4)


@pytest.mark.parametrize("stream", ["false", "true"])
def test_leaving_ends_the_waiting(server: Serving, stream: str) -> None:
    """When the client of a queued query closes the connection the query leaves the queue (C14)."""
    with ExitStack() as clients, ExitStack() as leaving:
        for number in range(4):
            client = clients if number < 3 else leaving
            connection = client.enter_context(socket.create_connection(("127.0.0.1", server.port)))
            path = "/sparql?" + urlencode({"query": f"{ENDLESS} #{number}", "stream": stream, "job": f"{JOB}{number}"})
            connection.sendall(f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\n\r\n".encode())
            until(partial(runs, server, f"{JOB}{number}"))
        time.sleep(1)
        assert all(runs(server, f"{JOB}{number}") for number in range(4))
        leaving.close()
        assert until(lambda: not runs(server, f"{JOB}3")) < patient(4)
    until(lambda: not any(runs(server, f"{JOB}{number}") for number in range(3)))


def test_a_body_that_nobody_reads() -> None:
    """A malformed body is reported even if the request needs none."""

    async def receive() -> NoReturn:
        raise RequestError("KG532", "the request body arrived too slowly")

    with pytest.raises(RequestError):
        asyncio.run(while_connected(receive, asyncio.sleep(10)))


def test_streams_tell_their_identity(server: Serving) -> None:
    """A streamed response has a header with an unguessable identity."""
    identities = set()
    for _ in range(3):
        connection = HTTPConnection("127.0.0.1", server.port, timeout=patient(60))
        connection.request("GET", "/sparql?" + urlencode({"query": "ASK { }", "stream": "true"}))
        answer = connection.getresponse()
        answer.read()
        identities.add(answer.getheader("x-kg-job"))
        connection.close()
    assert len(identities) == 3
    assert all(re.fullmatch(r"[\w-]{20,}", identity or "") for identity in identities)
