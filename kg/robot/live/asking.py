"""The capabilities of a running system, a launch file or a package, with their proofs.

with launched(settings, "rover.launch", {}, {}) as subject:
    subject.capabilities
    list(subject.why("drivingAtVelocity"))
"""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final

from kg.graph import vocabulary as v
from kg.graph.iris import Iris
from kg.graph.reading.queries import texts
from kg.graph.systems import system_triples
from kg.pipeline.launching import chosen
from kg.pipeline.reasoning import explained_vocabulary, rules_in_force
from kg.pipeline.systems import node_types
from kg.robot.capabilities import capabilities_of, find, package_iri, proofs, read
from kg.robot.lifecycle import available
from kg.robot.live.inference import knowledge, now
from kg.robot.live.systems import Seen, name_of, system_of
from kg.rules.explain.view import View
from kg.store.opening import existing

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from kg.facts import System
    from kg.graph.reading.nodes import NodeRecord
    from kg.robot.capability import Capabilities
    from kg.robot.connection import ComputationGraph
    from kg.rules.explain.proof import Proof
    from kg.rules.form import Rule
    from kg.settings import Settings
    from kg.store.interface import Queryable
    from kg.store.snapshot import EmbeddedSnapshot


_CONFIRMED: Final = "?node ros:hasComponent ?end . ?end rnkg:confirms ?what ."


@dataclass(frozen=True, slots=True)
class Subject:
    """A system or package: its capabilities, and the graph that proves them."""

    capabilities: Capabilities
    view: View
    graph: Queryable
    iri: str
    rules: tuple[Rule, ...]

    def why(self, name: str) -> Iterator[Proof]:
        """Yield a proof for each node that has a capability; RobotError KG818 if none has one of that name."""
        return proofs(self.graph, self.view, self.rules, self.iri, find(self.capabilities, name))


def running(
    graph: ComputationGraph, settings: Settings, address: str, nodes: Mapping[str, str] | None = None
) -> Subject:
    """Return the subject of a running system; raises as `knowledge`.

    `nodes` has the times (ISO 8601, UTC) since when nodes have been seen, by name; others are new.
    """
    seen = Seen(address, name_of(address), now(), nodes=nodes or {})
    subject = _in_memory(system_of(graph, seen), settings, address)
    return replace(subject, capabilities=available(subject.capabilities, graph))


@contextmanager
def launched(
    settings: Settings, launch: str, arguments: Mapping[str, str], environment: Mapping[str, str]
) -> Iterator[Subject]:
    """Yield the subject of a launch file in the store, evaluated again if arguments are given.

    Raises as `kg.pipeline.launching.chosen`, and StoreError KG301 without a store.
    """
    store = existing(settings)
    (system,) = chosen(settings, store, launch, arguments, environment)
    own = system.configuration
    with store.read() as snapshot:
        if not arguments and not environment:
            yield _stored(snapshot, settings, Iris(settings.base).configuration(own.repository, own.path), own.name)
            return
        packages = {one.package for item in system.instances for one in (item.type, *item.plugins) if one}
        _, records = node_types(snapshot, packages)
        yield _in_memory(system, settings, own.name, records, _confirmed(snapshot, records.values()))


@contextmanager
def of_package(settings: Settings, name: str) -> Iterator[Subject]:
    """Yield the subject of a package in the store, `name` or `repository:name`.

    Raises:
        StoreError: KG301 no store.
        UnknownNameError: KG001 no such package.
        UsageError: KG003 several packages.
    """
    with existing(settings).read() as snapshot:
        yield _stored(snapshot, settings, package_iri(snapshot, name), name)


def _stored(snapshot: EmbeddedSnapshot, settings: Settings, iri: str, of: str) -> Subject:
    rules = rules_in_force(settings, []).rules
    view = View(snapshot, explained_vocabulary(settings), rules)
    return Subject(capabilities_of(snapshot, iri, of), view, snapshot, iri, rules)


def _confirmed(snapshot: EmbeddedSnapshot, nodes: Iterable[NodeRecord]) -> bytes:
    """Return what the code of node types confirms (`rnkg:confirms`), as N-Triples: the store has their functions."""
    query = f"SELECT ?end ?what {{ VALUES ?node {{ {' '.join(f'<{one.iri}>' for one in nodes)} }} {_CONFIRMED} }}"
    return "".join(f"<{end}> {v.rnkg('confirms')} <{what}> .\n" for end, what in texts(snapshot, query)).encode()


def _in_memory(
    system: System, settings: Settings, of: str, records: Mapping[Any, Any] | None = None, confirmed: bytes = b""
) -> Subject:
    own = system.configuration
    read_knowledge = knowledge(settings)
    content = system_triples(system, records or {}, Iris(settings.base), whole=True)
    world = read_knowledge.world(content + confirmed, whole=True)
    iri = Iris(settings.base).configuration(own.repository, own.path)
    view = View(world, explained_vocabulary(settings), read_knowledge.rules.rules)
    return Subject(read(world, iri, of, read_knowledge.definitions), view, world, iri, read_knowledge.rules.rules)
