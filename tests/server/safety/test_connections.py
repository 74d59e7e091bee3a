"""Tests of connection limits below the application: C26 over a real port."""

from __future__ import annotations

import re
import socket
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from patience import patient
from serving import TOKEN, Serving, served

from kg.server.safety import connections

if TYPE_CHECKING:
    from collections.abc import Iterator

PATIENT = """
from kg.server.safety import bodies, connections
connections.HEAD_SECONDS = connections.REST_SECONDS = connections.STALLED_SECONDS = 1.0
bodies._PAUSE = 1.0
"""
"""The same server with shorter timeouts, for faster tests."""


@pytest.fixture(scope="module")
def server(store: Path) -> Iterator[Serving]:
    """A server with short timeouts and at most eight waiting connections."""
    with served(store, before=PATIENT, connections=8, body=100_000, write=True, token=TOKEN, log="off") as found:
        yield found


def opened(server: Serving, said: bytes = b"") -> socket.socket:
    """Return a connection after sending some bytes."""
    found = socket.create_connection(("127.0.0.1", server.port), timeout=patient(10))
    found.sendall(said)
    return found


def heard(connection: socket.socket) -> bytes:
    """Return everything the server sends until it closes."""
    parts = []
    with suppress(ConnectionError):
        while part := connection.recv(65536):
            parts.append(part)
    connection.close()
    return b"".join(parts)


def is_alive(server: Serving) -> bool:
    """Whether the next request is answered."""
    return b" 200 OK" in heard(opened(server, b"GET /health HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"))


@pytest.mark.parametrize(
    "said", [b"", b"G", b"GET / HTTP/1.1\r\n", b"GET / HTTP/1.1\r\nHost: localhost\r\nX-A: b", b"\r\n\r\n"]
)
def test_headers_that_do_not_come(server: Serving, said: bytes) -> None:
    """A connection with incomplete headers times out."""
    began = time.monotonic()
    answer = heard(opened(server, said))
    assert time.monotonic() - began < patient(2)
    assert not answer or b" 408 " in answer
    assert is_alive(server)


def test_headers_that_dribble(server: Serving) -> None:
    """Headers sent byte by byte do not extend the timeout."""
    connection = opened(server, b"GET / HTTP/1.1\r\nHost: localhost\r\n")
    began = time.monotonic()
    with suppress(ConnectionError):
        while time.monotonic() - began < patient(2):
            connection.sendall(b"X-A: b\r\n")
            time.sleep(0.1)
    assert time.monotonic() - began < patient(2)


def test_a_second_request_that_does_not_come(server: Serving) -> None:
    """The timeout applies to each request of a connection."""
    first = b"GET /health HTTP/1.1\r\nHost: localhost\r\n\r\n"
    began = time.monotonic()
    answer = heard(opened(server, first + b"GET /hea"))
    assert answer.count(b"HTTP/1.1 ") == 2
    assert b" 408 " in answer
    assert time.monotonic() - began < patient(2)


def test_a_body_that_does_not_come(server: Serving) -> None:
    """A request without its body gets 408, and the connection is closed."""
    head = (
        b"POST /sparql HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/sparql-query\r\nContent-Length: 99\r\n"
    )
    answer = heard(opened(server, head + b"\r\nASK"))
    assert b" 408 " in answer
    assert b"KG532" in answer


def test_a_body_that_nobody_waits_for(server: Serving) -> None:
    """A body that continues after its response does not keep the connection open forever."""
    head = b"POST /nothing HTTP/1.1\r\nHost: localhost\r\nContent-Length: 99999\r\n\r\n"
    connection = opened(server, head)
    began = time.monotonic()
    with suppress(ConnectionError):
        while time.monotonic() - began < patient(2):
            connection.sendall(b"x")
            time.sleep(0.1)
    assert time.monotonic() - began < patient(2)


def test_headers_without_end(server: Serving) -> None:
    """Excessive headers are cut off with 431 or a closed connection, and little is read."""
    connection = opened(server, b"GET / HTTP/1.1\r\nHost: localhost\r\nX-Bomb: ")
    sent = 0
    with suppress(ConnectionError, TimeoutError):
        while sent < 50_000_000:
            sent += connection.send(b"x" * 65536)
            connection.settimeout(patient(3))
    assert sent < 50_000_000
    answer = heard(connection)
    assert not answer or b" 431 " in answer
    assert is_alive(server)


