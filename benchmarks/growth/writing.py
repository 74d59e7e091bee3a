"""Writes a store of generated facts as a build does: graphs of sources, what these share, systems, inferred triples."""

from __future__ import annotations

from collections import defaultdict
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Final

from pyoxigraph import NamedNode
from synthetic import repositories

from kg.facts import NodeReference
from kg.graph.builds import BuildRecord, build_triples, count
from kg.graph.iris import Iris
from kg.graph.ontology_files import ontology_triples
from kg.graph.packages import package_parts, repository_triples
from kg.graph.reading.nodes import NodeRecord
from kg.graph.shared import SHARED, split
from kg.graph.starts import STARTS, starts_apart
from kg.graph.systems import system_triples
from kg.launch.wiring.systems import wire
from kg.launch.wiring.types import NodeTypes
from kg.pipeline.inferring import Inference
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from kg.facts import PackageFacts, Repository
    from kg.settings import Settings
    from kg.store.transaction import EmbeddedTransaction

__all__ = ["write"]

_FLUSH: Final = 500_000
"""So many lines are loaded at once."""
_INFERRED: Final = 0.39
"""The share of quads that rules infer of these facts."""


def write(folder: Path, quads: int, settings: Settings) -> int:
    """Write a store of about so many quads, those that rules infer among them; return their number."""
    store = EmbeddedStore.create(folder)
    inference = Inference(store, settings)
    with store.write("benchmarks/growth") as transaction:
        inference.watch(transaction)
        _Writing(transaction, Iris(settings.base)).write(round(quads * (1 - _INFERRED)))
        inference.run(transaction)
        inference.remember(transaction.commit())
    with store.read() as snapshot:
        return snapshot.count()


class _Writing:
    """What is on its way into the store; lines that several sources have are written once."""

    def __init__(self, transaction: EmbeddedTransaction, iris: Iris) -> None:
        self._transaction = transaction
        self._iris = iris
        self._waiting: defaultdict[str, list[bytes]] = defaultdict(list)
        self._seen: dict[str, set[bytes]] = {iris.graph(SHARED): set(), iris.graph(STARTS): set()}

    def write(self, quads: int) -> None:
        """Write repositories until there are so many quads."""
        written = self._take(self._iris.graph("ontology"), ontology_triples().splitlines(keepends=True))
        for repository, packages in repositories():
            if written >= quads:
                break
            written += self._repository(repository, packages)
            if sum(map(len, self._waiting.values())) > _FLUSH:
                self._flush()
        self._flush()

    def _repository(self, repository: Repository, packages: list[PackageFacts]) -> int:
        began, graph = datetime.now(UTC), self._iris.source_graph(repository.name)
        written = self._take(graph, repository_triples(repository, self._iris).splitlines(keepends=True))
        records: dict[NodeReference, NodeRecord] = {}
        for facts in packages:
            triples, stated = package_parts(facts, self._iris)
            own, shared = split(triples, self._iris)
            written += self._take(graph, own) + self._take(self._iris.graph(SHARED), shared)
            for one in stated:
                ends = dict(zip(one.node.interfaces, one.ends, strict=True))
                settable = dict(zip(one.node.parameters, one.settable, strict=True))
                place = NodeReference(repository.name, facts.package.name, one.node.name)
                records[place] = NodeRecord(place.repository, None, place.package, one.node, one.iri, ends, settable)
        types = NodeTypes((place, record.node) for place, record in records.items())
        for configuration in (one for facts in packages for one in facts.launches):
            others, starts = starts_apart(system_triples(wire(configuration, types), records, self._iris), self._iris)
            written += self._take(self._iris.launch_graph(repository.name, configuration.path), others)
            written += self._take(self._iris.graph(STARTS), starts)
        record = BuildRecord(repository, began, datetime.now(UTC), "benchmark", count(packages, triples=written))
        return written + self._take(
            self._iris.graph("builds"), build_triples(record, self._iris).splitlines(keepends=True)
        )

    def _take(self, graph: str, lines: Iterable[bytes]) -> int:
        seen = self._seen.get(graph)
        new = (
            list(dict.fromkeys(lines)) if seen is None else [line for line in dict.fromkeys(lines) if line not in seen]
        )
        if seen is not None:
            seen.update(new)
        self._waiting[graph] += new
        return len(new)

    def _flush(self) -> None:
        small = {NamedNode(graph): b"".join(lines) for graph, lines in self._waiting.items()}
        shared = [NamedNode(graph) for graph in self._seen] + [NamedNode(self._iris.graph("builds"))]
        for graph in shared:
            content = small.pop(graph, None)
            if content:
                self._transaction.load(graph, [content])
        self._transaction.replace_small_graphs(small)
        self._waiting.clear()
