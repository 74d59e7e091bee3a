"""What a crowd of clients does to a server: runaway queries, half-open connections.

Each case prints how many cheap requests were refused, which is to be none, and how long they took.
"""

from __future__ import annotations

import http.client
import json
import socket
import time
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any, Final

import servers
from flood import DEADLINE, DISGUISED, NEW_CHEAP, PRODUCT
from measuring import figures, run_clients

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["measure_crowd"]

RUNAWAYS: Final = 70
HALF_OPEN: Final = 300
QUICK_END: Final = 0.3
"""The deadline of the queries of a flood of which each ends soon and costs a process."""


def measure_crowd(store: Path, seconds: float) -> None:
    """Measure the cases for so many seconds each."""
    print(f"{'case':52} {'answers':>8} {'not 200':>8} {'median ms':>10} {'p99 ms':>8} {'longest':>8}")
    _print(f"new cheap ASKs beside {RUNAWAYS} runaway queries", _flooded(store, seconds, RUNAWAYS, PRODUCT))
    short = {"path": f"/sparql?timeout={QUICK_END}"}
    what = f"new cheap ASKs beside 16 clients that end after {QUICK_END} s"
    _print(what, _flooded(store, seconds, 16, DISGUISED, **short))
    for name, held in (("/health alone", 0), (f"/health beside {HALF_OPEN} half-open connections", HALF_OPEN)):
        with servers.kg(store) as served:
            _print(name, _half_open(served.port, held, seconds))
    with servers.kg(store, "--timeout", f"{DEADLINE:g}") as served, ThreadPoolExecutor() as threads:
        flood = threads.submit(run_clients, _plan(served.port, [PRODUCT], RUNAWAYS, seconds))
        _print(f"/health beside {RUNAWAYS} runaway queries", _health(served.port, seconds))
        flood.result()


def _plan(port: int, queries: list[str], connections: int, seconds: float) -> dict[str, Any]:
    return {
        "port": port,
        "path": "/sparql",
        "queries": queries,
        "connections": connections,
        "seconds": seconds,
        "distinct": True,
    }


def _flooded(store: Path, seconds: float, clients: int, flood: str, **changed: str) -> dict[str, Any]:
    """Ask new cheap queries from the moment that a flood begins."""
    with servers.kg(store, "--cache", "1", "--timeout", f"{DEADLINE:g}") as served, ThreadPoolExecutor() as threads:
        run_clients(_plan(served.port, [NEW_CHEAP], 1, 1.0))
        flooding = threads.submit(run_clients, {**_plan(served.port, [flood], clients, seconds), **changed})
        asked = run_clients(_plan(served.port, [NEW_CHEAP], 1, seconds))
        flooding.result()
        return asked


def _half_open(port: int, count: int, seconds: float) -> dict[str, Any]:
    """Ask for /health while clients hold connections on which a request has begun."""
    held = []
    for _ in range(count):
        held.append(socket.create_connection(("127.0.0.1", port), timeout=5))
        held[-1].sendall(b"GET / HTTP/1.1\r\nHost: localhost\r\n")
    try:
        return _health(port, seconds)
    finally:
        for one in held:
            one.close()


def _health(port: int, seconds: float) -> dict[str, Any]:
    """Ask for /health, each time on a new connection, as those do who watch a server."""
    times: list[float] = []
    statuses: dict[str, int] = {}
    began = time.perf_counter()
    while (asked := time.perf_counter()) < began + seconds:
        status = _status(port)
        times.append(time.perf_counter() - asked)
        statuses[status] = statuses.get(status, 0) + 1
        time.sleep(0.05)
    result = {"seconds": times, "statuses": statuses, "bytes": 0}
    return {"elapsed": time.perf_counter() - began, "results": [result]}


def _status(port: int) -> str:
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=10)
    try:
        connection.request("GET", "/health")
        return str(connection.getresponse().status)
    except OSError as error:
        return type(error).__name__
    finally:
        connection.close()


def _print(name: str, measured: dict[str, Any]) -> None:
    found = figures([measured])
    count = sum(len(result["seconds"]) for result in measured["results"])
    print(f"{name:52} {count:8} {found.bad:8} {found.median:10.1f} {found.p99:8.1f} {found.longest:8.1f}")
    others = {status: n for one in measured["results"] for status, n in one["statuses"].items() if status != "200"}
    if others:
        print(f"{'':52} {json.dumps(others)}")
