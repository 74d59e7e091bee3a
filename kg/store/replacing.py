"""Copies the graphs of a store to a SPARQL server; only those that differ, each as a whole.

    written = replace_on(store.layout, RemoteStore("https://example.org/query", "https://example.org/update"))

    .kg/server-3f2a...      the generation last copied to the server, and the names of its graphs

Changes of up to 64 MB are one request, which servers run as a whole or not at all. Larger changes take several
requests: until the last one is done, clients may see new and old graphs together. Virtuoso 7 rejects several operations
in one request, and `kg serve` rejects changes of the inferred graph and the record of builds.
"""

from __future__ import annotations

import hashlib
import json
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final
from urllib.parse import quote_plus

from pyoxigraph import NamedNode

from kg.store.changes import since
from kg.store.layout import write_atomically
from kg.store.locks import writer
from kg.store.remote import SIZES
from kg.store.snapshot import EmbeddedSnapshot

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from kg.store.layout import Layout
    from kg.store.remote import RemoteStore

_REQUEST_BYTES: Final = 64 << 20
"""Size limit of a request, encoded as a form; servers have limits too (128 MB for Oxigraph)."""
_LINES: Final = 10_000
"""Number of triples per operation."""


@dataclass(frozen=True, slots=True)
class Replaced:
    """Numbers of graphs and triples written, of graphs removed, and of requests sent."""

    graphs: int
    triples: int
    removed: int
    requests: int


def replace_on(layout: Layout, remote: RemoteStore, *, request_bytes: int = _REQUEST_BYTES) -> Replaced:
    """Write the graphs of a store that differ on a server, and remove those that the store no longer has.

    A graph differs if it has changed since the last call, or if its number of triples is another one on the server.
    Graphs that were never in the store stay. Graphs may share blank nodes, so if one with blank nodes is written, all
    of them are.

    Raises:
        StoreError: KG225 if the server refuses or does not respond, KG301 for a store without data, KG302 while
            another process writes.
    """
    record = layout.root / f"server-{hashlib.blake2b(remote.address.encode(), digest_size=8).hexdigest()}"
    with writer(layout, "kg build"), EmbeddedSnapshot(layout) as snapshot:
        generation, earlier = _recorded(record)
        with remote.read() as there:
            sizes = {row["g"].value: int(row["n"].value) for row in there.rows(SIZES)}
        changed = since(layout, generation, snapshot.generation).graphs if earlier else None
        counts = {graph.value: snapshot.count(graph) for graph in snapshot.graphs()}
        wanted = [
            name
            for name, number in counts.items()
            if number != sizes.get(name, 0) or (number and (changed is None or name in changed))
        ]
        gone = [name for name in earlier if not counts.get(name) and name in sizes]
        contents = _contents(snapshot, wanted, counts)
        requests = 0
        for request in _requests(contents, gone, request_bytes):
            remote.update(request)
            requests += 1
        record_text = json.dumps({"generation": snapshot.generation, "graphs": sorted(counts)})
        write_atomically(record, record_text.encode())
    return Replaced(len(contents), sum(counts[name] for name in contents), len(gone), requests)


def _recorded(record: Path) -> tuple[int, list[str]]:
    """Return the generation last written to the server, and its graphs; 0 and no graphs if unknown."""
    with suppress(OSError, ValueError, KeyError):
        found = json.loads(record.read_bytes())
        return int(found["generation"]), list(found["graphs"])
    return 0, []


def _contents(snapshot: EmbeddedSnapshot, wanted: Sequence[str], counts: dict[str, int]) -> dict[str, list[str]]:
    """Return the N-Triples lines of each graph to write."""
    found = {name: _lines(snapshot, name) for name in wanted}
    if any(_is_blank(line) for lines in found.values() for line in lines):
        for name in counts.keys() - found.keys():
            lines = _lines(snapshot, name)
            if any(map(_is_blank, lines)):
                found[name] = lines
    return found


def _lines(snapshot: EmbeddedSnapshot, name: str) -> list[str]:
    return snapshot.content(NamedNode(name)).decode().splitlines()


def _is_blank(line: str) -> bool:
    """Return whether an N-Triples line may contain a blank node; a literal with `_:` counts too."""
    return "_:" in line


def _requests(contents: dict[str, list[str]], gone: Sequence[str], most: int) -> Iterator[str]:
    """Yield requests of operations, each at most about `most` bytes as a form."""
    operations: list[str] = []
    size = 0
    for operation in _operations(contents, gone):
        cost = len(quote_plus(operation))
        if operations and size + cost > most:
            yield " ;\n".join(operations)
            operations, size = [], 0
        operations.append(operation)
        size += cost
    if operations:
        yield " ;\n".join(operations)


def _operations(contents: dict[str, list[str]], gone: Sequence[str]) -> Iterator[str]:
    for name in (*gone, *contents):
        yield f"DROP SILENT GRAPH <{name}>"
    blank = {name: [line for line in lines if _is_blank(line)] for name, lines in contents.items()}
    if any(blank.values()):
        # A label means the same node only within one operation.
        parts = (f"GRAPH <{name}> {{\n" + "\n".join(lines) + "\n}" for name, lines in blank.items() if lines)
        yield "INSERT DATA {\n" + "\n".join(parts) + "\n}"
    for name, lines in contents.items():
        plain = [line for line in lines if not _is_blank(line)]
        for start in range(0, len(plain), _LINES):
            yield f"INSERT DATA {{ GRAPH <{name}> {{\n" + "\n".join(plain[start : start + _LINES]) + "\n} }"
