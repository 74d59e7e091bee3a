"""The graph of a running system in a store, kept up to date incrementally, with inferences.

It is stored node by node, so the cost of a change depends on the changed nodes only.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from pyoxigraph import NamedNode

from kg.graph.iris import RUNNING, Iris
from kg.graph.shared import SHARED, split
from kg.graph.systems import system_parts
from kg.launch.wiring.similar_names import near_misses
from kg.pipeline.inferring import Inference
from kg.robot.capabilities import capability_labels
from kg.robot.live.inference import now
from kg.robot.live.recognizing import Recognizer
from kg.robot.live.systems import Instances, Match, Seen, system_of

if TYPE_CHECKING:
    from collections.abc import Mapping
    from collections.abc import Set as AbstractSet

    from kg.errors import KgError
    from kg.facts import NodeInstance, NodeReference, System
    from kg.graph.reading.nodes import NodeRecord
    from kg.robot.connection import ComputationGraph
    from kg.settings import Settings
    from kg.store.embedded import EmbeddedStore
    from kg.store.transaction import EmbeddedTransaction

_Lines = frozenset[bytes]


class Parts:
    """The lines of a graph by the instance that they come from.

    Many instances share lines about a channel or a type. `described` are the subjects that other graphs of the store
    describe; their lines are left to these.
    """

    def __init__(self, iris: Iris, described: AbstractSet[bytes]) -> None:
        self._iris = iris
        self._described = described
        self._instances: dict[str, NodeInstance] = {}
        self._lines: dict[str, _Lines] = {}
        self._counts: Counter[bytes] = Counter()
        """Number of parts that contain a line."""

    def change(self, system: System, records: Mapping[NodeReference, NodeRecord]) -> tuple[bytes, bytes]:
        """Set the current system; return the removed and the added lines (N-Triples, sorted).

        Identical (`is`) instances are assumed to have the same lines, since `records` only grow.
        """
        before, self._lines = self._lines, {}
        instances: dict[str, NodeInstance] = {}
        for iri, instance, content in system_parts(system, records, self._iris, self._instances):
            if content is None:
                self._lines[iri] = before[iri]
            else:
                own, shared = split(content, self._iris)
                shared = [line for line in shared if line.partition(b" ")[0] not in self._described]
                self._lines[iri] = frozenset([*own, *shared])
            if instance is not None:
                instances[iri] = instance
        self._instances = instances
        return self._differences(before)

    def _differences(self, before: Mapping[str, _Lines]) -> tuple[bytes, bytes]:
        """Return the lines no longer in any part, and the new ones; moved lines are counted up first."""
        nothing = _Lines()
        pairs = [
            (before.get(iri, nothing), self._lines.get(iri, nothing))
            for iri in {**before, **self._lines}
            if before.get(iri) is not self._lines.get(iri)
        ]
        counts = self._counts
        gone: list[bytes] = []
        new: list[bytes] = []
        for old, lines in pairs:
            for line in lines - old:
                if not counts[line]:
                    new.append(line)
                counts[line] += 1
        for old, lines in pairs:
            for line in old - lines:
                counts[line] -= 1
                if not counts[line]:
                    del counts[line]
                    gone.append(line)
        return b"".join(sorted(gone)), b"".join(sorted(new))


_NONE: Final = -1  # no generation: the content of the store is unknown


@dataclass(frozen=True, slots=True)
class StoredState:
    """The state of the store after a change.

    `generation` is None if nothing had to be written. `capabilities` maps their IRIs to labels;
    `matches` the node types of its nodes; `problems` are rules that could not run.
    """

    generation: int | None
    capabilities: Mapping[str, str]
    matches: Mapping[str, Match] = field(default_factory=dict)
    problems: tuple[KgError, ...] = ()


class Keeper:
    """Stores one running system; each change is one transaction, which includes the rules."""

    def __init__(self, store: EmbeddedStore, settings: Settings, *, address: str, name: str) -> None:
        self._store = store
        self._iris = Iris(settings.base)
        self._address = address
        self._name = name
        self._since = now()
        self._nodes: dict[str, str] = {}
        self._inference = Inference(store, settings)
        self._recognizer = Recognizer(settings.base)
        self._generation: int | None = _NONE
        self._instances = Instances()
        self._parts: Parts | None = None
        """The content of the graph; None if unknown."""

    @property
    def graph(self) -> NamedNode:
        """The named graph of the system."""
        return NamedNode(self._iris.robot_graph(self._name))

    @property
    def iri(self) -> str:
        """The IRI of the system."""
        return self._iris.configuration(RUNNING, self._name)

    def keep(self, graph: ComputationGraph, *, until: str | None = None) -> StoredState:
        """Store the current state of the system; with `until` (ISO 8601, UTC), as seen for the last time.

        Raises StoreError: KG302 another process is writing, KG304 the disk is full; and as `Inference.run`.
        """
        with self._store.write("kg robot watch") as transaction:
            if transaction.base != self._generation:  # another process wrote the store
                self._inference.update_ontologies(transaction)
                self._recognizer.forget()
                self._parts = None
            self._generation = _NONE  # until the write is certain to be final
            matches = self._recognizer.matches(transaction, graph)
            moment = now()
            self._nodes = {node.name: self._nodes.get(node.name, moment) for node in graph.nodes}
            seen = Seen(self._address, self._name, self._since, until, self._nodes)
            system = system_of(graph, seen, matches, similar=near_misses, previous=self._instances)
            written = self._write(transaction, system)
            problems = self._inference.run(transaction).problems if written else ()
            labels = capability_labels(transaction, self.iri)
            if not written:
                transaction.roll_back()
            generation = transaction.commit()
            self._generation = generation or transaction.base
        if generation is not None:
            self._inference.remember(generation, save=False)
        return StoredState(generation, labels, matches, problems)

    def save(self) -> None:
        """Save the state with which the next process starts its rules quickly."""
        self._inference.save()

    def _write(self, transaction: EmbeddedTransaction, system: System) -> bool:
        """Write the differences; types that the store already describes are left to their graph."""
        if self._parts is None:
            content = transaction.content(NamedNode(self._iris.graph(SHARED)))
            self._parts = Parts(self._iris, {line.partition(b" ")[0] for line in content.splitlines()})
            _, new = self._parts.change(system, self._recognizer.records)
            transaction.replace_small_graphs({self.graph: new})
            return True
        gone, new = self._parts.change(system, self._recognizer.records)
        if gone or new:
            transaction.patch_graph(self.graph, gone, new)
        return bool(gone or new)
