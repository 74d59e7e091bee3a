"""What a flood of queries that never end does to a cheap one.

The cheap one is timed alone and beside each kind of flood, and beside programs that only keep the processors busy and
give way as slow queries do: what these cost is the system's. The kinds take turns, so that they suffer the same from
whatever else the machine does.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from measuring import figures, quantile, run_clients
from servers import kg

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

__all__ = ["measure_flood"]

CHEAP: Final = "ASK { ?s a <https://w3id.org/rnkg/ns#Node> }"
NEW_CHEAP: Final = "ASK { ?NEW a <https://w3id.org/rnkg/ns#Node> }"
PRODUCT: Final = "SELECT (COUNT(*) AS ?n) { ?a ?b ?c . ?d ?e ?f . ?g ?h ?NEW }"
DISGUISED: Final = (
    "SELECT (COUNT(*) AS ?n) { "
    + " . ".join(f"?{one} !<https://w3id.org/rnkg/ns#none> ?{other}" for one, other in ("ab", "cb", "cd", "ed", "ef"))
    + " . ?NEW !<https://w3id.org/rnkg/ns#none> ?f }"
)
"""Each of its patterns hangs together with the next and has an IRI, and it does not end either."""
_LOOP: Final = """
import os, sys
from pathlib import Path

os.nice(int(sys.argv[1]))
group = Path("/proc/self/autogroup")
if group.exists():
    group.write_text(sys.argv[1])
while True:
    pass
"""
DEADLINE: Final = 5.0
"""Seconds that the server lets a query run."""
WARM: Final = 2.0
"""Seconds that the cheap query is asked for before it counts."""
NICENESS: Final = 10
"""How much busy loops give way, as readers of slow queries do."""


class _Kind(NamedTuple):
    """`name` says what `flood` asks, `distinct` whether each time another text; `cheap` is what is timed.

    `loops` is how many busy loops run beside, for each processor.
    """

    name: str
    flood: str
    distinct: bool
    cheap: str
    loops: int = 0


class _Run(NamedTuple):
    """What the client with the cheap query measured, and those of the flood."""

    cheap: dict[str, Any]
    flood: dict[str, Any]


KINDS: Final = (
    _Kind("alone", "", distinct=False, cheap=CHEAP),
    _Kind("alone, ever new", "", distinct=False, cheap=NEW_CHEAP),
    _Kind("alone, busy loops", "", distinct=False, cheap=CHEAP, loops=1),
    _Kind("one product", PRODUCT, distinct=False, cheap=CHEAP),
    _Kind("ever new products", PRODUCT, distinct=True, cheap=CHEAP),
    _Kind("ever new products, ever new", PRODUCT, distinct=True, cheap=NEW_CHEAP),
    _Kind("ever new chains, ever new", DISGUISED, distinct=True, cheap=NEW_CHEAP),
)


def measure_flood(store: Path, clients: int, seconds: float, rounds: int) -> None:
    """Time the cheap query for so many seconds in each kind and round, with so many flooding clients; print it all.

    The answers of `kg` are not kept, so that each is made.
    """
    asked: dict[str, list[_Run]] = {kind.name: [] for kind in KINDS}
    for _ in range(rounds):
        for kind in KINDS:
            with kg(store, "--cache", "1", "--timeout", f"{DEADLINE:g}") as served:
                asked[kind.name].append(_measure(kind, served.port, clients, seconds))
    print(f"a cheap query, while {clients} clients ask others that never end (ended after {DEADLINE:g} s each)")
    heads = ("answers/s", "median ms", "p99 ms", "ratio", "longest", "not 200", "late ms")
    print(f"{'flood':28}" + "".join(f"{head:>10}" for head in heads))
    base = figures([run.cheap for run in asked[KINDS[0].name]]).p99
    for name, runs in asked.items():
        rate, median, p99, longest, bad = figures([run.cheap for run in runs])
        late = _lateness([run.flood for run in runs if run.flood])
        shown = (rate, median, p99, p99 / base, longest, bad, late)
        print(f"{name:28}" + "".join(f"{figure:10.4g}" for figure in shown))


def _measure(kind: _Kind, port: int, clients: int, seconds: float) -> _Run:
    """Ask the cheap query for so long, beside the flood."""
    plan = {"port": port, "path": "/sparql", "queries": [kind.cheap], "connections": 1, "distinct": True}
    if not kind.flood:
        with _busy(kind.loops * (os.cpu_count() or 1)):
            return _Run(run_clients({**plan, "seconds": seconds}, WARM), {})
    flooding = {**plan, "queries": [kind.flood], "connections": clients, "distinct": kind.distinct}
    with ThreadPoolExecutor() as threads:
        flood = threads.submit(run_clients, {**flooding, "seconds": DEADLINE + WARM + seconds})
        time.sleep(DEADLINE)
        return _Run(run_clients({**plan, "seconds": seconds}, WARM), flood.result())


@contextmanager
def _busy(loops: int) -> Iterator[None]:
    """Keep processors busy, each from a session of its own, as readers are."""
    running = [
        subprocess.Popen([sys.executable, "-c", _LOOP, str(NICENESS)], start_new_session=True) for _ in range(loops)
    ]
    try:
        yield
    finally:
        for one in running:
            one.kill()
            one.wait()


def _lateness(runs: list[dict[str, Any]]) -> float:
    """Return by how many milliseconds the p99 of the queries that never end is behind their deadline."""
    times = [second for run in runs for result in run["results"] for second in result["seconds"]]
    return (quantile(times, 0.99) - DEADLINE) * 1000
