"""Graphs shared by sources (`kg.graph.shared`) and systems (`kg.graph.starts`), kept consistent with these."""

from __future__ import annotations

import re
import tempfile
from typing import TYPE_CHECKING, Any, Final

from pyoxigraph import NamedNode, RdfFormat

from kg.graph import vocabulary as v
from kg.graph.shared import SHARED
from kg.graph.starts import STARTS, start_of
from kg.store.failure import translated

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

    from kg.graph.iris import Iris
    from kg.store.transaction import EmbeddedTransaction

_FEW: Final = 20
"""Triples are removed one by one up to this fraction of the graph (1/n); else it is written again."""
_HELD_BYTES: Final = 4 << 20
"""Descriptions of starts beyond this size are moved to a file."""
_PIECE_BYTES: Final = 1 << 20
_KNOWN: Final = 1 << 15
"""Number of starts or lines that are remembered; later ones may be written again, which the store ignores."""
_STARTED: Final = f"SELECT DISTINCT ?start WHERE {{ ?instance {v.STARTED_WITH} ?start }}"
_START: Final = re.compile(f" {re.escape(v.STARTED_WITH)} <([^>]*)> ".encode())


class Described:
    """N-Triples lines about starts, each start once, or seldom again; many are in a file of the folder `cache`."""

    def __init__(self, cache: Path) -> None:
        self._cache = str(cache)
        self._present: set[bytes] = set()
        self._file = tempfile.SpooledTemporaryFile(max_size=_HELD_BYTES, dir=str(cache))  # noqa: SIM115 - `close` closes it

    def add(self, lines: Iterable[bytes]) -> None:
        """Add lines that fully describe starts; equal names imply equal descriptions, so one is enough.

        Raises StoreError KG304 if the disk is full.
        """
        new = {line: start for line in lines if (start := start_of(line)) not in self._present}
        if len(self._present) > _KNOWN:
            self._present.clear()
        self._present.update(new.values())
        with translated(self._cache):
            self._file.writelines(new)

    def __iter__(self) -> Iterator[bytes]:
        """Yield the lines."""
        self._file.seek(0)
        yield from self._file

    def chunks(self) -> Iterator[bytes]:
        """Yield the lines in larger chunks."""
        self._file.seek(0)
        while piece := self._file.read(_PIECE_BYTES):
            yield piece + self._file.readline()

    def close(self) -> None:
        """Discard the lines."""
        self._file.close()


def patch_shared(
    transaction: EmbeddedTransaction,
    iris: Iris,
    gone: Iterable[bytes],
    came: Iterable[bytes],
    unchanged: Iterable[bytes],
) -> None:
    """Change the graph from exactly the triples of `gone` and `unchanged` to those of `came` and `unchanged`.

    `unchanged` is only read if something changes.
    """
    before = {line for content in gone for line in content.splitlines(keepends=True)}
    after = {line for content in came for line in content.splitlines(keepends=True)}
    removed, added = before - after, after - before
    for content in unchanged if removed or added else ():
        there = content.splitlines(keepends=True)
        removed.difference_update(there)
        added.difference_update(there)
    if removed or added:
        _patch(transaction, NamedNode(iris.graph(SHARED)), b"".join(sorted(removed)), b"".join(sorted(added)))


def keep_shared(
    transaction: EmbeddedTransaction, iris: Iris, contents: Iterable[bytes], sources: Iterable[str]
) -> None:
    """Replace the graph by the triples in `contents`, without duplicates; `sources` are the sources of the contents.

    If the store has other sources, whose contents are unknown, nothing is removed.
    """
    graph = NamedNode(iris.graph(SHARED))
    if graph not in transaction.graphs():
        transaction.load(graph, _without_recent(contents))
        return
    wanted = {line for content in contents for line in content.splitlines(keepends=True)}
    present = set(transaction.content(graph).splitlines(keepends=True))
    removed, added = present - wanted, wanted - present
    own = {iris.source_graph(name) for name in sources}
    others = iris.source_graph("")
    if any(other.value.startswith(others) and other.value not in own for other in transaction.graphs()):
        removed = set()
    _change(transaction, graph, present, removed, added)


def _without_recent(contents: Iterable[bytes]) -> Iterator[bytes]:
    """Yield N-Triples without most of the lines that occurred before."""
    recent: set[bytes] = set()
    for content in contents:
        new = [line for line in dict.fromkeys(content.splitlines(keepends=True)) if line not in recent]
        if len(recent) > _KNOWN:
            recent.clear()
        recent.update(new)
        yield b"".join(new)


def keep_starts(
    transaction: EmbeddedTransaction,
    iris: Iris,
    described: Described,
    changed: tuple[Iterable[bytes], Iterable[bytes]] | None = None,
) -> None:
    """Update the graph of starts to the instances of the store; `described` contains lines about new ones.

    `changed` contains the lines of systems removed and added, None if unknown.
    """
    graph = NamedNode(iris.graph(STARTS))
    if changed is not None:
        before, used = ({match[1] for line in lines if (match := _START.search(line))} for lines in changed)
        left = before - used
        used |= {one for one in left if transaction.query(f"ASK {{ ?instance {v.STARTED_WITH} <{one.decode()}> }}")}
        removed = b"".join(_lines_of(transaction, graph, start) for start in sorted(left - used))
        added = b"".join(sorted(line for line in described if start_of(line) in used)) if used else b""
        if removed or added:
            _patch(transaction, graph, removed, added)
        return
    present = set(transaction.content(graph).splitlines(keepends=True))
    if not present:
        transaction.load(graph, described.chunks())
        return
    starts: Any = transaction.query(_STARTED)
    wanted = {row["start"].value.encode() for row in starts}
    unused = {line for line in present if start_of(line) not in wanted}
    _change(transaction, graph, present, unused, set(described) - present)


def _lines_of(transaction: EmbeddedTransaction, graph: NamedNode, start: bytes) -> bytes:
    """Return the triples of a start and of its parts, as N-Triples."""
    iri = f"<{start.decode()}>"
    parts = f"{{ BIND({iri} AS ?part) }} UNION {{ {iri} {v.HAS_REMAP}|{v.HAS_SETTING} ?part }}"
    triples: Any = transaction.query(f"CONSTRUCT {{ ?part ?p ?o }} WHERE {{ GRAPH {graph} {{ {parts} ?part ?p ?o }} }}")
    return triples.serialize(format=RdfFormat.N_TRIPLES) or b""


def _change(
    transaction: EmbeddedTransaction, graph: NamedNode, present: set[bytes], removed: set[bytes], added: set[bytes]
) -> None:
    if len(removed) * _FEW > len(present) and (left := (present - removed) | added):
        transaction.replace_graphs({graph: sorted(left)})
    elif removed:
        _patch(transaction, graph, b"".join(sorted(removed)), b"".join(sorted(added)))
    elif added:
        transaction.load(graph, sorted(added))


def _patch(transaction: EmbeddedTransaction, graph: NamedNode, removed: bytes, added: bytes) -> None:
    """Patch a graph, and remove it if it becomes empty, as a build from scratch does not create it."""
    transaction.patch_graph(graph, removed, added)
    if removed and not added and not transaction.query(f"ASK {{ GRAPH {graph} {{ ?s ?p ?o }} }}"):
        transaction.drop_graph(graph)
