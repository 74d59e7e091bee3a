"""Tests of the check of Host, C22."""

from __future__ import annotations

import socket
from typing import TYPE_CHECKING

import pytest
from patience import patient
from serving import EVERYWHERE, served
from starlette.requests import HTTPConnection

from kg.server.options import Options
from kg.server.safety.hosts import Hosts, is_loopback

if TYPE_CHECKING:
    from pathlib import Path

    from starlette.testclient import TestClient


def refusal(options: Options, *hosts: str) -> str | None:
    """Return the error code for a request with these `Host` headers, None if it passes."""
    headers = [(b"host", host.encode()) for host in hosts]
    scope = {"type": "http", "headers": headers, "path": "/", "query_string": b"", "method": "GET"}
    found = Hosts(options)(HTTPConnection(scope))
    return None if found is None else found.code


def allows(options: Options, *hosts: str) -> bool:
    """Whether a request with these `Host` headers passes."""
    return refusal(options, *hosts) is None


@pytest.mark.parametrize(
    "host", ["localhost", "LOCALHOST:7878", "127.0.0.1", "127.0.0.1:1", "[::1]:7878", "localhost."]
)
def test_names_of_this_machine_pass(host: str) -> None:
    """Each loopback name is accepted, at any port."""
    assert allows(Options(), host)


@pytest.mark.parametrize(
    "host", ["evil.example", "evil.example:7878", "localhost.evil.example", "127.0.0.1.evil.example", "192.168.0.1"]
)
def test_other_hosts_are_refused(host: str) -> None:
    """Other names that resolve to this machine are rejected."""
    assert refusal(Options(), host) == "KG527"


@pytest.mark.parametrize(
    "host",
    [
        "evil@localhost",
        "localhost/",
        "localhost:7878:1",
        "localhost:port",
        "[::1",
        "[evil.example]",
        "",
        "local\u00f6host",
    ],
)
def test_what_is_no_host_is_malformed(host: str) -> None:
    """An invalid host is rejected as a malformed request (RFC 9112, section 3.2)."""
    assert refusal(Options(), host) == "KG520"


def test_one_host_and_no_more() -> None:
    """A request without Host, or with two, is malformed (RFC 9112, section 3.2)."""
    assert refusal(Options()) == "KG520"
    assert refusal(Options(), "localhost", "evil.example") == "KG520"
    assert refusal(Options(), "localhost", "localhost") == "KG520"


@pytest.mark.parametrize("headers", ["", "Host: 127.0.0.1\r\nHost: 127.0.0.1\r\n", "Host: a b\r\n"])
def test_a_malformed_request_is_answered_400(store: Path, headers: str) -> None:
    """Over a connection, a request without exactly one valid Host gets status 400."""
    with (
        served(store, log="off") as server,
        socket.create_connection(("127.0.0.1", server.port), timeout=patient(30)) as link,
    ):
        link.sendall(f"GET /health HTTP/1.1\r\n{headers}Connection: close\r\n\r\n".encode())
        assert link.makefile("rb").readline().split()[1] == b"400"


def test_names_that_are_allowed() -> None:
    """Names given in the options pass, and only those."""
    options = Options(hosts=("Robot.lab",))
    assert allows(options, "robot.lab:80")
    assert not allows(options, "other.lab")


def test_addresses_pass_where_others_may_come() -> None:
    """A server open to other machines accepts any address, which DNS tricks cannot fake, but no unknown name."""
    options = Options(host=EVERYWHERE)
    assert allows(options, "192.168.0.7:7878")
    assert not allows(options, "evil.example")
    assert allows(Options(host="robot.lab"), "robot.lab")


def test_the_answer_says_why(client: TestClient) -> None:
    """A wrong host gets 421 with the code and instructions."""
    answer = client.get("/health", headers={"Host": "evil.example"})
    assert answer.status_code == 421
    assert answer.json()["code"] == "KG527"
    assert "--allow-host" in answer.json()["hint"]


@pytest.mark.parametrize(
    ("host", "expected"),
    [("127.0.0.1", True), ("127.8.8.8", True), ("::1", True), ("[::1]", True), ("localhost", True), (EVERYWHERE, False),
     ("::", False), ("192.168.0.1", False), ("robot.lab", False), ("", False)],
)  # fmt: skip
def test_loopback(host: str, *, expected: bool) -> None:
    """Only addresses reachable from this machine alone are loopback."""
    assert is_loopback(host) is expected
