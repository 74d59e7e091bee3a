"""What single kinds of requests cost: answers a second, and processor time of the server by answer.

Each kind is asked of `kg serve` and of Oxigraph's server in turn, some rounds, on one connection and on many. Of each
server the best round counts, which what else the machine did disturbed least.
"""

from __future__ import annotations

import random
import time
from itertools import islice
from typing import TYPE_CHECKING, Final, NamedTuple

import pyoxigraph
import servers
from measuring import figures, run_clients

from kg.store.layout import Layout

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from servers import Served

__all__ = ["measure_requests"]

MANY: Final = 32
SUBJECTS: Final = 500
SEED: Final = 7
ROUNDS: Final = 3
WARM_SECONDS: Final = 6.0
"""A server that starts prepares things that are not for requests, for some seconds."""
AGGREGATE_SECONDS: Final = 0.05


class _Kind(NamedTuple):
    """Requests of one kind; `distinct`: each is a text of its own, so that no kept answer helps."""

    name: str
    queries: Sequence[str]
    distinct: bool
    connections: int


def measure_requests(store: Path, oxigraph: Path, seconds: float) -> None:
    """Print the figures of each kind; `oxigraph` is a copy of the store for Oxigraph's server."""
    opened = _opened(store)
    subjects = _subjects(opened)
    look_ups = [f"SELECT ?p ?o WHERE {{ {subject} ?p ?o }} LIMIT 10" for subject in subjects]
    asks = [f"ASK {{ {subject} a ?type }}" for subject in subjects]
    aggregate = [_aggregate(opened)]
    del opened
    kinds = [
        _Kind(f"{name}, {connections} connections", queries, distinct, connections)
        for name, queries, distinct in (("look-up", look_ups, True), ("ASK", asks, True), ("kept", look_ups[:1], False))
        for connections in (1, MANY)
    ]
    kinds.append(_Kind(f"aggregate, {MANY} connections", aggregate, True, MANY))
    each = seconds / len(kinds) / ROUNDS / 2
    print(f"{'kind':28} {'server':9} {'answers/s':>10} {'ratio':>6} {'ms of CPU':>10} {'ratio':>6} {'not 200':>8}")
    with servers.oxigraph(oxigraph) as theirs, servers.kg(store) as ours:
        time.sleep(WARM_SECONDS)
        for kind in kinds:
            _print(kind.name, _measure(kind, {"oxigraph": theirs, "kg": ours}, each))


def _measure(kind: _Kind, served: dict[str, Served], seconds: float) -> dict[str, tuple[float, float, int]]:
    """Return answers a second, processor milliseconds by answer and refused requests of each server."""
    runs: dict[str, list[tuple[float, float, int]]] = {name: [] for name in served}
    for _ in range(ROUNDS):
        for name, server in served.items():
            plan = {
                "port": server.port,
                "path": "/query" if name == "oxigraph" else "/sparql",
                "queries": kind.queries,
                "connections": kind.connections,
                "seconds": seconds,
                "distinct": kind.distinct,
            }
            before = server.processor()
            measured = run_clients(plan)
            time.sleep(0.2)
            shown, used = figures([measured]), server.processor() - before
            runs[name].append((shown.rate, used / sum(len(one["seconds"]) for one in measured["results"]), shown.bad))
    return {
        name: (max(rates), min(costs) * 1000, sum(refused))
        for name, found in runs.items()
        for rates, costs, refused in [zip(*found, strict=True)]
    }


def _print(kind: str, measured: dict[str, tuple[float, float, int]]) -> None:
    rate, cost, _ = measured["oxigraph"]
    for name, (one_rate, one_cost, bad) in measured.items():
        ratios = f"{one_rate:10.1f} {one_rate / rate:6.2f} {one_cost:10.3f} {one_cost / cost:6.2f}"
        print(f"{kind:28} {name:9} {ratios} {bad:8}", flush=True)


def _opened(store: Path) -> pyoxigraph.Store:
    layout = Layout(store)
    return pyoxigraph.Store.read_only(str(layout.generation(layout.current() or 0)))


def _subjects(opened: pyoxigraph.Store) -> list[str]:
    """Return IRIs that are the subject of a quad, in an order without sense, the same each time."""
    found = {str(quad.subject) for quad in islice(opened, 200_000) if isinstance(quad.subject, pyoxigraph.NamedNode)}
    return random.Random(SEED).sample(sorted(found), min(SUBJECTS, len(found)))  # noqa: S311 - no secret


def _aggregate(opened: pyoxigraph.Store) -> str:
    """Return an aggregate that takes the engine alone about 50 ms."""
    rows = 100
    while _seconds(opened, rows) < AGGREGATE_SECONDS:
        rows = rows * 5 // 4
    return _product(rows)


def _product(rows: int) -> str:
    parts = (f"{{ SELECT ?{one} {{ ?{one} ?{two} ?{three} }} LIMIT {rows} }}" for one, two, three in ("abc", "def"))
    return f"SELECT ?a (COUNT(*) AS ?n) {{ {' '.join(parts)} }} GROUP BY ?a"


def _seconds(opened: pyoxigraph.Store, rows: int) -> float:
    """Return the shortest of three times that the engine takes."""
    times = []
    for _ in range(3):
        began = time.perf_counter()
        answer = opened.query(_product(rows), use_default_graph_as_union=True)
        assert isinstance(answer, pyoxigraph.QuerySolutions)  # noqa: S101 - a SELECT
        sum(1 for _ in answer)
        times.append(time.perf_counter() - began)
    return min(times)
