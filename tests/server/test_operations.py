"""Tests of health, metrics and logs: C34."""

from __future__ import annotations

import json
import logging
import re
import time
from typing import TYPE_CHECKING

import httpx
from patience import patient
from serving import TOKEN, application, served
from starlette.routing import Route
from workspaces import copied

from kg.query.readers.answers import Job
from kg.query.readers.messages import Question, frame

if TYPE_CHECKING:
    from pathlib import Path

    import pytest
    from starlette.testclient import TestClient

    from kg.query.readers.pool import Readers

QUERY = "SELECT ?secretvariable { ?secretvariable ?p ?o } LIMIT 3"


def figure(client: TestClient, name: str) -> float:
    """Return a value of the metrics, 0 if it is missing."""
    found = re.search(rf"^{re.escape(name)} (\S+)$", client.get("/metrics").text, re.MULTILINE)
    return float(found[1]) if found else 0.0


def test_health(client: TestClient) -> None:
    """A server with a readable store is healthy, and reports its snapshot and its readers."""
    answer = client.get("/health")
    assert answer.status_code == 200
    members = answer.json()
    assert members.pop("age") >= 0
    assert members == {"status": "ok", "snapshot": "1", "readers": 2, "running": 0, "waiting": 0}
    assert answer.headers["cache-control"] == "no-store"


def test_what_is_done_unasked_is_no_request_that_runs(store: Path) -> None:
    """The metrics count requests of clients, not the background work of the server."""
    with application(store, log="off") as client:
        jobs = client.app.state.server.readers.jobs  # type: ignore[attr-defined]  # it is Starlette
        jobs["own"] = Job("own", "prepare", own=True)
        assert client.get("/health").json()["running"] == 0
        jobs["other"] = Job("other", QUERY)
        assert client.get("/health").json()["running"] == 1


def test_a_store_that_is_gone(store: Path, tmp_path: Path) -> None:
    """Without its store a server stays alive and reports the problem."""
    copy = tmp_path / ".kg"
    copied(store, copy)
    with application(copy, log="off") as client:
        assert client.get("/health").status_code == 200
        copy.rename(tmp_path / "gone")
        answer = client.get("/health")
        assert (answer.status_code, answer.json()["code"]) == (503, "KG301")
        assert client.get("/metrics").status_code == 200
        assert client.get("/sparql", params={"query": "ASK{}"}).status_code in {200, 503}


def test_a_pointer_that_is_damaged(store: Path, tmp_path: Path) -> None:
    """An unreadable store is 503, without a path of this machine."""
    copy = tmp_path / ".kg"
    copied(store, copy)
    with application(copy, log="off") as client:
        (copy / "current").write_text("nonsense")
        answer = client.get("/health")
        assert (answer.status_code, answer.json()["code"]) == (503, "KG303")


def test_metrics_count_queries(client: TestClient) -> None:
    """Queries are counted by outcome, with their rows and seconds."""
    before = {name: figure(client, name) for name in ('kg_queries_total{outcome="ok"}', "kg_query_rows_total")}
    refused = figure(client, 'kg_queries_total{outcome="KG501"}')
    assert client.get("/sparql", params={"query": QUERY}).status_code == 200
    assert client.get("/sparql", params={"query": "nonsense"}).status_code == 400
    assert figure(client, 'kg_queries_total{outcome="ok"}') == before['kg_queries_total{outcome="ok"}'] + 1
    assert figure(client, "kg_query_rows_total") == before["kg_query_rows_total"] + 3
    assert figure(client, 'kg_queries_total{outcome="KG501"}') == refused + 1
    assert figure(client, "kg_query_seconds_count") > 0
    assert figure(client, "kg_snapshot") == 1


def test_look_ups_are_counted_and_kept(store: Path) -> None:
    """A query answered without a reader is counted as any other, and its repetition as a cache hit."""
    with application(store, log="off") as client:
        readers: Readers = client.app.state.server.readers  # type: ignore[attr-defined]  # it is Starlette
        asked = Question(text="ASK { ?s ?p ?o }", formats={"boolean": "json"})
        assert client.portal is not None
        until = time.monotonic() + patient(20)
        while client.portal.call(readers.look_up, asked, frame(asked)) is None:
            assert time.monotonic() < until
        rows, kept = figure(client, "kg_query_rows_total"), figure(client, "kg_cache_hits_total")
        answers = [client.get("/sparql", params={"query": QUERY}) for _ in range(2)]
        assert answers[0].headers.keys() == answers[1].headers.keys()
        assert answers[0].headers["x-kg-rows"] == "3"
        assert answers[0].content == answers[1].content
        assert figure(client, "kg_query_rows_total") - rows == 6
        assert figure(client, "kg_cache_hits_total") - kept == 1


