"""Copies the graphs of a store to a SPARQL server; only those that differ, each as a whole.

    written = replace_on(store.layout, RemoteStore("https://example.org/query", "https://example.org/update"))

    .kg/server-3f2a...      the generation last copied to the server, and the size of each of its graphs there

Small changes are one request, which servers run as a whole or not at all. Larger ones are first written to graphs of
other names (`urn:kg:staged:`), in several requests, and then moved in one. Virtuoso moves at most 200 graphs at a time.
`kg serve` rejects changes of the inferred graph and the record of builds.

Virtuoso 7 rejects requests of more than 10 MB, 500 to 1,000 operations, or about 5,000 triples in an operation, and
blank nodes in INSERT DATA. So a blank node is first written as an IRI, which the server then replaces.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import chain, groupby
from operator import itemgetter
from pathlib import Path
from typing import Final
from urllib.parse import quote_plus

from pyoxigraph import BlankNode, NamedNode

from kg.store.changes import since
from kg.store.layout import Layout, write_atomically
from kg.store.locks import writer
from kg.store.remote import SIZES, RemoteStore
from kg.store.snapshot import EmbeddedSnapshot


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of a request: its size in bytes, encoded as a form, and its number of operations."""

    request_bytes: int
    operations: int


USUAL: Final = Limits(64 << 20, 1 << 20)
"""Limits for most servers; Oxigraph accepts 128 MB."""
VIRTUOSO: Final = Limits(8 << 20, 200)
_LINES: Final = 500
"""Number of triples per operation."""
_OPERATION_CHARACTERS: Final = 1 << 20
_STAGED: Final = "urn:kg:staged:"
"""Beginning of the names of graphs that exist while a store is copied."""
_NODES: Final = f"{_STAGED}nodes"
"""Graph with the blank node for each IRI that denotes one in staged graphs."""
_IS: Final = f"<{_STAGED}is>"
_LABEL: Final = f"{_STAGED}node:"
"""Beginning of the IRIs that denote blank nodes."""
_PATTERNS: Final = {
    "s": ("?a ?p ?o", f"?a {_IS} ?s"),
    "o": ("?s ?p ?b", f"?b {_IS} ?o"),
    "so": ("?a ?p ?b", f"?a {_IS} ?s . ?b {_IS} ?o"),
}
"""By the positions of blank nodes in a triple: the triple with IRIs for them, and the nodes that these denote."""
_SEPARATOR: Final = " ;\n"


@dataclass(frozen=True, slots=True)
class Replaced:
    """Numbers of graphs and triples written, of graphs removed, and of requests sent.

    `missing` is the number of triples that the server stored less than the graphs of the store have: it may regard
    numbers of different types as equal.
    """

    graphs: int
    triples: int
    removed: int
    requests: int
    missing: int = 0


def replace_on(layout: Layout, remote: RemoteStore, *, limits: Limits | None = None) -> Replaced:
    """Write the graphs of a store that differ on a server, and remove those that the store no longer has.

    A graph differs if it has changed since the last call, or if its number of triples on the server has. Graphs that
    were never in the store stay. Graphs may share blank nodes, so if one with blank nodes is written, all of them are.
    `limits` are by default those of the server.

    Raises:
        StoreError: KG225 if the server refuses or does not respond, KG301 for a store without data, KG302 while
            another process writes.
    """
    record = layout.root / f"server-{hashlib.blake2b(remote.address.encode(), digest_size=8).hexdigest()}"
    with writer(layout, "kg build"), EmbeddedSnapshot(layout) as snapshot:
        generation, earlier = _recorded(record)
        sizes, is_virtuoso = _sizes(remote)
        changed = since(layout, generation, snapshot.generation).graphs if earlier else None
        counts = {graph.value: snapshot.count(graph) for graph in snapshot.graphs()}
        wanted = [
            name
            for name, number in counts.items()
            if sizes.get(name, 0) != earlier.get(name, number) or (number and (changed is None or name in changed))
        ]
        wanted += _sharing_blank_nodes(snapshot, wanted, [name for name in counts if name not in set(wanted)])
        gone = [name for name in earlier if not counts.get(name) and name in sizes]
        replacing = _Replacing(snapshot, remote, limits or (VIRTUOSO if is_virtuoso else USUAL))
        replacing.drop([name for name in sizes if name.startswith(_STAGED)])
        replacing.replace(
            [name for name in wanted if counts[name]], [*gone, *(name for name in wanted if not counts[name])]
        )
        if replacing.requests:
            sizes, _ = _sizes(remote)
        there = {name: sizes.get(name, 0) for name in counts}
        text = json.dumps({"generation": snapshot.generation, "graphs": there}, sort_keys=True)
        write_atomically(record, text.encode())
    triples = sum(counts[name] for name in wanted)
    missing = sum(counts.values()) - sum(there.values())
    return Replaced(len(wanted), triples, len(gone), replacing.requests, missing)


def _sizes(remote: RemoteStore) -> tuple[dict[str, int], bool]:
    """Return the number of triples of each graph of a server, and whether the server is Virtuoso."""
    with remote.read() as there:
        sizes = {row["g"].value: int(row["n"].value) for row in there.rows(SIZES)}
        return sizes, there.is_virtuoso


def _recorded(record: Path) -> tuple[int, dict[str, int]]:
    """Return the generation last written to the server, and the sizes of its graphs there; 0 and none if unknown."""
    with suppress(OSError, ValueError, KeyError, AttributeError):
        content = json.loads(record.read_bytes())
        return int(content["generation"]), {name: int(size) for name, size in content["graphs"].items()}
    return 0, {}


