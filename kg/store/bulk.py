"""Bulk transfer between the engine and bytes: export tables of a graph, import N-Triples.

The engine releases Python's lock, so two threads can read or load at a time. Times for 100,000 triples on two
processors, in seconds: a SELECT as TSV for each predicate 0.47 (two threads: 0.28), an N-Triples dump 0.89, single
quads 0.77; loading in one batch 1.66, in two threads 0.84 to 1.1. The engine sorts keys in memory for each of six
indexes, which is faster for small batches, until the files that each batch creates cost more.

On each call, the engine's own loader gives blank nodes new labels, which would split a node that occurs in several
batches or graphs. So lines with blank nodes are parsed here and added as quads, which takes 10 % longer.

The engine is passed as a function that returns it: in a local variable, the traceback of an error would keep it open.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, TypeAlias, cast

from pyoxigraph import (
    BlankNode,
    DefaultGraph,
    NamedNode,
    Quad,
    QueryResultsFormat,
    QuerySolutions,
    RdfFormat,
    Store,
    parse,
)

from kg.lazily import lazily
from kg.store.allocator import give_back
from kg.store.terms import BLANK_MARK, split_blank

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator
    from concurrent.futures import Future

    Engine: TypeAlias = Callable[[], Store]
    Graph: TypeAlias = NamedNode | BlankNode | DefaultGraph

with lazily():
    from concurrent.futures import ThreadPoolExecutor

_THREADS: Final = 2
_BATCH_BYTES: Final = 2 << 20
"""Size of a batch. The engine uses several times as much memory; larger batches are not faster per triple."""
_QUAD_BYTES: Final = 150
"""Approximate size of a quad in N-Quads."""
_FEW: Final = 2500
"""Up to this number, adding triples one by one is as fast: a bulk load writes files for each index at any size."""


def table(engine: Engine, select: str, graph: NamedNode | None) -> bytes:
    """Return the rows of a SELECT over one graph (None: the default graph) as TSV, without the header line.

    TSV abbreviates numbers and booleans and does not escape control characters; see `kg.store.terms.cells`.
    """
    return as_tsv(engine().query(select, default_graph=graph or DefaultGraph()))


def as_tsv(rows: object) -> bytes:
    """Return the rows of a SELECT as TSV, without the header line."""
    text = cast("bytes", cast("QuerySolutions", rows).serialize(format=QueryResultsFormat.TSV))
    return text[text.index(b"\n") + 1 :]


def load(engine: Engine, graph: Graph, chunks: Iterable[bytes]) -> int:
    """Add chunks of N-Triples, each of whole lines, to a graph, several batches at a time; return their size in bytes.

    Blank nodes keep their labels. The memory used and the delay of Ctrl-C do not depend on the size of the graph.
    """

    def one(batch: bytes) -> None:
        engine().bulk_load(batch, RdfFormat.N_TRIPLES, to_graph=graph, lenient=True)

    return _load_all(engine, chunks, one, lambda lines: _placed(graph, lines))


def load_quads(engine: Engine, graphs: Iterable[tuple[NamedNode, bytes]]) -> int:
    """Add chunks of N-Triples, each of whole lines, to the graphs given with them; return their size as N-Quads.

    Blank nodes keep their labels.
    """

    def one(batch: bytes) -> None:
        engine().bulk_load(batch, RdfFormat.N_QUADS, lenient=True)

    # Line ends in literals are escaped, so no line is split.
    chunks = (content.replace(b" .\n", f" {graph} .\n".encode()) for graph, content in graphs)
    return _load_all(engine, chunks, one, lambda lines: parse(lines, RdfFormat.N_QUADS, lenient=True))


def _load_all(
    engine: Engine, chunks: Iterable[bytes], one: Callable[[bytes], None], quads: Callable[[bytes], Iterable[Quad]]
) -> int:
    """Load chunks of whole lines; return their size in bytes.

    The function `one` loads a batch without blank nodes, several at a time. Lines with blank nodes follow, as `quads`
    reads them, while nothing else is loaded: the engine has crashed twice where both ran at once.
    """
    size = 0
    blank: list[bytes] = []
    with ThreadPoolExecutor(_THREADS) as pool:
        waiting: list[Future[None]] = []

        def wait_for(number: int) -> None:
            while len(waiting) > number:
                waiting.pop(0).result()

        for batch in _batches(chunks):
            size += len(batch)
            plain, others = split_blank(batch)
            if plain:
                wait_for(_THREADS - 1)
                waiting.append(pool.submit(one, plain))
            if others:
                blank.append(others)
            if sum(map(len, blank)) >= _BATCH_BYTES:
                wait_for(0)
                _extend(engine, blank, quads)
        wait_for(0)
    _extend(engine, blank, quads)
    if size > _BATCH_BYTES:
        give_back()
    return size


def _extend(engine: Engine, blank: list[bytes], quads: Callable[[bytes], Iterable[Quad]]) -> None:
    """Add lines with blank nodes, and empty the list."""
    lines = b"".join(blank)
    blank.clear()
    if lines:
        _put(engine, quads(lines), lines.count(b"\n"))


def _put(engine: Engine, quads: Iterable[Quad], number: int) -> None:
    """Add so many quads in the way that costs least."""
    (engine().extend if number <= _FEW else engine().bulk_extend)(quads)


def _placed(graph: Graph, lines: bytes) -> Iterator[Quad]:
    """Yield N-Triples as quads of a graph; unlike the engine's loader, this preserves labels of blank nodes."""
    for quad in parse(lines, RdfFormat.N_TRIPLES, lenient=True):
        yield Quad(quad.subject, quad.predicate, quad.object, graph)


def add(engine: Engine, graph: NamedNode, lines: bytes) -> None:
    """Add N-Triples to a graph; blank nodes keep their labels."""
    if lines.count(b"\n") > _FEW:
        load(engine, graph, [lines])
    else:
        engine().extend(_placed(graph, lines))


def remove(engine: Engine, graph: NamedNode, lines: bytes) -> None:
    """Remove N-Triples from a graph; blank nodes are identified by their labels."""
    if BLANK_MARK not in lines:
        # Twice as fast, but an update cannot refer to a blank node of the store.
        engine().update(f"DELETE DATA {{ GRAPH {graph} {{\n{lines.decode()}}} }}")
        return
    for quad in _placed(graph, lines):
        engine().remove(quad)


def exchange(engine: Engine, removed: Collection[Quad], added: Collection[Quad]) -> int:
    """Remove and add quads; return the approximate number of bytes loaded in bulk."""
    for quad in removed:
        engine().remove(quad)
    _put(engine, added, len(added))
    return len(added) * _QUAD_BYTES if len(added) > _FEW else 0


def _batches(chunks: Iterable[bytes]) -> Iterator[bytes]:
    """Join small chunks, and split large ones at line ends."""
    batch: list[bytes] = []
    size = 0
    for chunk in chunks:
        batch.append(chunk)
        size += len(chunk)
        if size >= _BATCH_BYTES:
            yield from _split(b"".join(batch))
            batch, size = [], 0
    if batch:
        yield from _split(b"".join(batch))


def _split(text: bytes) -> Iterator[bytes]:
    """Split text at line ends into parts of at least a batch's size."""
    begin = 0
    while len(text) - begin >= 2 * _BATCH_BYTES:
        end = text.find(b"\n", begin + _BATCH_BYTES) + 1 or len(text)
        yield text[begin:end]
        begin = end
    if begin < len(text):
        yield text[begin:]
