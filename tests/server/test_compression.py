"""Compressed responses, and uncompressed streams."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from starlette.testclient import TestClient

STYLE = "/static/kg.css"
QUERY = "/sparql?query=SELECT+*+%7B%3Fs+%3Fp+%3Fo%7D+LIMIT+1000"


@pytest.mark.parametrize("address", ["/", "/system?name=rover.launch", "/api/rules", STYLE])
def test_what_people_read_is_compressed(client: TestClient, address: str) -> None:
    """Pages, views and styles are sent with gzip to clients that accept it, and otherwise uncompressed."""
    small = client.get(address, headers={"Accept-Encoding": "gzip"})
    large = client.get(address, headers={"Accept-Encoding": "identity"})
    assert small.headers["Content-Encoding"] == "gzip"
    assert "Accept-Encoding" in small.headers["Vary"]
    assert "Content-Encoding" not in large.headers
    assert int(small.headers["Content-Length"]) < len(small.content) / 2


@pytest.mark.parametrize(
    ("takes", "coding"),
    [("gzip;q=0", None), ("br, GZIP ; q=0.000", None), ("gzip;q=0.5", "gzip"), ("gzip;q=0.05, br", "gzip")],
)
def test_weights_are_heard(client: TestClient, takes: str, coding: str | None) -> None:
    """A client that excludes gzip gets none; any weight above zero accepts it, and `Vary` informs caches."""
    answer = client.get(STYLE, headers={"Accept-Encoding": takes})
    assert answer.headers.get("Content-Encoding") == coding
    assert "Accept-Encoding" in answer.headers["Vary"]


def test_answers_of_the_protocols_are_not(client: TestClient) -> None:
    """Streams for programs and small responses are sent uncompressed."""
    for address in (QUERY, "/health"):
        answer = client.get(address, headers={"Accept-Encoding": "gzip"})
        assert "Content-Encoding" not in answer.headers


def test_tags_of_what_is_compressed_are_weak(client: TestClient) -> None:
    """Different encodings share no strong tag, so their parts are never combined; both revalidate."""
    small, large = (client.get(STYLE, headers={"Accept-Encoding": coding}) for coding in ("gzip", "identity"))
    assert small.headers["ETag"] == f"W/{large.headers['ETag']}"
    for answer in (small, large):
        again = client.get(STYLE, headers={"Accept-Encoding": "gzip", "If-None-Match": answer.headers["ETag"]})
        assert (again.status_code, again.content) == (304, b"")
    for tag, status in ((small, 200), (large, 206)):
        part = {"Accept-Encoding": "gzip", "Range": "bytes=0-9", "If-Range": tag.headers["ETag"]}
        assert client.get(STYLE, headers=part).status_code == status
