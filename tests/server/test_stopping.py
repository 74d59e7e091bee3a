"""Tests of graceful stopping, C29, and of failures that a server survives."""

from __future__ import annotations

import os
import signal
import socket
import threading
import time
from pathlib import Path
from typing import Any

import httpx
import pytest
from patience import patient, until
from serving import Serving, served

RUNAWAY = "SELECT (COUNT(*) AS ?n) { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i . ?j ?k ?l }"


def asked(server: Serving, text: str) -> tuple[threading.Thread, list[Any]]:
    """Send a query in a thread; the list receives its response, or the error."""
    answers: list[Any] = []

    def ask() -> None:
        try:
            answers.append(httpx.get(server.address + "/sparql", params={"query": text}, timeout=patient(60)))
        except httpx.HTTPError as error:
            answers.append(error)

    thread = threading.Thread(target=ask)
    thread.start()
    until(lambda: bool(answers) or health(server).json()["running"] > 0)
    return thread, answers


def health(server: Serving) -> httpx.Response:
    """Return the health status of a server."""
    return httpx.get(server.address + "/health", timeout=patient(20))


def refuses(server: Serving) -> bool:
    """Whether a server rejects new connections: it has begun to stop."""
    try:
        socket.create_connection(("127.0.0.1", server.port), timeout=patient(5)).close()
    except ConnectionError:
        return True
    return False


def children(server: Serving) -> list[int]:
    """Return the live child processes of a server."""
    return children_of(server.process.pid)


def children_of(process: int) -> list[int]:
    """Return the live child processes of a process."""
    found = Path(f"/proc/{process}/task/{process}/children")
    if not found.exists():
        pytest.skip("there is no /proc to see processes in")
    return [int(child) for child in found.read_text().split()]


def works(server: Serving) -> bool:
    """Whether a reader has used more processor time than starting takes."""
    readers = [reader for child in children(server) for reader in children_of(child)]
    return any(worked(reader) >= 0.3 for reader in readers)


def worked(process: int) -> float:
    """Return the processor seconds of a process, 0 if it has exited."""
    try:
        fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return 0.0
    return int(fields[11]) / os.sysconf("SC_CLK_TCK")


def lives(identity: int) -> bool:
    """Whether a process exists and is not a zombie."""
    try:
        return Path(f"/proc/{identity}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def test_what_runs_is_finished(store: Path) -> None:
    """A stopping server rejects new requests, completes running ones, and exits with 0."""
    text = (
        "SELECT (COUNT(*) AS ?n) { {SELECT * {?a ?b ?c} LIMIT 800} {SELECT * {?d ?e ?f} LIMIT 800} "
        "FILTER(CONTAINS(STR(?c), STR(?f))) }"
    )
    with served(store, forks_readers=False, log="off", grace=patient(30)) as server:
        thread, answers = asked(server, text)
        readers = children(server)
        assert readers
        server.process.send_signal(signal.SIGTERM)
        until(lambda: refuses(server))
        thread.join()
        assert server.process.wait(patient(30)) == 0
        assert answers[0].status_code == 200
        assert answers[0].json()["results"]["bindings"]
        until(lambda: not any(map(lives, readers)))


def test_what_outlives_its_grace_is_ended(store: Path) -> None:
    """A query running past the grace period is ended: its client gets an error, its reader is killed."""
    with served(store, forks_readers=False, log="off", grace=0.5) as server:
        thread, answers = asked(server, RUNAWAY)
        readers = children(server)
        assert readers
        began = time.monotonic()
        code, _ = server.stop()
        assert code == 0
        assert time.monotonic() - began < patient(2.5)
        thread.join()
        assert (answers[0].status_code, answers[0].json()["code"]) == (503, "KG510")
        until(lambda: not any(map(lives, readers)))


@pytest.mark.parametrize("again", [signal.SIGTERM, signal.SIGINT])
def test_told_twice_it_stops_now(store: Path, again: signal.Signals) -> None:
    """A second signal skips the grace period."""
    with served(store, forks_readers=False, log="off", grace=60) as server:
        thread, _ = asked(server, RUNAWAY)
        readers = children(server)
        assert readers
        server.process.send_signal(signal.SIGTERM)
        # Two signals of a kind sent before the first is delivered count as one.
        until(lambda: refuses(server))
        began = time.monotonic()
        server.process.send_signal(again)
        assert server.process.wait(patient(20)) == 0
        assert time.monotonic() - began < patient(2.5)
        thread.join()
        until(lambda: not any(map(lives, readers)))


def test_idle_it_stops_at_once(store: Path) -> None:
    """Without work, Ctrl-C ends a server within moments, even with an idle open connection."""
    with served(store, forks_readers=False, log="off", grace=60) as server:
        idle = socket.create_connection(("127.0.0.1", server.port))
        server.process.send_signal(signal.SIGINT)
        assert server.process.wait(patient(10)) == 0
        idle.close()


def test_a_closed_terminal_stops_gracefully(store: Path) -> None:
    """SIGHUP stops a server like SIGTERM; the second one, from kernel and shell, does not skip the grace period."""
    with served(store, forks_readers=False, log="off", grace=1.5) as server:
        thread, answers = asked(server, RUNAWAY)
        began = time.monotonic()
        for _ in range(2):
            server.process.send_signal(signal.SIGHUP)
            until(lambda: refuses(server))
        assert server.process.wait(patient(30)) == 0
        assert time.monotonic() - began >= 1.5
        thread.join()
        assert (answers[0].status_code, answers[0].json()["code"]) == (503, "KG510")


def test_a_server_outlives_its_terminal_where_it_is_to(store: Path) -> None:
    """With nohup, a server continues when its terminal is closed."""
    before = "import signal; signal.signal(signal.SIGHUP, signal.SIG_IGN)"
    with served(store, forks_readers=False, before=before, log="off") as server:
        server.process.send_signal(signal.SIGHUP)
        time.sleep(0.5)
        assert health(server).status_code == 200
        assert server.stop()[0] == 0


def test_readers_end_with_a_server_that_is_killed(store: Path) -> None:
    """Even SIGKILL of the server leaves no waiting reader."""
    with served(store, forks_readers=False, log="off") as server:
        httpx.get(server.address + "/sparql", params={"query": "ASK{}"}, timeout=patient(30))
        readers = children(server)
        assert readers
        server.process.kill()
        server.process.wait()
        until(lambda: not any(map(lives, readers)))


def test_systemd_is_told(store: Path, tmp_path: Path) -> None:
    """Under systemd a server reports when it is ready, and when it stops."""
    address = tmp_path / "notify"
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as listening:
        listening.bind(str(address))
        listening.settimeout(patient(20))
        with served(store, forks_readers=False, log="off", environment={"NOTIFY_SOCKET": str(address)}) as server:
            assert listening.recv(100) == b"READY=1"
            server.stop()
            assert listening.recv(100) == b"STOPPING=1"


def test_a_reader_that_is_killed_costs_one_answer(store: Path) -> None:
    """If a reader is killed, its query gets an error, and the next is answered."""
    with served(store, forks_readers=False, log="off", readers=1) as server:
        thread, answers = asked(server, RUNAWAY)
        # A reader that is only starting would be replaced, and the query restarted.
        until(lambda: works(server))
        for reader in children(server):
            os.kill(reader, signal.SIGKILL)
        thread.join()
        assert (answers[0].status_code, answers[0].json()["code"]) == (503, "KG508")
        assert httpx.get(server.address + "/sparql", params={"query": "ASK{}"}, timeout=patient(30)).status_code == 200
        assert server.stop()[0] == 0