def _sharing_blank_nodes(snapshot: EmbeddedSnapshot, wanted: Sequence[str], others: Sequence[str]) -> list[str]:
    """Return those of the other graphs with blank nodes, if one of the wanted has some."""

    def has_some(name: str) -> bool:
        pattern = f"GRAPH <{name}> {{ ?s ?p ?o FILTER(isBlank(?s) || isBlank(?o)) }}"
        return bool(snapshot.query(f"ASK {{ {pattern} }}", union=False))

    return list(filter(has_some, others)) if any(map(has_some, wanted)) else []


class _Replacing:
    """Replaces graphs on a server by those of a snapshot; `requests` is the number of requests sent."""

    def __init__(self, snapshot: EmbeddedSnapshot, remote: RemoteStore, limits: Limits) -> None:
        self.requests = 0
        self._snapshot = snapshot
        self._remote = remote
        self._limits = limits

    def drop(self, names: Iterable[str]) -> None:
        """Remove graphs."""
        self._send(self._requests(_drops(names)))

    def replace(self, names: Sequence[str], gone: Sequence[str]) -> None:
        """Replace the graphs `names` and remove the graphs `gone`, in one request if the limits allow that."""
        places = {name: name for name in names}
        requests = self._requests(chain(_drops((*gone, *names)), _insertions(self._snapshot, places)))
        only, another = next(requests, ""), next(requests, "")
        if not another:
            self._send(filter(None, [only]))
            return
        staged = {name: f"{_STAGED}{number}" for number, name in enumerate(names)}
        self._send(self._requests(_insertions(self._snapshot, staged)))
        moves = (f"MOVE SILENT GRAPH <{place}> TO GRAPH <{name}>" for name, place in staged.items())
        self._send(self._requests(chain(_drops(gone), moves)))

    def _send(self, requests: Iterable[str]) -> None:
        for request in requests:
            self._remote.update(request)
            self.requests += 1

    def _requests(self, operations: Iterable[str]) -> Iterator[str]:
        """Yield requests of operations, each within the limits unless a single operation is larger."""
        waiting: list[str] = []
        size = 0
        for operation in operations:
            cost = len(quote_plus(operation))
            if waiting and (size + cost > self._limits.request_bytes or len(waiting) == self._limits.operations):
                yield _SEPARATOR.join(waiting)
                waiting, size = [], 0
            waiting.append(operation)
            size += cost
        if waiting:
            yield _SEPARATOR.join(waiting)


def _drops(names: Iterable[str]) -> Iterator[str]:
    return (f"DROP SILENT GRAPH <{name}>" for name in names)


def _insertions(snapshot: EmbeddedSnapshot, places: Mapping[str, str]) -> Iterator[str]:
    """Yield operations that insert the content of graphs into others, which `places` names.

    Triples with blank nodes are first inserted into other graphs, with IRIs for the blank nodes.
    """
    labels: dict[str, None] = {}
    with_blank_nodes: dict[tuple[str, str], str] = {}

    def lines() -> Iterator[tuple[str, str]]:
        for name, place in places.items():
            for quad in snapshot.engine.quads_for_pattern(None, None, None, NamedNode(name)):
                kind, subject, value = "", quad.subject, quad.object
                if isinstance(subject, BlankNode):
                    kind, subject = "s", _denoting(subject, labels)
                if isinstance(value, BlankNode):
                    kind, value = f"{kind}o", _denoting(value, labels)
                target = (
                    with_blank_nodes.setdefault((place, kind), f"{_STAGED}{len(with_blank_nodes)}:{kind}")
                    if kind
                    else place
                )
                yield target, f"{subject} {quad.predicate} {value} ."

    yield from map(_insertion, _batches(lines()))
    nodes = ((_NODES, f"<{_LABEL}{label}> {_IS} _:{label} .") for label in labels)
    for batch in _batches(nodes):
        # INSERT DATA with blank nodes is an error for Virtuoso.
        yield f"INSERT {{ GRAPH <{_NODES}> {{\n" + "\n".join(line for _, line in batch) + "\n} } WHERE {}"
    for (place, kind), source in with_blank_nodes.items():
        staged, denoted = _PATTERNS[kind]
        pattern = f"GRAPH <{source}> {{ {staged} }} GRAPH <{_NODES}> {{ {denoted} }}"
        yield f"INSERT {{ GRAPH <{place}> {{ ?s ?p ?o }} }} WHERE {{ {pattern} }}"
    yield from _drops((*with_blank_nodes.values(), _NODES) if labels else ())


def _denoting(node: BlankNode, labels: dict[str, None]) -> NamedNode:
    """Return the IRI that denotes a blank node in staged graphs, and note its label."""
    labels[node.value] = None
    return NamedNode(f"{_LABEL}{node.value}")


def _insertion(lines: Sequence[tuple[str, str]]) -> str:
    """Return the operation that inserts lines of N-Triples, each given with its graph."""
    graphs = groupby(lines, key=itemgetter(0))
    parts = (f"GRAPH <{name}> {{\n" + "\n".join(line for _, line in group) + "\n}" for name, group in graphs)
    return "INSERT DATA {\n" + "\n".join(parts) + "\n}"


def _batches(lines: Iterable[tuple[str, str]]) -> Iterator[list[tuple[str, str]]]:
    """Yield lines, each given with its graph, in batches for an operation."""
    batch: list[tuple[str, str]] = []
    size = 0
    for line in lines:
        if batch and (len(batch) == _LINES or size + len(line[1]) > _OPERATION_CHARACTERS):
            yield batch
            batch, size = [], 0
        batch.append(line)
        size += len(line[1])
    if batch:
        yield batch
