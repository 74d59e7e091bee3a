"""Tests of stopping gracefully, C29, and of what a server survives."""

from __future__ import annotations

import os
import signal
import socket
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import httpx
import pytest
from patience import patient
from serving import UNASKED, Serving, served

if TYPE_CHECKING:
    from collections.abc import Callable

RUNAWAY = "SELECT (COUNT(*) AS ?n) { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i . ?j ?k ?l }"


def asked(server: Serving, text: str) -> tuple[threading.Thread, list[Any]]:
    """Ask a query in a thread; the list gets its answer, or what went wrong."""
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
    """Return how a server says that it is."""
    return httpx.get(server.address + "/health", timeout=patient(20))


def refuses(server: Serving) -> bool:
    """Tell whether a server takes no new connection: it has begun to stop."""
    try:
        socket.create_connection(("127.0.0.1", server.port), timeout=patient(5)).close()
    except ConnectionError:
        return True
    return False


def until(holds: Callable[[], bool], seconds: float = 20) -> None:
    """Wait until something holds."""
    end = time.monotonic() + patient(seconds)
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.02)


def children(server: Serving) -> list[int]:
    """Return the processes that a server started and that live."""
    return children_of(server.process.pid)


def children_of(process: int) -> list[int]:
    """Return the processes that a process started and that live."""
    found = Path(f"/proc/{process}/task/{process}/children")
    if not found.exists():
        pytest.skip("there is no /proc to see processes in")
    return [int(child) for child in found.read_text().split()]


def works(server: Serving) -> bool:
    """Tell whether a reader has been at work for longer than it takes to begin."""
    readers = [reader for child in children(server) for reader in children_of(child)]
    return any(worked(reader) >= 0.3 for reader in readers)


def worked(process: int) -> float:
    """Return how many seconds a process has worked, 0 when it has ended."""
    try:
        fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return 0.0
    return int(fields[11]) / os.sysconf("SC_CLK_TCK")


def lives(identity: int) -> bool:
    """Tell whether a process is there and not just waiting to be noticed as ended."""
    try:
        return Path(f"/proc/{identity}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def test_what_runs_is_finished(store: Path) -> None:
    """Told to stop, a server takes nothing new, answers what runs with a whole body, and ends with exit code 0."""
    text = (
        "SELECT (COUNT(*) AS ?n) { {SELECT * {?a ?b ?c} LIMIT 800} {SELECT * {?d ?e ?f} LIMIT 800} "
        "FILTER(CONTAINS(STR(?c), STR(?f))) }"
    )
    with served(store, log="off", grace=patient(30)) as server:
        thread, answers = asked(server, text)
        readers = children(server)
        server.process.send_signal(signal.SIGTERM)
        until(lambda: refuses(server))
        thread.join()
        assert server.process.wait(patient(30)) == 0
        assert answers[0].status_code == 200
        assert answers[0].json()["results"]["bindings"]
        until(lambda: not any(map(lives, readers)))


def test_what_outlives_its_grace_is_ended(store: Path) -> None:
    """A query that does not end is ended when the grace is over: its client is told, its reader killed."""
    with served(store, log="off", grace=0.5) as server:
        thread, answers = asked(server, RUNAWAY)
        readers = children(server)
        began = time.monotonic()
        code, _ = server.stop()
        assert code == 0
        assert time.monotonic() - began < patient(2.5)
        thread.join()
        assert (answers[0].status_code, answers[0].json()["code"]) == (503, "KG510")
        until(lambda: not any(map(lives, readers)))


@pytest.mark.parametrize("again", [signal.SIGTERM, signal.SIGINT])
def test_told_twice_it_stops_now(store: Path, again: signal.Signals) -> None:
    """A second signal does not wait for the grace."""
    with served(store, log="off", grace=60) as server:
        thread, _ = asked(server, RUNAWAY)
        readers = children(server)
        server.process.send_signal(signal.SIGTERM)
        # Two signals of a kind that come before the first is seen are one.
        until(lambda: refuses(server))
        began = time.monotonic()
        server.process.send_signal(again)
        assert server.process.wait(patient(20)) == 0
        assert time.monotonic() - began < patient(2.5)
        thread.join()
        until(lambda: not any(map(lives, readers)))


def test_idle_it_stops_at_once(store: Path) -> None:
    """Without work, Ctrl-C ends a server within moments, also with a connection open and nothing said on it."""
    with served(store, log="off", grace=60) as server:
        idle = socket.create_connection(("127.0.0.1", server.port))
        server.process.send_signal(signal.SIGINT)
        assert server.process.wait(patient(10)) == 0
        idle.close()


def test_a_closed_terminal_stops_gracefully(store: Path) -> None:
    """SIGHUP stops a server as SIGTERM does; it comes twice, from the kernel and the shell, and that is no hurry."""
    with served(store, log="off", grace=1.5) as server:
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
    """Started with nohup, a server goes on when its terminal is closed."""
    before = "import signal; signal.signal(signal.SIGHUP, signal.SIG_IGN)"
    with served(store, before=before, log="off") as server:
        server.process.send_signal(signal.SIGHUP)
        time.sleep(0.5)
        assert health(server).status_code == 200
        assert server.stop()[0] == 0


def test_readers_end_with_a_server_that_is_killed(store: Path) -> None:
    """Not even SIGKILL of the server leaves a reader that waits."""
    with served(store, log="off") as server:
        httpx.get(server.address + "/sparql", params={"query": "ASK{}"}, timeout=patient(30))
        readers = children(server)
        assert readers
        server.process.kill()
        server.process.wait()
        until(lambda: not any(map(lives, readers)))


def test_systemd_is_told(store: Path, tmp_path: Path) -> None:
    """Under systemd a server says when it is ready, and when it stops."""
    address = tmp_path / "notify"
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as listening:
        listening.bind(str(address))
        listening.settimeout(patient(20))
        with served(store, log="off", environment={"NOTIFY_SOCKET": str(address)}) as server:
            assert listening.recv(100) == b"READY=1"
            server.stop()
            assert listening.recv(100) == b"STOPPING=1"


def test_a_reader_that_is_killed_costs_one_answer(store: Path) -> None:
    """A reader that ends under a query is an error for this query, and the next is answered."""
    with served(store, before=UNASKED, log="off", readers=1) as server:
        thread, answers = asked(server, RUNAWAY)
        # A reader that is only about to begin would be replaced, and the query begun anew.
        until(lambda: works(server))
        for reader in children(server):
            os.kill(reader, signal.SIGKILL)
        thread.join()
        assert (answers[0].status_code, answers[0].json()["code"]) == (503, "KG508")
        assert httpx.get(server.address + "/sparql", params={"query": "ASK{}"}, timeout=patient(30)).status_code == 200
        assert server.stop()[0] == 0