def test_an_answer_comes_before_a_large_body(server: Serving) -> None:
    """A request with `Expect: 100-continue` gets 413 and need not send its body."""
    head = b"POST /sparql HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/sparql-query\r\n"
    connection = opened(server, head + b"Content-Length: 200000000\r\nExpect: 100-continue\r\n\r\n")
    answer = connection.recv(65536)
    connection.close()
    assert b" 413 " in answer
    assert b" 100 " not in answer


def test_a_chunked_body_without_end(server: Serving) -> None:
    """A body of unknown length gets 413 when it exceeds the limit."""
    head = b"POST /sparql HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/sparql-query\r\n"
    connection = opened(server, head + b"Transfer-Encoding: chunked\r\n\r\n")
    chunk = b"1000\r\n" + b"x" * 4096 + b"\r\n"
    with suppress(ConnectionError):
        for _ in range(40):
            connection.sendall(chunk)
    answer = connection.recv(65536)
    connection.close()
    assert b" 413 " in answer


@pytest.mark.parametrize("body", [b"zz\r\nASK {}\r\n", b"5\r\nASK {}\r\n0\r\n\r\n"])
def test_a_malformed_body_is_answered(server: Serving, body: bytes) -> None:
    """A body whose chunks are malformed gets 400, although the application waits for it."""
    head = b"POST /sparql HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/sparql-query\r\n"
    answer = heard(opened(server, head + b"Transfer-Encoding: chunked\r\n\r\n" + body))
    assert (answer.startswith(b"HTTP/1.1 400 "), b"KG520" in answer) == (True, True)
    assert is_alive(server)


@pytest.mark.parametrize("length", [10_000, 64_000, 90_000, 3_000_000])
def test_long_addresses_are_answered(server: Serving, length: int) -> None:
    """An address of any length above the limit gets 414."""
    connection = opened(server)
    with suppress(ConnectionError):
        connection.sendall(b"GET /sparql?query=" + b"a" * length + b" HTTP/1.1\r\nHost: localhost\r\n\r\n")
    answer = connection.recv(65536)
    connection.close()
    assert (answer.startswith(b"HTTP/1.1 414 "), b"KG526" in answer) == (True, True)


def test_options_of_the_whole_server(server: Serving) -> None:
    """`OPTIONS *` lists the methods of all addresses (RFC 9110, section 9.3.7)."""
    answer = heard(opened(server, b"OPTIONS * HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"))
    assert answer.startswith(b"HTTP/1.1 204 ")
    assert b"\r\nallow: delete, get, head, options, post, put, query\r\n" in answer.lower()


@pytest.mark.parametrize(
    "said",
    [
        b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03",
        b"GET / HTTP/9.9\r\n\r\n",
        b"GET / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1\r\nContent-Length: 2\r\n\r\nx",
        b"GET / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 3\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n",
        b"GET / HTTP/1.1\r\nHost localhost\r\n\r\n",
        b"GET \xff\xfe HTTP/1.1\r\nHost: localhost\r\n\r\n",
        b"A" * 20 + b" / HTTP/1.1\r\n\r\n",
    ],
)
def test_what_is_no_request(server: Serving, said: bytes) -> None:
    """Invalid HTTP, or two requests in one, gets an error of the common form, and the connection is closed."""
    answer = heard(opened(server, said))
    assert b"HTTP/1.1 4" in answer
    assert b"KG5" in answer
    assert b"content-security-policy" in answer
    assert is_alive(server)


HALF = b"GET /health HTTP/1.1\r\nHost: localhost\r\n"
CHEAP = b"GET /sparql?query=ASK{} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"
UNHURRIED = "from kg.server.safety import connections; connections.HEAD_SECONDS = 3600.0"
"""A server without timeouts for slow connections."""


@pytest.mark.parametrize("before", [1, 2])
def test_requests_before_a_malformed_one_are_answered(server: Serving, before: int) -> None:
    """Responses to requests of one packet come in order; the malformed last one is refused (RFC 9112, 9.3.2)."""
    complete = b"GET /sparql?query=ASK%7B%7D HTTP/1.1\r\nHost: localhost\r\n\r\n"
    answer = heard(opened(server, complete * before + b"GET / HTTP/1.1\r\nHost localhost\r\n\r\n"))
    assert re.findall(rb"HTTP/1.1 (\d+)", answer) == [b"200"] * before + [b"400"]


