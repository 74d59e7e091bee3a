"""Measures what it costs to ask through reader processes; `benchmarks/endpoint` has what floods do to others.

    python benchmarks/readers [--store FOLDER] [--rows 100000] [--asks 500]

Without a store one of 200,000 triples is made for the run. Prints a line a figure; times are medians unless they say
otherwise, terms are counted by rows times variables.
"""

from __future__ import annotations

import argparse
import asyncio
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING

import pyoxigraph
from pyoxigraph import NamedNode, QueryResultsFormat, RdfFormat

from kg.errors import KgError
from kg.query.core import run
from kg.query.formats import write_graph, write_rows
from kg.query.readers.messages import Question
from kg.query.readers.pool import Readers
from kg.store.embedded import EmbeddedStore
from kg.store.layout import Layout
from kg.store.snapshot import EmbeddedSnapshot

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Iterator

FORMATS = {"rows": "json", "boolean": "json", "graph": "turtle"}
ASK = "ASK { ?s ?p ?o }"
ROWS = "SELECT ?s ?p ?o { GRAPH ?g { ?s ?p ?o } }"
TRIPLES = "CONSTRUCT { ?s ?p ?o } { GRAPH ?g { ?s ?p ?o } }"
NEW_PYTHON = [sys.executable, "-c", "import kg.query.readers.forkserver"]


