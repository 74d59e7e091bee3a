"""Tests of requests sent by pages of other sites: C23 and C24."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from serving import ADDRESS, TOKEN, application

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from starlette.testclient import TestClient

BEARER = {"Authorization": f"Bearer {TOKEN}"}
LISTED = "https://friend.example"


@pytest.fixture(scope="module")
def writing(store: Path) -> Iterator[TestClient]:
    """A server writable with a token, whose data one other site may read."""
    with application(store, write=True, token=TOKEN, origins=(LISTED,), log="off") as found:
        yield found


def stopped(client: TestClient, method: str, path: str, headers: dict[str, str], **named: Any) -> bool:
    """Whether a request is rejected as one of another site."""
    answer = client.request(method, path, headers=headers, **named)
    return answer.status_code == 403 and answer.json()["code"] == "KG528"


@pytest.mark.parametrize(
    ("method", "headers", "expected"),
    [
        ("POST", {}, False),
        ("POST", {"Sec-Fetch-Site": "same-origin"}, False),
        ("POST", {"Sec-Fetch-Site": "none"}, False),
        ("POST", {"Sec-Fetch-Site": "same-origin", "Origin": ADDRESS}, False),
        ("POST", {"Origin": ADDRESS}, False),
        ("POST", {"Sec-Fetch-Site": "cross-site"}, True),
        ("POST", {"Sec-Fetch-Site": "same-site"}, True),
        ("POST", {"Sec-Fetch-Site": "unheard-of"}, True),
        ("POST", {"Sec-Fetch-Site": "cross-site", "Origin": ADDRESS}, True),
        ("POST", {"Sec-Fetch-Site": "cross-site", "Cookie": "kg_session_7878=x"}, True),
        ("POST", {"Origin": "https://evil.example"}, True),
        ("POST", {"Origin": "null"}, True),
        ("POST", {"Origin": "http://127.0.0.1:3000"}, True),
        ("POST", {"Origin": "https://127.0.0.1:7878"}, True),
        ("POST", {"Origin": ADDRESS + ".evil.example"}, True),
        ("DELETE", {"Sec-Fetch-Site": "cross-site"}, True),
        ("PUT", {"Origin": "https://evil.example"}, True),
        ("PATCH", {"Sec-Fetch-Site": "same-site"}, True),
        ("POST", {"Origin": "https://evil.example", **BEARER}, False),
        ("POST", {"Origin": "https://evil.example", **BEARER, "Cookie": "kg_session_7878=x"}, True),
        ("POST", {"Origin": "https://evil.example", "Authorization": "Basic eDp5", "Cookie": "a=b"}, True),
    ],
)
def test_changes(writing: TestClient, method: str, headers: dict[str, str], *, expected: bool) -> None:
    """A change passes from this site, from programs, and with a token that no page can send automatically."""
    assert stopped(writing, method, "/store?default", headers) is expected


@pytest.mark.parametrize(
    ("headers", "expected"),
    [
        ({}, False),
        ({"Sec-Fetch-Site": "same-origin", "Sec-Fetch-Mode": "cors"}, False),
        ({"Sec-Fetch-Site": "none", "Sec-Fetch-Mode": "navigate"}, False),
        ({"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "navigate"}, False),
        ({"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "no-cors"}, True),
        ({"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "cors", "Origin": "https://evil.example"}, True),
        ({"Sec-Fetch-Site": "same-site", "Sec-Fetch-Mode": "cors", "Origin": "http://127.0.0.1:3000"}, True),
        ({"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "cors", "Origin": LISTED}, False),
    ],
)
def test_reading(writing: TestClient, headers: dict[str, str], *, expected: bool) -> None:
    """Links from other sites work, but their pages cannot make requests."""
    assert stopped(writing, "GET", "/sparql?query=ASK{}", headers) is expected


def test_no_other_site_reads_unless_listed(client: TestClient) -> None:
    """CORS is off: no response names an origin, and preflights are denied."""
    asked = {"Origin": LISTED, "Access-Control-Request-Method": "GET"}
    for answer in (
        client.get("/health", headers={"Origin": LISTED}),
        client.options("/sparql", headers=asked),
        client.options("/update", headers=asked),
    ):
        assert not [name for name in answer.headers if name.startswith("access-control-")]


def test_a_listed_site_reads(writing: TestClient) -> None:
    """Responses name the listed origin and no other, never `*`, and allow no cookies."""
    answer = writing.post("/sparql", data={"query": "ASK{}"}, headers={"Origin": LISTED})
    assert answer.status_code == 200
    assert answer.headers["access-control-allow-origin"] == LISTED
    assert "access-control-allow-credentials" not in answer.headers
    assert "Origin" in answer.headers["vary"]
    other = writing.get("/health", headers={"Origin": "https://friend.example.evil"})
    assert "access-control-allow-origin" not in other.headers
    assert "Origin" in other.headers["vary"]


def test_a_preflight_lists_methods_that_read(writing: TestClient) -> None:
    """A preflight lists the methods of a listed site, none of which changes data."""
    headers = {"Origin": LISTED, "Access-Control-Request-Method": "POST"}
    answer = writing.options("/sparql", headers=headers)
    assert answer.status_code == 204
    assert answer.headers["access-control-allow-methods"] == "GET, HEAD, POST, QUERY, OPTIONS"
    assert not {"PUT", "PATCH", "DELETE"} & set(answer.headers["access-control-allow-methods"].split(", "))


def test_a_listed_site_changes_nothing(writing: TestClient) -> None:
    """A listed site may read, and cannot change anything that needs a cookie."""
    assert stopped(writing, "POST", "/update", {"Origin": LISTED, "Cookie": "kg_session_7878=x"})
    assert stopped(writing, "PUT", "/store?default", {"Origin": LISTED})