def test_half_open_connections_keep_nobody_out(store: Path) -> None:
    """C26: however many connections wait with half a request, a new one is served; the oldest are closed."""
    with served(store, before=UNHURRIED, connections=8, log="off") as server:
        held = [opened(server, HALF) for _ in range(40)]
        assert is_alive(server)
        assert b" 200 OK" in heard(opened(server, CHEAP))
        held[-1].sendall(b"Connection: close\r\n\r\n")
        assert b" 200 OK" in heard(held[-1])
        assert heard(held[0]) == b""
        for one in held[1:-1]:
            one.close()


def test_bodies_that_dribble_keep_nobody_out(store: Path) -> None:
    """C26: a request with an incomplete body counts as a waiting one."""
    head = b"POST /sparql HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/sparql-query\r\n"
    with served(store, connections=4, log="off") as server:
        held = [opened(server, head + b"Content-Length: 99\r\n\r\nASK") for _ in range(20)]
        assert b" 200 OK" in heard(opened(server, CHEAP))
        for one in held:
            one.close()


def test_a_busy_server_is_healthy(store: Path) -> None:
    """C26: above the limit requests get 503, but health checks succeed."""
    endless = "SELECT (COUNT(*) AS ?n) {" + " ".join(f"?a{i} ?b{i} ?c{i} ." for i in range(14)) + "}"
    with served(store, connections=2, seconds=600.0, log="off") as server:
        lines = f"POST /sparql HTTP/1.1\r\nHost: localhost\r\nContent-Length: {len(endless)}\r\n"
        query = f"{lines}Content-Type: application/sparql-query\r\n\r\n{endless}".encode()
        held = [opened(server, query) for _ in range(2)]
        closing = b"HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"
        while b'"running":2' not in heard(opened(server, b"GET /health " + closing)):
            pass
        refused = heard(opened(server, CHEAP))
        assert b" 503 " in refused
        assert b"KG533" in refused
        assert b"retry-after" in refused
        for path in (b"/health", b"/health?full", b"/metrics"):
            assert b" 200 OK" in heard(opened(server, b"GET " + path + b" " + closing))
        held.pop().close()
        while b" 200 OK" not in heard(opened(server, CHEAP)):
            pass
        held.pop().close()


class _Connection:
    """A connection that records that it was closed."""

    closed = False

    def make_room(self) -> None:
        self.closed = True


@given(st.lists(st.tuples(st.sampled_from("abc"), st.sampled_from(["wait", "answer", "forget"])), max_size=60))
def test_the_address_with_most_waiting_connections_loses_one(steps: list[tuple[str, str]]) -> None:
    """C26: the number of waiting connections is limited; the oldest one of an address with the most is closed."""
    crowd = connections.Crowd(4, "")
    waiting: dict[str, list[Any]] = {name: [] for name in "abc"}
    for address, step in steps:
        if step == "wait":
            waiting[address].append(_Connection())
            most = max(map(len, waiting.values()))
            crowd.wait(waiting[address][-1], address)
            for one in waiting.values():
                if one and one[0].closed:
                    assert len(one) == most
                    del one[0]
        elif waiting[address]:
            getattr(crowd, step)(waiting[address].pop(), address)
        assert {name: list(found) for name, found in crowd.waiting.items()} == {k: v for k, v in waiting.items() if v}
        assert sum(map(len, waiting.values())) <= 4


def holds(server: Serving, connection: socket.socket) -> bool:
    """Whether the server holds a connection; its client, which reads nothing, cannot detect that."""
    ends = f":{server.port:04X}", f":{connection.getsockname()[1]:04X}"
    for line in Path("/proc/net/tcp").read_text().splitlines():
        fields = line.split()
        if (fields[1][-5:], fields[2][-5:]) == ends:
            return fields[9] != "0"
    return False


@pytest.mark.skipif(sys.platform != "linux", reason="whose a connection is is looked up in /proc")
def test_a_client_that_takes_nothing(server: Serving) -> None:
    """An unread response does not keep the connection open."""
    text = b"SELECT * { ?a ?b ?c . ?d ?e ?f } LIMIT 30000"
    head = (
        b"POST /sparql HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/sparql-query\r\nContent-Length: %d\r\n"
    )
    connection = socket.socket()
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    connection.settimeout(patient(30))
    connection.connect(("127.0.0.1", server.port))
    connection.sendall(head % len(text) + b"\r\n" + text)
    assert connection.recv(100)
    end = time.monotonic() + patient(10)
    while holds(server, connection):
        assert time.monotonic() < end
        time.sleep(0.05)
    total = len(heard(connection))
    assert total < 20_000_000
    assert is_alive(server)