def main() -> None:
    """Read the command line, measure, print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--store", type=Path, help="folder of a store (.kg)")
    parser.add_argument("--rows", type=int, default=100_000, help="rows that are written in each format")
    parser.add_argument("--asks", type=int, default=500, help="how often a quick query is asked")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="kg-benchmark-") as folder:
        layout = Layout(options.store) if options.store else _store(Path(folder))
        with EmbeddedSnapshot(layout) as snapshot:
            _writing(snapshot, options.rows)
            within = _median(lambda: run(snapshot, ASK), options.asks)
            engine = _median(lambda: snapshot.query(ASK), options.asks)
        asyncio.run(_asking(layout, options.asks, within, engine))
        asyncio.run(_reading(layout, options.rows))


def _store(folder: Path) -> Layout:
    store = EmbeddedStore.create(folder / ".kg")
    with store.write("benchmark") as transaction:
        transaction.replace_graphs({NamedNode("https://example.org/g"): _things(50_000)})
    return store.layout


def _things(count: int) -> Iterator[bytes]:
    ex = "https://example.org/"
    for number in range(count):
        one = f"<{ex}thing/{number}>"
        yield (
            f'{one} <{ex}label> "thing {number}"@en .\n{one} <{ex}next> <{ex}thing/{number + 1}> .\n'
            f'{one} <{ex}text> "what is said of thing {number}, at some length" .\n'
            f'{one} <{ex}number> "{number}"^^<http://www.w3.org/2001/XMLSchema#integer> .\n'
        ).encode()


def _say(what: str, figure: str) -> None:
    print(f"{what:72} {figure}")


def _median(work: Callable[[], object], repeat: int) -> float:
    times = []
    for _ in range(repeat):
        began = time.perf_counter()
        work()
        times.append(time.perf_counter() - began)
    return statistics.median(times)


def _cpu(work: Callable[[], object]) -> float:
    """Return the processor time of the best of three."""
    times = []
    for _ in range(3):
        began = time.process_time()
        work()
        times.append(time.process_time() - began)
    return min(times)


def _writing(snapshot: EmbeddedSnapshot, rows: int) -> None:
    """Print how fast rows and triples are written, by us and by the engine."""
    text = f"{ROWS} LIMIT {rows}"

    def found() -> pyoxigraph.QuerySolutions:
        answer = snapshot.query(text)
        assert isinstance(answer, pyoxigraph.QuerySolutions)  # noqa: S101 - a SELECT
        return answer

    _say("finding rows alone, million terms a second", f"{rows * 3 / _cpu(lambda: sum(1 for _ in found())) / 1e6:.2f}")
    for name in ("json", "xml", "csv", "tsv"):
        chosen: QueryResultsFormat = getattr(QueryResultsFormat, name.upper())
        ours = _cpu(lambda name=name: write_rows(name, ("s", "p", "o"), map(tuple, found()), len))  # type: ignore[misc]  # a default binds the loop's value
        engines = _cpu(lambda chosen=chosen: found().serialize(format=chosen))  # type: ignore[misc]  # as above
        _say(
            f"rows found and written as {name}, million terms a second (the engine's)",
            f"{rows * 3 / ours / 1e6:.2f} ({rows * 3 / engines / 1e6:.2f})",
        )

    def triples() -> pyoxigraph.QueryTriples:
        answer = snapshot.query(f"{TRIPLES} LIMIT {rows}")
        assert isinstance(answer, pyoxigraph.QueryTriples)  # noqa: S101 - a CONSTRUCT
        return answer

    ours = _cpu(lambda: write_graph("ntriples", triples(), len))
    engines = _cpu(lambda: pyoxigraph.serialize(triples(), format=RdfFormat.N_TRIPLES))
    _say(
        "triples found and written as ntriples, million terms a second (the engine's)",
        f"{rows * 3 / ours / 1e6:.2f} ({rows * 3 / engines / 1e6:.2f})",
    )


async def _timed(work: Callable[[], Awaitable[object]], repeat: int) -> list[float]:
    times = []
    for _ in range(repeat):
        began = time.perf_counter()
        await work()
        times.append(time.perf_counter() - began)
    return times


async def _whole(readers: Readers, text: str, seconds: float = 60, rows: int | None = None) -> int:
    """Return how many bytes an answer has; 0 for one that ended in an error."""
    try:
        async with readers.ask(Question(text=text, formats=FORMATS, rows=rows), seconds=seconds) as answer:
            return sum([len(part) async for part in answer.parts()])
    except KgError:
        return 0


async def _asking(layout: Layout, asks: int, within: float, engine: float) -> None:
    """Print what a reader costs to start, and a quick query."""
    python = _median(lambda: subprocess.run(NEW_PYTHON, check=True), 5)
    _say("a new Python with what a reader needs, without opening the store, ms", f"{python * 1e3:.0f}")
    async with Readers(layout) as readers:
        began = time.perf_counter()
        await _whole(readers, ASK)
        _say("from nothing to the first answer, ms", f"{(time.perf_counter() - began) * 1e3:.0f}")
        await asyncio.sleep(0.5)
        fleet = readers._fleet  # noqa: SLF001 - what starting one costs is what is measured
        spawned = [await fleet.take(lambda _: None) for _ in range(fleet.idle)]
        times = await _timed(fleet._spawn, 20)  # noqa: SLF001 - as above
        for process in spawned:
            fleet.put(process)
        _say("another reader, ready, ms", f"{statistics.median(times) * 1e3:.1f}")
    async with Readers(layout) as readers:
        await _whole(readers, ASK)
        through = statistics.median(await _timed(lambda: _whole(readers, ASK), asks))
        _say(
            "ASK: engine / in this process, guarded / through a reader, ms",
            f"{engine * 1e3:.2f} / {within * 1e3:.2f} / {through * 1e3:.2f}",
        )
    async with Readers(layout, cache=1 << 20) as readers:
        await _whole(readers, ASK)
        cached = statistics.median(await _timed(lambda: _whole(readers, ASK), asks))
        _say("the same, known already, ms", f"{cached * 1e3:.3f}")


async def _reading(layout: Layout, rows: int) -> None:
    """Print how fast a large answer arrives."""
    async with Readers(layout) as readers:
        await _whole(readers, ASK)
        began = time.perf_counter()
        size = await _whole(readers, ROWS, rows=rows)
        seconds = time.perf_counter() - began
        _say("rows as json through a reader, MB a second", f"{size / seconds / 1e6:.1f}")


if __name__ == "__main__":
    main()
