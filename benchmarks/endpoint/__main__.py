"""Compares `kg serve` with `oxigraph serve` under load: the same data, the same queries, the same clients.

    python benchmarks/endpoint STORE [--seconds 60] [--connections 8] [--flood 16] [--rounds 3]
        [--part load|flood|crowd|requests]

STORE is a folder `.kg`. Its quads are written as N-Quads and loaded into a store of Oxigraph. The queries are the first
20 stored ones of `queries/` that have no parameters. Each server is asked them by 8 clients for 60 seconds: `kg` once
as it is, and once without keeping answers and with a comment in each query that makes it a new text. Then a client with
a cheap query is timed alone, and while others ask queries that never end. Throughput is whole answers a second; the
servers and the clients share the machine. Then crowds of clients come: 70 with runaway queries, 300 half-open
connections. At the end single kinds of requests are compared with Oxigraph's server: throughput, and the processor time
of all processes of a server by answer.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import pyoxigraph
import servers
from crowd import measure_crowd
from flood import measure_flood
from measuring import figures, quantile, run_clients
from requesting import measure_requests

from kg.query import stored
from kg.store.layout import Layout
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from collections.abc import Sequence

QUERIES: Final = 20
WARM_SECONDS: Final = 5.0


def main() -> None:
    """Read the command line, measure, print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("store", type=Path, help="the folder .kg of a store")
    parser.add_argument("--seconds", type=float, default=60, help="how long each server is asked")
    parser.add_argument("--connections", type=int, default=8, help="how many clients ask at a time")
    parser.add_argument("--flood", type=int, default=16, help="how many clients ask queries that never end")
    parser.add_argument("--rounds", type=int, default=3, help="how often each kind of flood is measured, in turn")
    parser.add_argument("--part", choices=("load", "flood", "crowd", "requests"), help="measure this alone")
    options = parser.parse_args()
    if options.part in {None, "load"}:
        _measure_load(options)
    if options.part in {None, "flood"}:
        measure_flood(options.store, options.flood, options.seconds / options.rounds, options.rounds)
    if options.part in {None, "crowd"}:
        measure_crowd(options.store, options.seconds / 3)
    if options.part in {None, "requests"}:
        with tempfile.TemporaryDirectory(prefix="kg-benchmark-") as folder:
            _copied(options.store, Path(folder))
            measure_requests(options.store, Path(folder) / "oxigraph", options.seconds)


def _measure_load(options: argparse.Namespace) -> None:
    names, texts = _queries()
    plan = {"queries": texts, "connections": options.connections, "seconds": options.seconds, "distinct": False}
    warm = min(WARM_SECONDS, options.seconds / 3)
    measured = {}
    with tempfile.TemporaryDirectory(prefix="kg-benchmark-") as folder:
        quads = _copied(options.store, Path(folder))
        print(f"{quads:,} quads, {len(names)} queries, {options.connections} clients, {options.seconds:g} s each\n")
        with servers.oxigraph(Path(folder) / "oxigraph") as served:
            measured["oxigraph"] = run_clients({**plan, "port": served.port, "path": "/query"}, warm)
        for name, flags in (("kg", ()), ("kg, nothing kept", ("--cache", "1"))):
            with servers.kg(options.store, *flags) as served:
                kept = {**plan, "port": served.port, "path": "/sparql", "distinct": bool(flags)}
                measured[name] = run_clients(kept, warm)
    _print_load(names, measured)


def _queries() -> tuple[list[str], list[str]]:
    """Return names and texts of the queries, with the prefixes that `kg` knows and others do not."""
    found = [(name, query.text) for name, query in sorted(stored.discover().items()) if not query.parameters]
    names, texts = zip(*found[:QUERIES], strict=True)
    return list(names), [_with_prefixes(text) for text in texts]


def _with_prefixes(text: str) -> str:
    declared = {found.lower() for found in re.findall(r"(?i)\bPREFIX\s+([\w-]*):", text)}
    lines = [f"PREFIX {prefix}: <{iri}>" for prefix, iri in PREFIXES.items() if prefix.lower() not in declared]
    return "\n".join((*lines, text))


def _copied(store: Path, root: Path) -> int:
    """Load what the store holds into a store of Oxigraph below `root`; return how many quads that are."""
    layout = Layout(store)
    quads = root / "all.nq"
    opened = pyoxigraph.Store.read_only(str(layout.generation(layout.current() or 0)))
    opened.dump(str(quads), format=pyoxigraph.RdfFormat.N_QUADS)
    count = len(opened)
    command = ["oxigraph", "load", "--location", str(root / "oxigraph"), "--file", str(quads)]
    subprocess.run(command, check=True, stderr=subprocess.DEVNULL)
    return count


def _print_load(names: Sequence[str], measured: dict[str, dict[str, Any]]) -> None:
    base = figures([measured["oxigraph"]])
    print(f"{'server':18} {'answers/s':>10} {'ratio':>6} {'median ms':>10} {'p99 ms':>8} {'ratio':>6} {'not 200':>8}")
    for name, one in measured.items():
        rate, median, p99, _, bad = figures([one])
        print(f"{name:18} {rate:10.1f} {rate / base.rate:6.2f} {median:10.1f} {p99:8.1f} {p99 / base.p99:6.2f} {bad:8}")
    print(f"\n{'median ms of each query':40}" + "".join(f"{name:>18}" for name in measured))
    for number, query in enumerate(names):
        medians = (quantile(one["results"][number]["seconds"], 0.5) * 1000 for one in measured.values())
        print(f"{query:40}" + "".join(f"{median:18.1f}" for median in medians))
    print()


if __name__ == "__main__":
    main()
