"""Tests of requests with the head of an earlier one, which is not checked and parsed again, and of whole responses."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import httpx
import pytest
from serving import TOKEN, application, served

from kg.server.safety.headers import HEADERS, lines_of

if TYPE_CHECKING:
    from pathlib import Path

    from starlette.testclient import TestClient

MOST = 10_000
QUERY = {"Content-Type": "application/sparql-query", "Accept": "application/sparql-results+json"}


def refused(answer: Any) -> tuple[int, str]:
    """Return status and code of an error."""
    return answer.status_code, answer.json()["code"]


def count(client: TestClient, text: str, **headers: str) -> Any:
    """Post a query, always with the same head but for its length."""
    return client.post("/sparql?limit=1", content=text, headers={**QUERY, **headers})


def test_bodies_with_the_same_head_are_different_queries(store: Path) -> None:
    """Each has its own result, entity tag and link to further rows."""
    with application(store, log="off") as client:
        answers = [count(client, f"SELECT ?a {{ VALUES ?a {{ {one} {one + 1} }} }}") for one in (1, 3, 1)]
        values = [answer.json()["results"]["bindings"][0]["a"]["value"] for answer in answers]
        assert values == ["1", "3", "1"]
        assert answers[0].headers["etag"] == answers[2].headers["etag"] != answers[1].headers["etag"]
        following = client.get(answers[1].links["next"]["url"]).json()
        assert following["results"]["bindings"][0]["a"]["value"] == "4"


def test_each_body_is_checked(store: Path) -> None:
    """Length and encoding of a body are its own, whatever was sent with the same head before."""
    with application(store, body=MOST, log="off") as client:
        assert count(client, "ASK {}").status_code == 200
        assert refused(count(client, "#" * (MOST + 1))) == (413, "KG525")
        assert refused(client.post("/sparql?limit=1", content=b"ASK {} # \xff", headers=QUERY)) == (400, "KG520")
        assert refused(count(client, "ASK {", Host="elsewhere.example")) == (421, "KG527")
        assert refused(count(client, "ASK {}", Origin="https://elsewhere.example")) == (403, "KG528")
        assert refused(count(client, "ASK {")) == (400, "KG501")


def test_credentials_are_checked_each_time(store: Path, tmp_path: Path) -> None:
    """A token that was replaced is refused, although requests with the same head passed."""
    path = tmp_path / "token"
    path.write_text(TOKEN)
    with application(store, token_file=path, host="0.0.0.0", seconds=5, log="off") as client:  # noqa: S104 - not bound
        bearer = {"Authorization": f"Bearer {TOKEN}"}
        assert count(client, "ASK {}", **bearer).status_code == 200
        assert refused(count(client, "ASK {}")) == (401, "KG529")
        path.write_text(TOKEN[::-1])
        assert refused(count(client, "ASK {}", **bearer)) == (401, "KG529")
        assert refused(count(client, "ASK {}")) == (401, "KG529")


def test_whole_responses_are_the_same(store: Path) -> None:
    """A response sent in one piece has the headers of one sent in parts, on connections that stay and that end."""
    with served(store, log="off") as server, httpx.Client(base_url=server.address) as client:
        for text in ("ASK {}", "SELECT * { VALUES ?a { 1 2 } }", "nonsense"):
            kept = client.get("/sparql", params={"query": text})
            closing = httpx.get(f"{server.address}/sparql", params={"query": text}, headers={"Connection": "close"})
            head = client.head("/sparql", params={"query": text})
            varying = {"server-timing", "date"}
            first, second, third = (
                {name: value for name, value in one.headers.items() if name not in varying}
                for one in (kept, closing, head)
            )
            assert second.pop("connection") == "close"
            assert first == second == third
            assert kept.content == closing.content
            assert "date" in kept.headers
            assert {name.decode() for name in HEADERS} <= first.keys()


@pytest.mark.parametrize(
    "pair",
    [(b"connection", b"close"), (b"x-frame-options", b"SAMEORIGIN"), (b"x-kg-rows", b"1\r\nset-cookie: a=b")],
)
def test_unusual_responses_are_sent_in_parts(pair: tuple[bytes, bytes]) -> None:
    """So are those that close the connection, that set a security header, or that would break the header."""
    usual = [(b"content-type", b"text/csv"), (b"content-length", b"1")]
    assert lines_of(usual) is not None
    assert lines_of([*usual, pair]) is None
    assert lines_of(usual[:1]) is None