def test_metrics_are_prometheus_text(client: TestClient) -> None:
    """The format is that of Prometheus, and unknown methods share one label."""
    client.request("FROBNICATE", "/health")
    answer = client.get("/metrics")
    assert answer.headers["content-type"].startswith("text/plain; version=")
    assert 'kg_requests_total{method="other",status="405"}' in answer.text
    assert "FROBNICATE" not in answer.text


def test_servers_count_for_themselves(store: Path, client: TestClient) -> None:
    """Servers in the same process have separate metrics."""
    client.get("/sparql", params={"query": QUERY})
    with application(store, log="off") as other:
        assert figure(other, 'kg_queries_total{outcome="ok"}') == 0


def test_one_line_for_each_request(store: Path) -> None:
    """The log has time, path, status, rows and a digest, but no query, no token, and standard output is empty."""
    with served(store, log="json", write=True, token=TOKEN) as server:
        headers = {"Authorization": f"Bearer {TOKEN}"}
        with httpx.Client(base_url=server.address, timeout=patient(30)) as client:
            for _ in range(2):
                client.get("/sparql", params={"query": QUERY, "token": TOKEN}, headers=headers)
            client.get("/no%0athing%1b[31m", headers=headers)
            client.post("/update", data={"update": "nonsense"})
        _, said = server.stop()
    lines = [json.loads(line) for line in said.splitlines()]
    assert [line["status"] for line in lines] == [200, 200, 404, 401]
    assert [line["outcome"] for line in lines] == ["ok", "ok", "KG521", "KG529"]
    assert lines[0]["rows"] == 3
    assert lines[0]["query"]
    assert lines[0]["query"] == lines[1]["query"]
    assert lines[0]["ms"] > 0
    assert lines[0]["bytes"] > 0
    assert TOKEN not in said
    assert "secretvariable" not in said


def test_lines_of_text(store: Path, caplog: pytest.LogCaptureFixture) -> None:
    """A log line of text is one line, whatever the address contains."""
    caplog.set_level(logging.INFO, "kg.server")
    with application(store) as client:
        client.get("/a%0Ab%1B[31m c")
    line = caplog.messages[-1]
    assert re.fullmatch(r"\S+Z testclient GET /a\\nb\\x1b\[31m c status=404 ms=\S+ bytes=\d+ outcome=KG521", line)


def test_slow_queries_are_told_whole(store: Path, tmp_path: Path) -> None:
    """The log of slow queries has the text, in the requested file, and only for slow ones."""
    file = tmp_path / "slow.jsonl"
    with application(store, log="off", slow=0.0, slow_log=file) as client:
        client.get("/sparql", params={"query": QUERY})
        client.get("/health")
    [line] = file.read_text().splitlines()
    members = json.loads(line)
    assert members["query"] == QUERY
    assert members["rows"] == 3
    with application(store, log="off", slow=60.0, slow_log=file) as client:
        client.get("/sparql", params={"query": QUERY})
    assert len(file.read_text().splitlines()) == 1


def test_a_log_that_cannot_be_written(store: Path, tmp_path: Path) -> None:
    """A full disk loses the log line, not the response."""
    with application(store, log="off", slow=0.0, slow_log=tmp_path / "none" / "slow") as client:
        assert client.get("/sparql", params={"query": QUERY}).status_code == 200


def test_a_defect_stands_in_the_log(store: Path, caplog: pytest.LogCaptureFixture) -> None:
    """The log has the details under the identity sent to the client."""

    async def broken(_request: object) -> None:
        raise ZeroDivisionError("what happened")

    with application(store, log="off") as client:
        client.app.router.routes.insert(0, Route("/broken", broken))  # type: ignore[attr-defined]  # it is Starlette
        identity = re.search(r"[0-9a-f]{16}", client.get("/broken").json()["message"])
    assert identity
    assert identity[0] in caplog.text
    assert "what happened" in caplog.text
